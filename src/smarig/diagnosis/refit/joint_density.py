"""The joint density: the density identified together with effects.

    ν ← max(ν + E[δν | all positions], 0),     δν of the prior of ``density_prior`` about ν, likeliest sds

is repeated until the likelihood rises no more, because a prior in proportion to the density is only as good as that
density. The iteration starts from a positive measure fitted to settled positions.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf

import numpy as np

from smarig.core import Array
from smarig.diagnosis.refit.coupled_readings import effect_contribution
from smarig.diagnosis.refit.density_prior import DensityPrior, density_prior
from smarig.diagnosis.refit.moved_density import with_moved_density
from smarig.diagnosis.refit.refit import Refit, refit
from smarig.identification import Observations, fit_table, surface_through_states
from smarig.preisach import Everett, FodSurface
from smarig.replay import PlantModel, Prediction, Timeline, predict

START_SMOOTHING = 1e-14  # λ of the initial measure
MAX_ROUNDS = 30
AS_GOOD = 1.05  # times the error of another density: chance of the fit
MIN_ROUND_GAIN = 2.0  # nats: a round that gains less is the last


@dataclass(frozen=True, eq=False)
class JointDensity:
    """A plant model with a density identified together with its effects, its prediction, and its readings refitted."""

    plant_model: PlantModel
    prediction: Prediction
    refitted: Refit


def joint_density(
    timeline: Timeline,
    plant_model: PlantModel,
    warm_start: Refit | None = None,
    prior: Everett | None = None,
) -> JointDensity:
    """The plant model with a new density; ``warm_start``: start at the result of another refit.

    The density is identified from positions only: what other channels show is left to the effects. Its prior is about
    ``prior``, or about itself. With a ``prior``, rounds follow the inputs, where the output acts back on them, and the
    slopes by which fluctuations of the room act.
    """
    best = _start(timeline, plant_model, warm_start, prior)
    for _ in range(MAX_ROUNDS):
        best = best.next(timeline)
        if best.gain < MIN_ROUND_GAIN:
            break
    refitted = best.refitted
    if len(timeline.positions_only.all_readings) < len(timeline.all_readings):
        about = best.prior.along(best.prediction) if best.prior else None
        refitted = refit(timeline, best.prediction, best.plant_model, refitted, prior=about)
    return JointDensity(best.plant_model, best.prediction, refitted)


def joint_density_from_best_start(
    timeline: Timeline, plant_model: PlantModel, original: Everett, warm_start: Refit | None = None
) -> JointDensity:
    """The likelier of ``joint_densities_from_starts``."""
    found = joint_densities_from_starts(timeline, plant_model, original, warm_start)
    return max(found, key=lambda joint: joint.refitted.log_evidence)


def joint_densities_from_starts(
    timeline: Timeline, plant_model: PlantModel, original: Everett, warm_start: Refit | None = None
) -> Iterator[JointDensity]:
    """The plant model with a density that is its own prior, from each of two starts.

    The starts are the density of the model, which was identified without its effects, and a positive measure of settled
    positions. If ``original``, the density before all, is a surface, that is fitted again along the inputs with
    effects; another density is moved to where effects move the input. It may be negative somewhere (Prop. 4.6); the
    measure is not affected by errors of the model.
    """
    for start in _both(timeline, plant_model, original):
        yield joint_density(timeline, start, warm_start)


def with_positive_measure(timeline: Timeline, plant_model: PlantModel) -> PlantModel:
    """The plant model with a positive measure that is fitted to settled positions."""
    return replace(plant_model, hysteresis=fit_table(_settled_rows(timeline, plant_model), START_SMOOTHING))


def _both(timeline: Timeline, plant_model: PlantModel, original: Everett) -> Iterator[PlantModel]:
    surface = None
    if isinstance(original, FodSurface):
        surface = surface_through_states(_settled_rows(timeline, plant_model), original)
    if surface is not None:
        yield replace(plant_model, hysteresis=surface)
    else:
        yield with_moved_density(timeline, plant_model, plant_model.hysteresis)
    yield with_positive_measure(timeline, plant_model)


def with_posterior_density(
    timeline: Timeline, plant_model: PlantModel, refitted: Refit, given: PlantModel | None = None
) -> PlantModel:
    """The plant model with the posterior density of its readings, with its own, or as ``given``: what fits best.

    A refit that fits worse than the given model has failed, and must not be diagnosed. A smooth prior compares
    hypotheses; the density that a model is offered with may follow the readings, with a prior as rough as itself.
    """
    posterior = replace(plant_model, hysteresis=refitted.posterior.table())
    following = _following(timeline, plant_model, refitted)
    candidates = (plant_model, posterior, following, *([given] if given else []))
    return min(candidates, key=lambda s: settled_rms(timeline, s))


def with_density_for_effects(
    timeline: Timeline, plant_model: PlantModel, refitted: Refit, base: PlantModel
) -> PlantModel:
    """A plant model with effects and the density that fits best, or one nearer to that of the base model.

    That is moved with the input; what no reading determines stays as it is there. Effects that only another channel
    shows leave the positions as they were, so it is kept if it fits as well; else, one that follows from it.
    """
    moved = with_moved_density(timeline, plant_model, base.hysteresis)
    candidates = [
        moved,
        _following(timeline, moved, refitted),
        with_posterior_density(timeline, plant_model, refitted),
    ]
    errors = [position_rms(timeline, s) for s in candidates]
    noise = {"settled": refitted.noise.settled, "moving": refitted.noise.moving}
    as_good = {k: max(AS_GOOD * min(e[k] for e in errors), noise[k]) for k in errors[0]}
    good = [s for s, e in zip(candidates, errors) if all(e[k] <= as_good[k] for k in e)]
    return good[0] if good else candidates[-1]


def _following(timeline: Timeline, plant_model: PlantModel, refitted: Refit) -> PlantModel:
    """The plant model with the density that follows from its own by two rounds without smoothing."""
    found, start, positions = plant_model, refitted, timeline.positions_only
    for _ in range(2):
        prediction = predict(timeline, found).positions_only
        start = refit(positions, prediction, found, start, smoothing=0.0, from_both_sides=False)
        found = replace(found, hysteresis=start.posterior.table())
    return found


def settled_rms(timeline: Timeline, plant_model: PlantModel) -> float:
    """The rms error of a plant model at settled positions, with free zeros."""
    return position_rms(timeline, plant_model)["settled"]


def position_rms(timeline: Timeline, plant_model: PlantModel) -> dict[str, float]:
    """The rms errors of a plant model at settled and at moving positions, with free zeros."""
    prediction = predict(timeline, plant_model)
    free = timeline.zero if timeline.zero.size else np.zeros(len(timeline.settled))
    found = {}
    for r in timeline.positions_only.all_readings:
        error, zero = r.value - prediction.values[r.kind], free[r.step]
        own = [error[zero == z] for z in np.unique(zero)]
        found[r.kind] = float(np.std(np.concatenate([e - e.mean() for e in own])))
    return found


@dataclass(frozen=True, eq=False)
class _FixedPrior:
    """A prior about ``density``: one along all inputs that equal those of ``prediction``."""

    density: Everett
    prediction: Prediction

    @cached_property
    def _along(self) -> DensityPrior:
        return density_prior(self.prediction, self.density)

    def along(self, prediction: Prediction) -> DensityPrior:
        """The prior for the coupled readings of a prediction."""
        if np.array_equal(prediction.hysteresis_input_K, self.prediction.hysteresis_input_K):
            return self._along
        return density_prior(prediction, self.density)


@dataclass(frozen=True, eq=False)
class _Round:
    """A plant model, its prediction of the timeline, its positions refitted, and what the last round gained, in nats.

    ``contribution`` (n,) is that of the effects to positions: no density changes it much. ``prior`` is None if it is
    about the density of the plant model.
    """

    plant_model: PlantModel
    prediction: Prediction
    refitted: Refit
    contribution: Array
    prior: "_FixedPrior | None"
    gain: float = inf

    def next(self, timeline: Timeline) -> "_Round":
        """The round that follows, or the same if that gains nothing."""
        model = replace(self.plant_model, hysteresis=self.refitted.posterior.table())
        prediction = predict(timeline, model)
        own = prediction.positions_only
        refitted = refit(
            timeline.positions_only,
            own,
            model,
            self.refitted,
            self.contribution,
            None if self.prior is None else self.prior.along(prediction).first(own.output.size),
            from_both_sides=False,
        )
        gain = refitted.log_evidence - self.refitted.log_evidence
        if gain <= 0:
            return replace(self, gain=0.0)
        return _Round(model, prediction, refitted, self.contribution, self.prior, gain)


def _start(
    timeline: Timeline, plant_model: PlantModel, warm_start: Refit | None, prior: Everett | None
) -> _Round:
    prediction, positions = predict(timeline, plant_model), timeline.positions_only
    own = prediction.positions_only
    contribution = effect_contribution(positions, own, plant_model)
    fixed = _FixedPrior(prior, prediction) if prior else None
    about = None if fixed is None else fixed.along(prediction).first(own.output.size)
    refitted = refit(positions, own, plant_model, warm_start, contribution, about)
    return _Round(plant_model, prediction, refitted, contribution, fixed)


def _settled_rows(timeline: Timeline, plant_model: PlantModel) -> Observations:
    """The settled positions without what effects add to them, along the inputs with effects."""
    n, prediction = len(timeline.settled), predict(timeline, plant_model)
    y = timeline.settled.value - (prediction.values["settled"] - prediction.output[:n])
    h = plant_model.hysteresis
    rows = Observations.of_states(prediction.states[:n], y, timeline.block, (h.lower, h.upper), timeline.unit)
    return replace(rows, zero=timeline.zero - 1) if timeline.zero.size else rows
