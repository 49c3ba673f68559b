"""Two properties of every Preisach operator, tested on records alone: the return point, and wiping-out.

Return point: when a minor excursion of the input closes, the output is what it was when the excursion began.
Wiping-out: an extreme input erases what came before, so all branches that start there are one branch.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from smarig.core import Array, root_mean_square
from smarig.measurement import (
    InputRecord,
    MeasurementEffect,
    changed,
    input_noise_sd,
    monotone_branches,
    reversals,
)

Pair = tuple[float, float]  # difference of two outputs that should be equal, and its standard deviation
FEWEST = 3  # pairs: fewer prove nothing
SMALLEST_EXCURSION = 0.05  # of the input's range
SAME_EXTREME = 0.02  # of the input's range
LEVELS = 7  # at which two branches are compared
TIMES_NOISE, SHARE = (
    2.0,
    0.015,
)  # a property holds up to this many times the noise, or this share of the output's range
DRAWS = 1000
LOWER = 0.025


@dataclass(frozen=True)
class PropertyTest:
    """``tested`` pairs of outputs that should be equal: rms difference, and that expected from noise.

    ``lower`` is the 2.5 % quantile of the rms difference when the pairs are drawn again; ``limit`` what may be.
    """

    name: str
    tested: int
    violated_rms: float
    noise: float
    lower: float
    limit: float

    @property
    def holds(self) -> bool:
        """Whether the difference is no more than noise."""
        return self.lower <= self.limit

    def to_json(self) -> dict[str, Any]:
        """The object of this property under ``preisach_properties``."""
        return {
            "tested": self.tested,
            "violated_rms": self.violated_rms,
            "noise": self.noise,
            "holds": self.holds,
        }


@dataclass(frozen=True, eq=False)
class Branches:
    """One record between its reversals ``turns``: monotone input u (n,), output y (n,), and the noise of both."""

    u: Array
    y: Array
    turns: list[int]
    input_sd: float
    output_sd: float

    @classmethod
    def of(cls, record: InputRecord, effects: Sequence[MeasurementEffect]) -> "Branches":
        """A record with the input that its effects leave."""
        change = changed(record, effects)
        turns = reversals(change.input, change.noise)
        noise = input_noise_sd(change.input) if change.noise is None else change.noise
        u = monotone_branches(change.input, turns)
        return cls(u, record.y, turns, noise, input_noise_sd(record.y))

    @property
    def span(self) -> float:
        """Range of the input."""
        return float(np.ptp(self.u))

    def output(self, branch: int, u: Array) -> Array:
        """Outputs at inputs u on a branch, interpolated."""
        rows = slice(self.turns[branch], self.turns[branch + 1] + 1)
        x, y = self.u[rows], self.y[rows]
        return np.interp(u, x, y) if x[-1] > x[0] else np.interp(u, x[::-1], y[::-1])

    def slope(self, branch: int, u: Array) -> Array:
        """|dy/du| at inputs u on a branch, over the range that the noise of the input blurs."""
        h = max(3 * self.input_sd, 0.01 * self.span)
        return np.abs(self.output(branch, u + h) - self.output(branch, u - h)) / (2 * h)

    def sd(self, branches: tuple[int, int], u: Array) -> float:
        """Standard deviation of the difference of two branches at inputs u, root mean square."""
        slopes = [self.slope(b, u) for b in branches]
        square = 2 * self.output_sd**2 + self.input_sd**2 * sum(s**2 for s in slopes)
        return float(np.sqrt(np.mean(square)))


def preisach_properties(
    records: Sequence[InputRecord],
    effects: Sequence[MeasurementEffect] = (),
) -> tuple[PropertyTest, ...]:
    """The tests of both properties on records with the input that effects leave; a property that the records cannot
    show is left out.
    """
    branches = [Branches.of(r, effects) for r in records]
    limit = SHARE * max(float(np.ptp(b.y)) for b in branches)
    found = []
    for name, pairs_of in (("return_point", _closures), ("wiping_out", _repeats)):
        pairs = [pair for b in branches for pair in pairs_of(b)]
        if len(pairs) >= FEWEST:
            found.append(_tested(name, np.array(pairs), limit))
    return tuple(found)


def _tested(name: str, pairs: Array, limit: float) -> PropertyTest:
    difference, sd = pairs.T
    drawn = np.random.default_rng(0).integers(0, difference.size, (DRAWS, difference.size))
    lower = float(np.quantile(np.sqrt(np.mean(difference[drawn] ** 2, axis=1)), LOWER))
    noise = root_mean_square(sd)
    return PropertyTest(
        name, difference.size, root_mean_square(difference), noise, lower, max(TIMES_NOISE * noise, limit)
    )


def _closures(b: Branches) -> Iterator[Pair]:
    """Each minor excursion that closes: the output where it closes minus that where it began."""
    u, turns = b.u, b.turns
    for k in range(1, len(turns) - 2):
        before, start, inner, end = (float(u[t]) for t in turns[k - 1 : k + 3])
        size = abs(inner - start)
        nested = SMALLEST_EXCURSION * b.span <= size < abs(start - before)
        if nested and abs(end - inner) >= size:
            at = np.array([start])
            yield float(b.output(k + 1, at)[0] - b.output(k - 1, at)[0]), b.sd((k - 1, k + 1), at)


def _repeats(b: Branches) -> Iterator[Pair]:
    """Each two successive branches from the same end of the input's range: rms difference where both run."""
    u, turns = b.u, b.turns
    for extreme in (float(u.min()), float(u.max())):
        starts = [
            k
            for k in range(1, len(turns) - 1)
            if abs(float(u[turns[k]]) - extreme) <= SAME_EXTREME * b.span
            and abs(float(u[turns[k + 1]] - u[turns[k]])) >= SMALLEST_EXCURSION * b.span
        ]
        for i, k in zip(starts, starts[1:]):
            nearer = min((float(u[turns[j + 1]]) for j in (i, k)), key=lambda v: abs(v - extreme))
            at = extreme + (nearer - extreme) * np.linspace(0.1, 0.9, LEVELS)
            yield root_mean_square(b.output(k, at) - b.output(i, at)), b.sd((i, k), at)
