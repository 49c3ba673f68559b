"""Hypotheses of a smooth dependence on one variable: at the output or the input, and in the other channels.

    y ~ N(0, C + s² K_z),    K_z as in ``explain.discrepancy``

Places and lengths are the trials of a variable; their variances are the likeliest.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, eigh, solve_triangular

from smarig.diagnosis.comparison.commanded.block_scores import (
    Problem,
    channel_problems,
    coupled_problem,
    trial_of,
)
from smarig.diagnosis.comparison.commanded.commanded_problem import CommandedProblem, FittedPlant, by_kind
from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis, Part
from smarig.diagnosis.drive_statistics import DriveStatistics
from smarig.diagnosis.explain.discrepancy import (
    PLAIN,
    PLAUSIBLE_ROOM_K,
    RANK_LENGTH,
    SIZES,
    TIME_SHARES,
    WALK,
    falling,
    ranks,
    walk_kernel,
)
from smarig.diagnosis.refit.coupled_readings import CoupledReadings
from smarig.diagnosis.refit.memory_noise import memory_covariance
from smarig.preisach import sensitivities
from smarig.replay import OUTPUT_DEPENDENT_KINDS

Array = NDArray[np.float64]
CHANNEL_VARIABLES = ("time", "level")


@dataclass(frozen=True, eq=False)
class Kernel:
    """A dependence on ``variable`` that acts at a ``place``: ``shape`` (n, n) in strokes² or per K²."""

    variable: str
    place: str
    shape: Array

    @property
    def plain(self) -> str:
        """The variable that a verdict names."""
        return PLAIN.get(self.variable, self.variable)


@dataclass(frozen=True, eq=False)
class Discrepancies:
    """The kernels about a fitted model, with its readings, and what each may gain and its size, by screening."""

    subject: CommandedProblem
    fitted: FittedPlant
    readings: CoupledReadings
    memory: Array
    start: Array
    kernels: tuple[Kernel, ...]
    gains: Array
    sizes: Array

    @classmethod
    def about(cls, subject: CommandedProblem, fitted: FittedPlant) -> "Discrepancies":
        """All kernels about a fitted model, screened in closed form."""
        readings, memory = subject.readings(fitted)
        most = min(fitted.refitted.log_components[-1], np.log10(PLAUSIBLE_ROOM_K))
        start = np.append(fitted.refitted.log_components[:-1], most)
        kernels = tuple(_kernels(subject, fitted, readings))
        gains, sizes = _screened(readings.covariance.covariance(memory, start), readings, kernels)
        return cls(subject, fitted, readings, memory, start, kernels, gains, sizes)

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

    def hypothesis(self, variable: str, most: int = 2) -> ComparedHypothesis:
        """The fitted model with a dependence on a variable; the ``most`` promising kernels are its trials."""
        own = [j for j, k in enumerate(self.kernels) if k.plain == variable]
        chosen = sorted(own, key=lambda j: -self.gains[j])[:most]
        channels = self._channels(variable)
        trials = [
            trial_of(
                self.subject.timeline,
                (self._with(j), *channels),
                self.fitted.parameters,
                self.fitted.plant_model,
            )
            for j in chosen
        ]
        parts = [Part("effect", e.kind.name) for e in self.fitted.effects]
        return ComparedHypothesis((*sorted(parts), Part("variable", variable)), tuple(trials))

    def _with(self, j: int) -> Problem:
        found = self.readings.covariance.with_shape(self.kernels[j].shape)
        at = len(found.shapes) - 1
        _, components = found.likeliest_near(self.memory, np.insert(self.start, at, np.log10(self.sizes[j])))
        C = found.covariance(self.memory, components)
        first = self.fitted.problems[0]
        return coupled_problem(self.subject.timeline, self.readings.covariance.y, first.scale, C, first.span)

    def _channels(self, variable: str) -> tuple[Problem, ...]:
        """The other channels, which may depend on the same variable."""
        if variable not in CHANNEL_VARIABLES:
            return self.fitted.problems[1:]
        timeline, models = self.subject.timeline, []
        readings = {r.kind: r for r in timeline.other_readings}
        for m in self.subject.channels:
            r = readings[m.kind]
            if variable == "time":
                length = TIME_SHARES[1] * float(np.ptp(r.t_s))
                models.append(m.with_kernel(falling(r.t_s, length)))
            else:
                models.append(m.with_kernel(falling(ranks(timeline.target_K[r.step]), RANK_LENGTH)))
        return channel_problems(timeline, self.fitted.prediction, models)


def _screened(C: Array, readings: CoupledReadings, kernels: Sequence[Kernel]) -> tuple[Array, Array]:
    """(gain in nats, size s²) of each kernel beside the covariance, closed form in its eigenvalues."""
    factor = cholesky(C, lower=True, check_finite=False)
    slope = readings.covariance.slope

    def whitened(x: Array) -> Array:
        return solve_triangular(factor, x, lower=True, check_finite=False)

    data, gains, sizes = whitened(readings.covariance.y), [], []
    for kernel in kernels:
        shape = slope[:, None] * kernel.shape * slope
        values, vectors = eigh(whitened(whitened(shape).T), check_finite=False)
        squares = (vectors.T @ data) ** 2
        grown = 1 + SIZES[:, None] * np.maximum(values, 0.0)
        gain = 0.5 * np.sum(squares - squares / grown - np.log(grown), axis=1)
        gains.append(float(gain.max()))
        sizes.append(float(SIZES[int(np.argmax(gain))]))
    return np.array(gains), np.array(sizes)


def _kernels(subject: CommandedProblem, fitted: FittedPlant, readings: CoupledReadings):
    """Every kernel, over positions and resistances; an error of the position itself leaves resistances alone."""
    timeline, prediction, model = subject.timeline, fitted.prediction, fitted.plant_model
    coupled = [r for r in timeline.all_readings if r.kind in OUTPUT_DEPENDENT_KINDS]
    step, t_s = np.concatenate([r.step for r in coupled]), np.concatenate([r.t_s for r in coupled])
    is_position = np.concatenate([np.full(len(r), float(r.kind != "resistance")) for r in coupled])
    session = timeline.session[step]
    same = np.equal.outer(session, session)
    slope = np.array([s[-1] for s in sensitivities(model.hysteresis, prediction.states)]) / model.stroke

    def both(variable: str, shape: Array):
        yield Kernel(variable, "output", is_position[:, None] * shape * is_position)
        yield Kernel(variable, "input", slope[:, None] * shape * slope)

    for share in TIME_SHARES:
        seconds = share * float(np.ptp(t_s))
        yield Kernel("time", "output", is_position[:, None] * same * falling(t_s, seconds) * is_position)
        remembered = memory_covariance(readings.slopes, readings.times, seconds) / model.stroke**2
        yield Kernel("time", "input", remembered)
    for name, z in _variables(subject, fitted, coupled).items():
        yield from both(name, falling(ranks(z), RANK_LENGTH))
    block = timeline.block[step]
    yield from both("branch", np.equal.outer(block, block) * falling(ranks(prediction.output), RANK_LENGTH))
    yield from both(WALK, walk_kernel(session, t_s, prediction.output))


def _variables(subject: CommandedProblem, fitted: FittedPlant, coupled: Sequence) -> Mapping[str, Array]:
    """The variables at positions, and at resistances that of the settled position of their step.

    Time has kernels of its own.
    """
    positions = subject.timeline.positions_only
    found = DriveStatistics(positions).variables(fitted.prediction.positions_only)
    settled = len(subject.timeline.settled)
    whole = {}
    for name, z in found.items():
        if name == "time":
            continue
        own = by_kind(positions, z)
        whole[name] = np.concatenate([own[r.kind] if r.kind in own else z[:settled][r.step] for r in coupled])
    return whole
