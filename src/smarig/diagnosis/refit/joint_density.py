"""The joint density: the density identified together with effects.

    ν ← max(ν + E[δν | all positions], 0),     δν of the prior of ``density_prior`` about ν, likeliest sds

is repeated until the likelihood rises no more, because a prior in proportion to the density is only as good as that
density. The iteration starts from a positive measure fitted to settled positions.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import inf

import numpy as np
from numpy.typing import NDArray

from smarig.diagnosis.refit.coupled_readings import effect_contribution
from smarig.diagnosis.refit.moved_density import with_moved_density
from smarig.diagnosis.refit.refit import Refit, refit
from smarig.identification import Observations, fit_table, surface_through_states
from smarig.preisach import Everett, FodSurface
from smarig.replay import PlantModel, Prediction, Timeline, predict

Array = NDArray[np.float64]
START_SMOOTHING = 1e-14  # λ of the initial measure
MAX_ROUNDS = 30
AS_GOOD = 1.05  # times the error of another density: chance of the fit
MIN_ROUND_GAIN = 2.0  # nats: a round that gains less is the last
REACH = 2.0  # times what the last round gained: what all further ones may gain


def joint_density(
    timeline: Timeline, plant_model: PlantModel, warm_start: Refit | None = None
) -> tuple[PlantModel, Refit]:
    """The plant model with a new density, and its readings refitted; ``warm_start``: start at the result of another
    refit.

    The density is identified from positions only: what other channels show is left to the effects.
    """
    return _alternated(timeline, [_start(timeline, plant_model, warm_start)])


def joint_density_from_best_start(
    timeline: Timeline, plant_model: PlantModel, original: Everett, warm_start: Refit | None = None
) -> tuple[PlantModel, Refit]:
    """``joint_density`` from two starts, the likelier result.

    The starts are the density of the model, which was identified without its effects, and a positive measure of settled
    positions. If ``original``, the density before all, is a surface, that is fitted again along the inputs with
    effects; another density is moved to where effects move the input. It may be negative somewhere (Prop. 4.6); the
    measure is not affected by errors of the model.
    """
    return _alternated(
        timeline, [_start(timeline, m, warm_start) for m in _both(timeline, plant_model, original)]
    )


def _both(timeline: Timeline, plant_model: PlantModel, original: Everett) -> Iterator[PlantModel]:
    rows = _settled_rows(timeline, predict(timeline, plant_model), plant_model)
    surface = surface_through_states(rows, original) if isinstance(original, FodSurface) else None
    if surface is not None:
        yield replace(plant_model, hysteresis=surface)
    else:
        yield with_moved_density(timeline, plant_model, plant_model.hysteresis)
    yield replace(plant_model, hysteresis=fit_table(rows, START_SMOOTHING))


def with_posterior_density(
    timeline: Timeline, plant_model: PlantModel, refitted: Refit, given: PlantModel | None = None
) -> PlantModel:
    """The plant model with the posterior density of its readings, with its own, or as ``given``: what fits best.

    A refit that fits worse than the given model has failed, and must not be diagnosed.
    """
    posterior = replace(plant_model, hysteresis=refitted.posterior.table())
    candidates = (plant_model, posterior, *([given] if given else []))
    return min(candidates, key=lambda s: settled_rms(timeline, s))


def with_density_for_effects(
    timeline: Timeline, plant_model: PlantModel, refitted: Refit, base: PlantModel
) -> PlantModel:
    """A plant model with effects and the density that fits best, or that of the base model, moved with the input.

    The latter if it fits as well: effects that only another channel shows leave the positions as they were.
    """
    own = with_posterior_density(timeline, plant_model, refitted)
    moved = with_moved_density(timeline, plant_model, base.hysteresis)
    return moved if settled_rms(timeline, moved) < AS_GOOD * settled_rms(timeline, own) else own


def settled_rms(timeline: Timeline, plant_model: PlantModel) -> float:
    """The rms error of a plant model at settled positions, with free zeros."""
    error = timeline.settled.value - predict(timeline, plant_model).values["settled"]
    own = [error[timeline.zero == z] for z in np.unique(timeline.zero)] if timeline.zero.size else [error]
    return float(np.std(np.concatenate([e - e.mean() for e in own])))


@dataclass(frozen=True, eq=False)
class _Round:
    """A plant model, its prediction of the timeline, its positions refitted, and what the last round gained, in nats.

    ``contribution`` (n,) is that of the effects to positions: no density changes it much.
    """

    plant_model: PlantModel
    prediction: Prediction
    refitted: Refit
    contribution: Array
    gain: float = inf

    @property
    def log_evidence(self) -> float:
        """Of the positions, nats."""
        return self.refitted.log_evidence

    def within_reach(self, best: float) -> bool:
        """Whether further rounds, each of which gains less than the one before, may still reach an evidence."""
        return self.log_evidence + REACH * self.gain >= best

    def next(self, timeline: Timeline) -> "_Round":
        """The round that follows, or the same if that gains nothing."""
        model = replace(self.plant_model, hysteresis=self.refitted.posterior.table())
        found = _start(timeline, model, self.refitted, self.contribution)
        gain = found.log_evidence - self.log_evidence
        return replace(found, gain=gain) if gain > 0 else replace(self, gain=0.0)


def _start(
    timeline: Timeline, plant_model: PlantModel, warm_start: Refit | None, contribution: Array | None = None
) -> _Round:
    prediction, positions = predict(timeline, plant_model), timeline.positions_only
    own = prediction.positions_only
    refitted = refit(positions, own, plant_model, warm_start, contribution)
    if contribution is None:
        contribution = effect_contribution(positions, own, plant_model)
    return _Round(plant_model, prediction, refitted, contribution)


def _alternated(timeline: Timeline, starts: Sequence[_Round]) -> tuple[PlantModel, Refit]:
    """Rounds from each start as long as they gain and may still be the likeliest."""
    found = list(starts)
    for _ in range(MAX_ROUNDS):
        found = [one if one.gain < MIN_ROUND_GAIN else one.next(timeline) for one in found]
        top = max(one.log_evidence for one in found)
        found = [one for one in found if one.within_reach(top)]
        if all(one.gain < MIN_ROUND_GAIN for one in found):
            break
    best = max(found, key=lambda one: one.log_evidence)
    if len(timeline.positions_only.all_readings) == len(timeline.all_readings):
        return best.plant_model, best.refitted
    return best.plant_model, refit(timeline, best.prediction, best.plant_model, best.refitted)


def _settled_rows(timeline: Timeline, prediction: Prediction, plant_model: PlantModel) -> Observations:
    """The settled positions without what effects add to them, along the inputs with effects."""
    n = len(timeline.settled)
    y = timeline.settled.value - (prediction.values["settled"] - prediction.output[:n])
    h = plant_model.hysteresis
    rows = Observations.of_states(prediction.states[:n], y, timeline.block, (h.lower, h.upper), timeline.unit)
    return replace(rows, zero=timeline.zero - 1) if timeline.zero.size else rows
