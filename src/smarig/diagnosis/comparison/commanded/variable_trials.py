"""Hypotheses of a smooth dependence on one variable: at the output or the input, and in the other channels.

    y ~ N(0, C + s² K_z),    K_z as in ``discrepancy_kernels``

Places and lengths are the trials of a variable; their variances are the likeliest.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from smarig.core import Array
from smarig.diagnosis.comparison.commanded.block_scores import (
    Problem,
    channel_problems,
    coupled_problem,
    trial_of,
)
from smarig.diagnosis.comparison.commanded.channel_model import fluctuations
from smarig.diagnosis.comparison.commanded.commanded_problem import (
    CommandedProblem,
    FittedPlant,
    less_optimism,
)
from smarig.diagnosis.comparison.commanded.discrepancy_kernels import Kernel, kernels, screened_kernels
from smarig.diagnosis.comparison.commanded.kernel_shapes import (
    FADING,
    HISTORY,
    PLAUSIBLE_ROOM_K,
    RANK_LENGTH,
    TIME_SHARES,
    falling,
    ranks,
)
from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis, Part, Trial
from smarig.diagnosis.comparison.weights import PAIR_NATS
from smarig.diagnosis.refit.coupled_readings import CoupledReadings
from smarig.diagnosis.refit.variance_components import ReadingCovariance

CHANNEL_VARIABLES = ("time", "level")
NEAR_NATS, NEAR_SHARE = 10.0, 0.2  # behind the best: what is farther will not become the best


def least_near(best: float) -> float:
    """The gain in nats from which on a hypothesis may become the best, which gains ``best`` now."""
    return best - NEAR_NATS - NEAR_SHARE * best


def _also(alone: ComparedHypothesis, pair: ComparedHypothesis) -> ComparedHypothesis:
    """A hypothesis with the trials of a pair beside its own, less what the prior of a pair takes."""
    dearer = [replace(t, log_scores=t.log_scores - PAIR_NATS / t.log_scores.size) for t in pair.trials]
    return replace(alone, trials=(*alone.trials, *dearer))


@dataclass(frozen=True, eq=False)
class Discrepancies:
    """The kernels about a fitted model, with its readings; ``start`` are the sds of a search for the likeliest."""

    subject: CommandedProblem
    fitted: FittedPlant
    readings: CoupledReadings
    memory: Array
    start: Array
    kernels: tuple[Kernel, ...]

    @classmethod
    def about(cls, subject: CommandedProblem, fitted: FittedPlant) -> "Discrepancies":
        """All kernels about a fitted model."""
        readings, memory = subject.readings(fitted)
        most = min(fitted.refitted.log_components[-1], np.log10(PLAUSIBLE_ROOM_K))
        start = np.append(fitted.refitted.log_components[:-1], most)
        C = readings.covariance.covariance(memory, start)
        return cls(subject, fitted, readings, memory, start, tuple(kernels(subject, fitted, readings, C)))

    @cached_property
    def _screened(self) -> tuple[Array, Array]:
        C = self.readings.covariance.covariance(self.memory, self.start)
        return screened_kernels(C, self.readings, self.kernels)

    @cached_property
    def gains(self) -> Array:
        """Nats (kernels,) that each kernel gains by screening, and its variable in the other channels."""
        in_channels = {v: self._channel_gain(v) for v in CHANNEL_VARIABLES}
        return self._screened[0] + [in_channels.get(k.plain, 0.0) for k in self.kernels]

    @cached_property
    def ranking(self) -> tuple[Problem, ...]:
        """The problems of the fitted model, without a fluctuation of the room that would hide a drift."""
        C = self.readings.covariance.covariance(self.memory, self.start)
        first, *others = self.fitted.problems
        return (coupled_problem(self.subject.timeline, first.y, first.scale, C, first.span), *others)

    @property
    def variables(self) -> list[str]:
        """The variables, the most promising first."""
        order = np.argsort(-self.gains).tolist()
        return list(dict.fromkeys(self.kernels[j].plain for j in order))

    def gain(self, variable: str) -> float:
        """Nats that the likeliest kernel of a variable gains by screening."""
        return max(g for k, g in zip(self.kernels, self.gains.tolist()) if k.plain == variable)

    def hypotheses(self, most: int) -> list[ComparedHypothesis]:
        """The most promising variables.

        Errors that follow the travel in any way predict whatever else has a wrong shape. Where they predict best, the
        other variables are also tried beside them, for the price of a pair: one that still predicts is the cause.
        """
        found = [self.hypothesis(v) for v in self.variables[:most]]
        best = max(found, key=lambda h: h.score)
        if best.parts[-1].name != HISTORY or self.kernels[self._promising(HISTORY)[0]].variable == FADING:
            return found
        freest = self._with_variable(HISTORY, [v for v in self.variables[:most] if v != HISTORY])
        return [h if h is best else _also(h, freest.hypothesis(h.parts[-1].name)) for h in found]

    def hypothesis(self, variable: str) -> ComparedHypothesis:
        """The fitted model with a dependence on a variable; the kernels that are about as promising are its trials."""
        channels = self._channels(variable)
        trials = [self._trial(j, channels) for j in self._promising(variable)]
        parts = self.subject.parts(self.fitted)
        return ComparedHypothesis((*parts, Part("variable", variable)), tuple(trials))

    def _promising(self, variable: str) -> list[int]:
        """The kernels of a variable that are about as promising as its best, the best first."""
        own = [j for j, k in enumerate(self.kernels) if k.plain == variable]
        least = least_near(max(float(self.gains[own].max()), 0.0))
        return [j for j in sorted(own, key=lambda j: -self.gains[j]) if self.gains[j] >= least]

    def _with_variable(self, variable: str, others: Sequence[str]) -> "Discrepancies":
        """The same about readings that depend on a variable as well, with the promising kernels of ``others``."""
        covariance, components = self._likeliest(self._promising(variable)[0])
        kept = tuple(self.kernels[j] for v in others for j in self._promising(v))
        readings = replace(self.readings, covariance=covariance)
        return replace(self, readings=readings, start=components, kernels=kept)

    def _trial(self, j: int, channels: tuple[Problem, ...]) -> Trial:
        found = trial_of(self.subject.timeline, (self._with(j), *channels), self.fitted.parameters)
        return less_optimism(found, self.fitted.effects, self.kernels[j].free)

    def _likeliest(self, j: int) -> tuple[ReadingCovariance, Array]:
        """The covariance with a kernel, and its likeliest components."""
        found = self.readings.covariance.with_shape(self.kernels[j].shape())
        at, size = len(found.shapes) - 1, np.log10(self._screened[1][j])
        return found, found.likeliest_near(self.memory, np.insert(self.start, at, size))[1]

    def _with(self, j: int) -> Problem:
        found, components = self._likeliest(j)
        C = found.covariance(self.memory, components)
        first = self.fitted.problems[0]
        return coupled_problem(self.subject.timeline, self.readings.covariance.y, first.scale, C, first.span)

    def _channel_gain(self, variable: str) -> float:
        """Nats on blocks left out of the other channels, if they may depend on a variable."""
        count = int(self.subject.timeline.block.max()) + 1

        def score(problems: Sequence[Problem]) -> float:
            return float(sum(p.scores(p.y, count)[1].sum() for p in problems))

        return max(score(self._channels(variable)) - score(self.fitted.problems[1:]), 0.0)

    def _channels(self, variable: str) -> tuple[Problem, ...]:
        """The other channels, which may depend on the same variable."""
        if variable not in CHANNEL_VARIABLES:
            return self.fitted.problems[1:]
        timeline, models = self.subject.timeline, []
        readings = {r.kind: r for r in timeline.other_readings}
        for m in self.subject.channels:
            r = readings[m.kind]
            if variable == "level":
                kernels = [falling(ranks(timeline.target_K[r.step]), RANK_LENGTH)]
            else:
                kernels = [falling(r.t_s, TIME_SHARES[1] * float(np.ptp(r.t_s)))]
                kernels += fluctuations(r.t_s) if m.kind == "current" else []
            models.append(m.with_kernels(kernels))
        return channel_problems(timeline, self.fitted.prediction, models)
