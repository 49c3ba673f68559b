"""Steady loops as observations of a measure: sums over the FOD surface.

In the demagnetised state B* (theory.md §1) half of a symmetric measure is up: y = ½(y₋ + y₊) = 0. At an input of
size m that was never exceeded, the other half of the triangle (m, −m) is switched up or down: y = ½(y₋ + y₊) ±
½F(m, −m). So the larger tip of a loop is an absolute reading, and its branches are plain sweeps from there:

    falling  y(u) = y(upper tip) − F(u_upper, u)        rising  y(u) = y(lower tip) + F(u, u_lower)

Without symmetry, loops do not determine B*, so each loop has an offset of its own.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from smarig.core import Array, DataError
from smarig.identification.positive.observations import COMMON, Observations, joined_observations
from smarig.identification.steady_loops import SteadyLoop

SignedSweep = tuple[float, Array | float, Array | float]  # sign, and (α, β) of F


def observations_of_loops(
    loops: Sequence[SteadyLoop], symmetric: bool = True, unit: str = ""
) -> Observations:
    """Both branches of steady loops; a curve is a whole loop, because its branches are images of each other.

    ``symmetric``: the loops were reached from the demagnetised state of a hysteresis that is its own mirror image
    in (0, 0), so their outputs are absolute. Otherwise only changes within a loop count. The range is the largest
    input, symmetric about zero for symmetric loops. Raises DataError without loops, and for a "symmetric" loop that
    does not contain zero.

    >>> u = np.linspace(-1.0, 1.0, 5)
    >>> rising, falling = np.stack([u, u**2 / 2 + u - 0.5], 1), np.stack([u, u - u**2 / 2 + 0.5], 1)[::-1]
    >>> seen = observations_of_loops([SteadyLoop(0, (-1.0, -1.0), (1.0, 1.0), rising, falling, 0.0)])
    >>> len(seen), seen.lower, seen.upper
    (10, -1.0, 1.0)
    """
    if not loops:
        raise DataError("No steady loop was found. Give at least one closed loop.")
    lower, upper = min(loop.lower[0] for loop in loops), max(loop.upper[0] for loop in loops)
    if symmetric:
        upper = max(-lower, upper)
        lower = -upper
    parts = (_of_loop(loop, (lower, upper), symmetric, unit) for loop in loops)
    return joined_observations(parts)


def _of_loop(loop: SteadyLoop, ends: tuple[float, float], symmetric: bool, unit: str) -> Observations:
    low, high = loop.lower[0], loop.upper[0]
    if symmetric and not low < 0 < high:
        raise DataError(
            f"Loop {loop.number} runs from {low:g} to {high:g}; a loop of a symmetric hysteresis must contain 0."
        )
    rising, falling = (np.clip(branch[:, 0], low, high) for branch in (loop.rising, loop.falling))
    half = 0.5 if symmetric else 0.0
    if high >= -low or not symmetric:  # the upper tip is the absolute one
        start: list[SignedSweep] = [(half, high, -high)]
        down, up = start, [*start, (-1.0, high, low)]
    else:
        start = [(-half, -low, low)]
        down, up = [*start, (1.0, high, low)], start
    rows = _BranchRows(ends if symmetric else ())
    rows.add(rising, loop.rising[:, 1], [*up, (1.0, rising, low)])
    rows.add(falling, loop.falling[:, 1], [*down, (-1.0, high, falling)])
    return rows.observations(COMMON if symmetric else 0, ends, unit)


@dataclass
class _BranchRows:
    """Collects branches: each reading ½ Σ y(u, u) over ``saturations`` u, and sweeps F(α, β) = y(α, α) − y(α, β)."""

    saturations: tuple[float, ...] = ()
    y: list[Array] = field(default_factory=list)
    terms: list[Array] = field(default_factory=list)

    def add(self, u: Array, y: Array, sweeps: list[SignedSweep]) -> None:
        row = sum(part.size for part in self.y) + np.arange(u.size, dtype=np.float64)
        one = np.ones(u.size)
        self.terms += [np.stack([row, 0.5 * one, at * one, at * one]) for at in self.saturations]
        for sign, alpha, beta in sweeps:
            a, b = (np.broadcast_to(np.asarray(value, dtype=float), u.shape) for value in (alpha, beta))
            if sign == 0:
                continue
            corners = [(sign, a, a), (-sign, a, b)]
            if np.ndim(alpha):  # the present input comes last, where the partition expects it
                corners.reverse()
            self.terms += [np.stack([row, s * one, p, q]) for s, p, q in corners]
        self.y.append(y)

    def observations(self, zero: int, ends: tuple[float, float], unit: str) -> Observations:
        y, table = np.concatenate(self.y), np.concatenate(self.terms, axis=1)
        same = np.zeros(y.size, dtype=np.int64)
        term = table[0].astype(np.int64)
        return Observations(y, same, same + zero, term, table[1], table[2], table[3], (), *ends, unit)
