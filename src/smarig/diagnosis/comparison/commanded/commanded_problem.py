"""What is compared: a wire's timeline, its base model with the density identified from it, and the catalogue."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.sparse import csr_matrix

from smarig.core import Array
from smarig.diagnosis.comparison.commanded.block_scores import (
    Problem,
    channel_problems,
    coupled_problem,
    trial_of,
)
from smarig.diagnosis.comparison.commanded.channel_model import ChannelModel, channel_models
from smarig.diagnosis.comparison.commanded.kernel_shapes import PLAUSIBLE_ROOM_K
from smarig.diagnosis.comparison.compared_hypothesis import Part, Trial
from smarig.diagnosis.refit.coupled_readings import CoupledReadings, coupled_readings
from smarig.diagnosis.refit.joint_density import (
    JointDensity,
    joint_densities_from_starts,
    joint_density,
)
from smarig.diagnosis.refit.memory_noise import memory_covariance
from smarig.diagnosis.refit.moved_density import moved_with, without_effects
from smarig.diagnosis.refit.refit import Refit, refit
from smarig.plant import Effect, EffectType
from smarig.preisach import Everett
from smarig.replay import PlantModel, Prediction, Timeline, predict


@dataclass(frozen=True, eq=False)
class FittedPlant:
    """A plant model with its prediction, its readings refitted, and the Gaussian problems of its blocks.

    ``prior`` is the density that the prior of its density is about.
    """

    plant_model: PlantModel
    prior: Everett
    prediction: Prediction
    refitted: Refit
    problems: tuple[Problem, ...]

    @property
    def effects(self) -> tuple[Effect, ...]:
        """The effects of the catalogue that it has, those of the given model first, and learned laws."""
        return self.plant_model.catalogue_effects

    @property
    def output(self) -> Array:
        """What the density contributes to each coupled reading (n,), in its unit."""
        return _output(self.prediction, self.plant_model)

    @property
    def parameters(self) -> dict[str, float]:
        """Values by "effect.parameter"."""
        return {f"{e.kind.name}.{n}": v for e in self.effects for n, v in e.values.items()}


@dataclass(frozen=True, eq=False)
class CommandedProblem:
    """The timeline of the training runs, the hysteresis of the given model, and the ``catalogue`` to try.

    ``reference`` has the density that the priors of all hypotheses are about; None: that of the base.
    """

    timeline: Timeline
    given: PlantModel
    catalogue: tuple[EffectType, ...]
    channels: tuple[ChannelModel, ...]
    reference: PlantModel | None = None

    @classmethod
    def of(cls, timeline: Timeline, given: PlantModel, catalogue: Sequence[EffectType]) -> "CommandedProblem":
        """The subject of a comparison, with the models of its independent channels."""
        h = given.hysteresis
        return cls(timeline, given, tuple(catalogue), channel_models(timeline, h.upper - h.lower))

    @cached_property
    def original(self) -> Everett:
        """The hysteresis of the given model."""
        return self.given.hysteresis

    @cached_property
    def base(self) -> FittedPlant:
        """The given model with the density identified from the timeline."""
        if self.reference is not None:
            return self._about(self.reference, self.reference.hysteresis)
        starts = joint_densities_from_starts(self.timeline, self.given, self.original)
        return self._best([self._about(f.plant_model, f.plant_model.hysteresis, f.refitted) for f in starts])

    def with_density(self, effects: Sequence[Effect], start: FittedPlant) -> FittedPlant:
        """A plant model with these effects and a density of its own; variances are searched from those of ``start``."""
        model = self.with_effects(start, effects)
        return self._about(model, self._prior(model), start.refitted)

    def with_own_prior(self, effects: Sequence[Effect], start: FittedPlant) -> FittedPlant:
        """The same with a density that is its own prior: what effects hid in the reference does not hold them back."""
        model = self.with_effects(start, effects)
        model = replace(model, hysteresis=self._prior(model))
        starts = joint_densities_from_starts(self.timeline, model, self.original, start.refitted)
        return self._best([self._fitted(f, f.plant_model.hysteresis) for f in starts])

    def _best(self, fits: Sequence[FittedPlant]) -> FittedPlant:
        """The one that predicts blocks left out best: others may be as likely, with more noise and less density."""
        return max(fits, key=lambda fitted: self.trial(fitted).score)

    def with_reference_from(self, fitted: FittedPlant) -> "CommandedProblem":
        """The same with priors about the density of a fitted model that is its own prior, moved back."""
        found = joint_density(self.timeline, fitted.plant_model, fitted.refitted)
        plain = without_effects(self.timeline, found.plant_model, found.prediction)
        return replace(self, reference=replace(plain, effects=self.given.effects))

    def _about(self, model: PlantModel, prior: Everett, warm: Refit | None = None) -> FittedPlant:
        model = replace(model, hysteresis=prior)
        return self._fitted(joint_density(self.timeline, model, warm, prior), prior)

    def _prior(self, model: PlantModel) -> Everett:
        """The density of the reference, moved with the input: one for all, so no hypothesis gains by its choice."""
        reference = self.reference or self.base.plant_model
        return moved_with(self.timeline, reference, self._of_reference, model)

    @cached_property
    def _of_reference(self) -> Prediction:
        return self.base.prediction if self.reference is None else predict(self.timeline, self.reference)

    def at(self, plant_model: PlantModel, warm: Refit) -> FittedPlant:
        """A plant model as it is, with the likeliest variances."""
        prediction, prior = predict(self.timeline, plant_model), self._prior(plant_model)
        refitted = refit(self.timeline, prediction, plant_model, warm, prior=prior)
        return self._fitted(JointDensity(plant_model, prediction, refitted), prior)

    def with_effects(self, fitted: FittedPlant, effects: Sequence[Effect]) -> PlantModel:
        """The plant model with these effects of the catalogue, which include those of the given model."""
        kept = [e for e in self.given.effects if e not in self.given.catalogue_effects]
        return replace(fitted.plant_model, effects=(*kept, *effects))

    def parts(self, fitted: FittedPlant) -> tuple[Part, ...]:
        """What a fitted model adds to the given one; a learned law is a dependence on its variable."""
        present = {e.kind.name for e in self.given.catalogue_effects}
        kinds = [e.kind for e in fitted.effects if e.kind.name not in present]
        return tuple(
            sorted(Part("variable", k.shape.variable) if k.shape else Part("effect", k.name) for k in kinds)
        )

    def trial(self, fitted: FittedPlant) -> Trial:
        """The scores of a fitted model, less what its parameters gain by being fitted to the scored blocks too."""
        found = trial_of(self.timeline, fitted.problems, fitted.parameters)
        return less_optimism(found, fitted.effects)

    def readings(self, fitted: FittedPlant) -> tuple[CoupledReadings, Array]:
        """The coupled readings of a fitted model, and the covariance per K² of remembered noise."""
        found = coupled_readings(self.timeline, fitted.prediction, fitted.plant_model, prior=fitted.prior)
        return found, memory(found.slopes, found.times, fitted)

    def scatter(self, fitted: FittedPlant) -> float:
        """What noise gives to a settled position, with plausible fluctuations of the room: a standard deviation.

        If more fits best, it is no noise: an effect that is missing looks like a room that fluctuates.
        """
        readings, remembered = self.readings(fitted)
        *others, room = fitted.refitted.log_components
        sizes = np.array([*others, min(room, np.log10(PLAUSIBLE_ROOM_K))])
        square = np.diag(readings.covariance.noise_covariance(remembered, sizes))
        return float(np.sqrt(np.mean((square * readings.scale**2)[: len(self.timeline.settled)])))

    def fluctuates(self, fitted: FittedPlant) -> bool:
        """Whether errors go with time as a room does that fluctuates by more than is plausible, over several steps."""
        noise, steps_s = fitted.refitted.noise, np.diff(self.timeline.settled.t_s)
        return noise.temperature_K > PLAUSIBLE_ROOM_K and noise.correlation_s > float(np.median(steps_s))

    def _fitted(self, found: JointDensity, prior: Everett) -> FittedPlant:
        model, prediction, refitted = found.plant_model, found.prediction, found.refitted
        n = refitted.coupled
        factor, scale = refitted.factor[:n, :n], refitted.scale[:n]
        output = _output(prediction, model)
        y = factor @ refitted.data[:n] + output / scale  # a mean density, fitted to all blocks, would leak
        coupled = coupled_problem(self.timeline, y, scale, factor @ factor.T, abs(model.stroke))
        channels = channel_problems(self.timeline, prediction, self.channels)
        return FittedPlant(model, prior, prediction, refitted, (coupled, *channels))


def _output(prediction: Prediction, model: PlantModel) -> Array:
    return prediction.output_slope * (prediction.output - model.hysteresis.y_lower)


def less_optimism(trial: Trial, effects: Sequence[Effect], others: int = 0) -> Trial:
    """A trial whose parameters, and ``others``, were fitted to all blocks: each gains a nat by that (Akaike)."""
    free = sum(len(e.kind.parameters[1:]) + 1 for e in effects) + others
    return replace(trial, log_scores=trial.log_scores - free / trial.log_scores.size)


def memory(slopes: csr_matrix, times: Array, fitted: FittedPlant) -> Array:
    """The covariance of remembered noise per K² (n, n), in strokes², with the fitted correlation time."""
    seconds = fitted.refitted.noise.correlation_s
    return memory_covariance(slopes, times, seconds) / fitted.plant_model.stroke**2


def by_kind(timeline: Timeline, stacked: Array) -> Mapping[str, Array]:
    """Stacked readings (N,) or (N, m) by kind."""
    ends = np.cumsum([len(r) for r in timeline.all_readings])
    return dict(zip([r.kind for r in timeline.all_readings], np.split(stacked, ends[:-1])))
