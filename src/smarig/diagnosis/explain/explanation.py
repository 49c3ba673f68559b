"""The maximum of one explanation: its effects and the joint density, with the likeliest strengths.

A density absorbs part of any error. So effects and density are found in turn, strengths step farther than each fit
indicates, and the final strengths are those of largest evidence.
"""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from smarig.diagnosis.explain.joint_density import joint_density, joint_density_from_best_start
from smarig.diagnosis.explain.parameter_fit import ParameterFit, fit_parameters
from smarig.diagnosis.refit.evidence_maximum import EvidenceMaximum, maximise_evidence
from smarig.diagnosis.refit.refit import Refit
from smarig.plant import Effect
from smarig.preisach import Everett
from smarig.replay import PlantModel, Timeline

MAX_ROUNDS = 4  # rounds of effects, then density
OVERSTEP, OVERSTEP_GROWTH = 1.7, 1.4  # factor of a fitted step; factor of growth after a successful step
MIN_MOVE_SD = 0.3  # standard deviations: smaller steps are ignored
SD_INFLATION = 2.5  # correction of sds by evidence, from tuning boxes: the prior is a model too
MIN_STRENGTH_SD = 0.01  # of a strength: least sd


@dataclass(frozen=True, eq=False)
class Explanation:
    """Effects with their joint density, and the readings refitted with their log likelihood."""

    effects: tuple[Effect, ...]
    plant_model: PlantModel
    refitted: Refit

    @property
    def evidence(self) -> float:
        """Nats."""
        return self.refitted.log_evidence

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects, in order."""
        return tuple(sorted(p.kind.name for p in self.effects))


def doubled_strength_start(
    timeline: Timeline, plant_model: PlantModel, refitted: Refit, original: Everett, warm_start: Refit
) -> tuple[PlantModel, Refit]:
    """A start with the last effect's strength doubled until the next doubling is less likely.

    A density absorbs most of a weak effect, so a fit with the wrong density starts too low.
    """
    while True:
        *attempts, last = plant_model.catalogue_effects
        primary, strength = last.kind.primary, 2 * last.strength
        if not (primary.lower <= strength <= primary.upper and strength):
            return plant_model, refitted
        stronger = replace(plant_model, effects=(*attempts, last.at(strength)))
        refitted_again = joint_density_from_best_start(timeline, stronger, original, warm_start)
        if refitted_again[1].log_evidence <= refitted.log_evidence:
            return plant_model, refitted
        plant_model, refitted = refitted_again


def fit_explanation(
    timeline: Timeline, plant_model: PlantModel, original: Everett, refitted: Refit, rounds: int
) -> Explanation:
    """Fit effects and their joint density in turn, until neither changes the other.

    A density absorbs part of every change of strength. So strengths step farther than each fit indicates if that is
    likelier.
    """
    overstep = OVERSTEP
    for _ in range(rounds):
        parameter_fit = fit_parameters(
            plant_model.catalogue_effects, timeline, plant_model, refitted, plant_model.hysteresis
        )
        if parameter_fit.moved < MIN_MOVE_SD:
            break
        attempts = [
            joint_density_from_best_start(
                timeline,
                replace(
                    plant_model, effects=parameter_fit.extrapolated(plant_model.catalogue_effects, factor)
                ),
                original,
                refitted,
            )
            for factor in (1.0, overstep)
        ]
        attempt, refitted_again = max(attempts, key=lambda pair: pair[1].log_evidence)
        if refitted_again.log_evidence <= refitted.log_evidence:
            break
        overstep = OVERSTEP_GROWTH * overstep if attempt is attempts[1][0] else OVERSTEP
        plant_model, refitted = attempt, refitted_again
    return Explanation(plant_model.catalogue_effects, plant_model, refitted)


def with_strengths_maximised(
    timeline: Timeline, original: Everett, found: Explanation
) -> tuple[ParameterFit, Explanation]:
    """An explanation with the strengths of largest evidence, and the standard deviations of its parameters."""
    parameter_fit = fit_parameters(
        found.effects, timeline, found.plant_model, found.refitted, found.plant_model.hysteresis
    )
    spread = dict(parameter_fit.spread)
    for k, effect in enumerate(found.effects):
        primary, key = effect.kind.primary, (effect.kind.name, effect.kind.primary.name)
        guess = max(parameter_fit.conditional_spread[key], MIN_STRENGTH_SD * abs(effect.strength))
        start = EvidenceMaximum(effect.strength, found.evidence, found, guess)
        best = maximise_evidence(
            partial(_with_strength, timeline, original, found, k), start, (primary.lower, primary.upper)
        )
        found = best.at
        inflation = SD_INFLATION * max(best.sd / parameter_fit.conditional_spread[key], 1.0)
        spread |= {
            name: sd * inflation for name, sd in parameter_fit.spread.items() if name[0] == effect.kind.name
        }
    finite_sds = {name: sd for name, sd in spread.items() if np.isfinite(sd)}  # the evidence has a maximum
    return replace(
        parameter_fit, effects=found.effects, spread=finite_sds, plant_model=found.plant_model
    ), found


def _with_strength(
    timeline: Timeline, original: Everett, found: Explanation, k: int, strength: float
) -> tuple[float, Explanation]:
    """An explanation with another strength of its effect k, and its evidence."""
    effects = list(found.effects)
    effects[k] = effects[k].at(strength)
    plant_model = replace(found.plant_model, effects=tuple(effects))
    plant_model, refitted = joint_density_from_best_start(timeline, plant_model, original, found.refitted)
    return refitted.log_evidence, Explanation(plant_model.catalogue_effects, plant_model, refitted)


def evidence_without_one(timeline: Timeline, best: Explanation, warm_start: Refit) -> float:
    """The largest log likelihood with one effect less, starting from the density of all effects."""
    less = [
        replace(best.plant_model, effects=tuple(e for e in best.plant_model.effects if e is not one))
        for one in best.effects
    ]
    return max(joint_density(timeline, plant_model, warm_start)[1].log_evidence for plant_model in less)
