"""The model that the heaviest hypothesis extends, its parameters, and its gain on held-out runs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf

import numpy as np

from smarig.core import Array
from smarig.diagnosis.comparison.commanded.commanded_problem import CommandedProblem, FittedPlant
from smarig.diagnosis.comparison.commanded.commanded_search import SearchedHypotheses
from smarig.diagnosis.comparison.commanded.drawn_values import drawn_values
from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis, Part, Trial
from smarig.diagnosis.comparison.weights import Weights
from smarig.diagnosis.held_out_gain import HeldOutGain, held_out_gain
from smarig.diagnosis.refit.joint_density import with_density_for_effects, with_posterior_density
from smarig.plant import LEARNED
from smarig.record import Run
from smarig.replay import PlantModel


@dataclass(frozen=True, eq=False)
class Extension:
    """The ``extended`` model with the effects or the law ``parts``, and the ``base`` model, both with their densities.

    ``draws`` are values of each parameter under resampled blocks; ``score`` is that of the blocks left out, in nats.
    """

    base: PlantModel
    extended: PlantModel
    fitted: FittedPlant
    parts: tuple[Part, ...]
    parameters: Mapping[str, float]
    draws: Mapping[str, Array]
    score: float

    def intervals(self, share: float) -> dict[str, tuple[float, float]]:
        """The central share of the values of each parameter."""
        cuts = [(1 - share) / 2, (1 + share) / 2]
        return {n: (float(q[0]), float(q[1])) for n, d in self.draws.items() for q in [np.quantile(d, cuts)]}


def extension_of(subject: CommandedProblem, found: SearchedHypotheses, weights: Weights) -> Extension:
    """The extension by the heaviest hypothesis with effects that were fitted; by none, if the base outweighs all."""
    base = with_posterior_density(
        subject.timeline, subject.base.plant_model, subject.base.refitted, subject.given
    )
    best = _heaviest_fitted(found, weights)
    if best is None:
        return Extension(base, base, subject.base, (), {}, {}, -inf)
    parts = _effects(best)
    fitted = found.models[parts]
    extended = with_density_for_effects(subject.timeline, fitted.plant_model, fitted.refitted, base)
    alone = next(
        (h for h in found.hypotheses if h.parts == parts), best
    )  # beside a variable, values are not varied
    draws = {n: drawn_values(alone, n, weights.shares) for n in best.best.parameters}
    return Extension(base, extended, fitted, parts, dict(best.best.parameters), draws, best.score)


def law_extensions(subject: CommandedProblem, found: SearchedHypotheses, base: PlantModel) -> list[Extension]:
    """The extensions by learned laws that predict blocks left out better than nothing."""
    laws = []
    for h in found.hypotheses:
        score = max((t.score for t in h.trials if _has_law(t)), default=-inf)
        if len(h.parts) == 1 and h.parts in found.models and score > found.hypotheses[0].score:
            fitted = found.models[h.parts]
            extended = with_density_for_effects(subject.timeline, fitted.plant_model, fitted.refitted, base)
            laws.append(Extension(base, extended, fitted, h.parts, {}, {}, score))
    return laws


def _has_law(trial: Trial) -> bool:
    return any(name.startswith(f"{LEARNED}.") for name in trial.parameters)


def _effects(h: ComparedHypothesis) -> tuple[Part, ...]:
    return tuple(p for p in h.parts if p.kind == "effect")


def _heaviest_fitted(found: SearchedHypotheses, weights: Weights) -> ComparedHypothesis | None:
    """The heaviest hypothesis with effects that were fitted."""
    own = [
        (h, w)
        for h, w in zip(weights.hypotheses, weights.weight.tolist())
        if _effects(h) and _effects(h) in found.models
    ]
    return max(own, key=lambda pair: pair[1])[0] if own else None


def gain_with(
    subject: CommandedProblem, extension: Extension, train: Sequence[Run], held_out: Sequence[Run]
) -> HeldOutGain | None:
    """The errors of base and extended model on held-out runs."""
    if not held_out:
        return None
    refitted = extension.fitted.refitted
    return held_out_gain(
        train=train,
        held_out=held_out,
        base=extension.base,
        extended=extension.extended,
        noise=refitted.noise,
        variances=refitted.posterior.variances,
        original=subject.given,
    )


def held_out_shares(
    subject: CommandedProblem,
    found: SearchedHypotheses,
    extension: Extension,
    gain: HeldOutGain | None,
    train: Sequence[Run],
    held_out: Sequence[Run],
) -> dict[Part, float]:
    """By part of an extension, the error on held-out runs with it over that without; empty without such runs.

    What one effect of a pair removes says nothing of the other: each is compared with the other alone.
    """
    shares = {}
    for part in extension.parts if gain else ():
        others = tuple(p for p in extension.parts if p != part)
        alone, own = found.models.get(others) if others else None, gain
        if alone is not None:
            base = with_density_for_effects(
                subject.timeline, alone.plant_model, alone.refitted, extension.base
            )
            own = gain_with(subject, replace(extension, base=base), train, held_out)
        if own is not None and own.base:
            shares[part] = own.extended / own.base
    return shares
