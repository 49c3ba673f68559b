"""Kernels of a smooth dependence on one variable, by where it acts: the hypotheses of no effect of the catalogue.

    output: 1    gain: output · output′    input: slope · slope′    heat: slope · heating · heating′ · slope′

Of time, slopes are those to all inputs that an output remembers. A heat loss that changes acts as "heat": it moves the
input in proportion to the heating. Trends and jumps are there where no effect of the catalogue is one: against rough
kernels alone, an effect of a simple shape would win for being simple.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, eigh, solve_triangular

from smarig.core import Array
from smarig.diagnosis.comparison.commanded.commanded_problem import CommandedProblem, FittedPlant, by_kind
from smarig.diagnosis.comparison.commanded.kernel_shapes import (
    FADING,
    FADING_STEPS,
    PLAIN,
    RANK_LENGTH,
    SIZES,
    TIME_SHARES,
    WALK,
    falling,
    ranks,
    recent_motion,
    walk_kernel,
)
from smarig.diagnosis.drive_statistics import DriveStatistics
from smarig.diagnosis.refit.coupled_readings import CoupledReadings
from smarig.preisach import sensitivities
from smarig.replay import OUTPUT_DEPENDENT_KINDS

JUMP_EDGE = 0.05  # of the record: a jump nearer to its ends moves too few readings


@dataclass(frozen=True, eq=False)
class Kernel:
    """A dependence on ``variable`` that acts at a ``place``: ``shape()`` (n, n) in strokes² or per K².

    It is computed when it is asked for: together, all shapes are larger than anything else of a diagnosis. ``free``
    counts the parameters that are fitted to the scored blocks: the time of a jump.
    """

    variable: str
    place: str
    shape: Callable[[], Array]
    free: int = 0

    @property
    def plain(self) -> str:
        """The variable that a verdict names."""
        return PLAIN.get(self.variable, self.variable)


@dataclass(frozen=True, eq=False)
class _Geometry:
    """Times, sessions and slopes (n,) of the coupled readings; ``remembered`` (n, p) are slopes to inputs at ``at_s``.

    ``is_position`` (n,) is 0 at resistances: an error of the position itself leaves them alone. ``heating`` (p,) are
    the remembered inputs, in shares of the range.
    """

    t_s: Array
    session: NDArray[np.int64]
    is_position: Array
    slope: Array
    level: Array
    remembered: Array
    at_s: Array
    heating: Array

    @classmethod
    def of(cls, subject: CommandedProblem, fitted: FittedPlant, readings: CoupledReadings) -> "_Geometry":
        prediction, model = fitted.prediction, fitted.plant_model
        coupled = [r for r in subject.timeline.all_readings if r.kind in OUTPUT_DEPENDENT_KINDS]
        step = np.concatenate([r.step for r in coupled])
        h = model.hysteresis
        # a timeline of several sessions has one clock, and its ticks are in order
        heat = np.interp(readings.times, prediction.t_s, prediction.hysteresis_input_K)
        return cls(
            t_s=np.concatenate([r.t_s for r in coupled]),
            session=subject.timeline.session[step],
            is_position=np.concatenate([np.full(len(r), float(r.kind != "resistance")) for r in coupled]),
            slope=np.array([s[-1] for s in sensitivities(h, prediction.states)]) / model.stroke,
            level=(prediction.output - h.y_lower) / model.stroke,
            remembered=readings.slopes.toarray() / model.stroke,
            at_s=readings.times,
            heating=heat / (h.upper - h.lower),
        )

    def output(self, shape: Array) -> Array:
        same = np.equal.outer(self.session, self.session)
        return self.is_position[:, None] * same * shape * self.is_position

    def gain(self, shape: Array) -> Array:
        return self.output(self.level[:, None] * shape * self.level)

    def input(self, shape: Array) -> Array:
        return self.remembered @ shape @ self.remembered.T

    def heat(self, shape: Array) -> Array:
        return self.input(self.heating[:, None] * shape * self.heating)


def kernels(
    subject: CommandedProblem, fitted: FittedPlant, readings: CoupledReadings, C: Array
) -> list[Kernel]:
    """Every kernel, over positions and resistances; ``C`` (n, n), the covariance without them, says when jumps are."""
    own = _Geometry.of(subject, fitted, readings)
    found = list(_of_time(own))
    found += [k for k in (_jump(own, readings, C, heat=False), _jump(own, readings, C, heat=True)) if k]
    return found + list(_of_others(subject, fitted, own))


def _of_time(own: _Geometry) -> Iterator[Kernel]:
    lasting = float(np.ptp(own.t_s)) or 1.0
    middle = float(own.t_s.mean())  # a density identified from all readings is that of their middle
    trend, trend_at = (own.t_s - middle) / lasting, (own.at_s - middle) / lasting
    for share in TIME_SHARES:
        yield Kernel(
            "time", "output", partial(lambda length: own.output(falling(own.t_s, length)), share * lasting)
        )
        yield Kernel(
            "time", "input", partial(lambda length: own.input(falling(own.at_s, length)), share * lasting)
        )
    longest = TIME_SHARES[-1] * lasting
    yield Kernel("time", "output", lambda: own.output(np.outer(trend, trend)))
    yield Kernel("time", "gain", lambda: own.gain(falling(own.t_s, longest)))
    yield Kernel("time", "gain", lambda: own.gain(np.outer(trend, trend)))
    yield Kernel("time", "heat", lambda: own.heat(falling(own.at_s, longest)))
    yield Kernel("time", "heat", lambda: own.heat(np.outer(trend_at, trend_at)))


def _jump(own: _Geometry, readings: CoupledReadings, C: Array, *, heat: bool) -> Kernel | None:
    """The likeliest jump of the input, or of the heating: t, with all shifts as large as one of full heating."""
    times = np.unique(own.t_s)
    lasting = float(np.ptp(times))
    times = times[(times > times[0] + JUMP_EDGE * lasting) & (times < times[-1] - JUMP_EDGE * lasting)]
    if not times.size:
        return None
    after = (own.at_s[:, None] >= times) - np.mean(own.t_s[:, None] >= times, axis=0)
    traces = own.remembered @ (own.heating[:, None] * after if heat else after)
    factor = cholesky(C, lower=True, check_finite=False)
    slope = readings.covariance.slope
    white = solve_triangular(factor, slope[:, None] * traces, lower=True, check_finite=False)
    data = solve_triangular(factor, readings.covariance.y, lower=True, check_finite=False)
    square = np.sum(white**2, axis=0)
    gain = np.where(square > 0, (data @ white) ** 2 / np.where(square > 0, square, 1.0), 0.0)
    trace = traces[:, int(np.argmax(gain))]
    return Kernel("time", "heat" if heat else "input", lambda: np.outer(trace, trace), free=1)


def _of_others(subject: CommandedProblem, fitted: FittedPlant, own: _Geometry) -> Iterator[Kernel]:
    timeline, prediction = subject.timeline, fitted.prediction
    coupled = [r for r in timeline.all_readings if r.kind in OUTPUT_DEPENDENT_KINDS]

    def both(variable: str, shape: Callable[[], Array]) -> Iterator[Kernel]:
        yield Kernel(variable, "output", lambda: own.is_position[:, None] * shape() * own.is_position)
        yield Kernel(variable, "input", lambda: own.slope[:, None] * shape() * own.slope)

    for name, z in _variables(subject, fitted, coupled).items():
        yield from both(name, partial(falling, ranks(z), RANK_LENGTH))
    block = timeline.block[np.concatenate([r.step for r in coupled])]
    level = ranks(prediction.output)
    yield from both("branch", lambda: np.equal.outer(block, block) * falling(level, RANK_LENGTH))
    yield from both(WALK, partial(walk_kernel, own.session, own.t_s, prediction.output))
    step_s = float(np.median(np.diff(timeline.settled.t_s)))
    for steps in FADING_STEPS:
        recent = recent_motion(prediction, fitted.plant_model, steps * step_s)
        yield Kernel(FADING, "output", lambda z=recent: own.output(falling(ranks(z), RANK_LENGTH)))
        yield Kernel(FADING, "output", lambda z=recent: own.output(np.outer(z, z)))


def _variables(subject: CommandedProblem, fitted: FittedPlant, coupled: Sequence) -> Mapping[str, Array]:
    """The variables that vary, at positions, and at resistances that of the settled position of their step.

    Time has kernels of its own. Nothing can depend on what is the same everywhere: its kernel would be a free offset.
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
    return {name: z for name, z in whole.items() if np.unique(ranks(z)).size > 1}


def screened_kernels(C: Array, readings: CoupledReadings, tried: Sequence[Kernel]) -> tuple[Array, Array]:
    """(gain in nats, size s²) of each kernel beside the covariance ``C`` (n, n), closed form in its eigenvalues."""
    factor = cholesky(C, lower=True, check_finite=False)
    slope = readings.covariance.slope

    def whitened(x: Array) -> Array:
        return solve_triangular(factor, x, lower=True, check_finite=False)

    data, gains, sizes = whitened(readings.covariance.y), [], []
    for kernel in tried:
        shape = slope[:, None] * kernel.shape() * slope
        values, vectors = eigh(whitened(whitened(shape).T), check_finite=False)
        squares = (vectors.T @ data) ** 2
        grown = 1 + SIZES[:, None] * np.maximum(values, 0.0)
        gain = 0.5 * np.sum(squares - squares / grown - np.log(grown), axis=1) - kernel.free
        gains.append(float(gain.max()))
        sizes.append(float(SIZES[int(np.argmax(gain))]))
    return np.array(gains), np.array(sizes)
