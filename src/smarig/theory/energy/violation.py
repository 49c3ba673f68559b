"""Confirms with the forward model that a loop returns energy, until it has repaid its own approach.

The loop area is computed from F. This module runs the operator itself: from the initial state to the loop, then m ↔ M
repeatedly. It sums ∫ u dy from the outputs until the total is negative. The model has then returned more energy than it
received. It does not use the exact sweeps of ``sweep_work``.
"""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from smarig.core import NOT_NUMBERS, Array, UsageError
from smarig.preisach import Everett, Initial, Preisach
from smarig.theory.energy.moments import breaks

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_MAX_CYCLES = 200_000
_CYCLES_PER_CALL = 1000


@dataclass(frozen=True, eq=False)
class Violation:
    """The result of the forward model; energies ∫ u dy in output times input units.

    ``approach`` is the work along the points ``turning_points`` (from the initial state over m to M), ``per_cycle``
    that of the last of ``cycles`` cycles M → m → M, and ``balance`` the sum over the whole input.
    """

    turning_points: Array
    cycles: int
    approach: float
    per_cycle: float
    balance: float

    @property
    def confirmed(self) -> bool:
        """Whether the model returned more energy than it received."""
        return self.balance < 0

    def inputs(self) -> Array:
        """The turning points of the whole input, shape (3 + 2·cycles,)."""
        _, low, high = self.turning_points
        return np.concatenate([self.turning_points, np.tile([low, high], self.cycles)])


def confirm(hysteresis: Everett, loop: tuple[float, float], initial: Initial = "negative") -> Violation:
    """Drive a loop (M, m) of negative area from an initial state until the energy balance is negative.

    UsageError if the loop has no negative area in the forward model, or if it would need more than 200 000
    cycles.

    >>> from smarig.preisach import thesis_surface
    >>> confirm(thesis_surface("two_p"), (185.0, 84.0)).confirmed
    True
    """
    try:
        high, low = map(float, loop)
    except NOT_NUMBERS:
        raise UsageError(f"A loop is two numbers (M, m), got {loop!r:.40}.") from None
    if not low < high:
        raise UsageError(f"A loop (M, m) needs M > m, got M = {high} and m = {low}.")
    operator = Preisach(hysteresis, initial)
    cuts = breaks(hysteresis)
    start = operator.u
    approach = _SampledPath([start, low, high], cuts).drive(operator)[0]
    cycle = _SampledPath([high, low, high], cuts)
    first = float(cycle.drive(operator)[0])
    if not first < 0:
        raise UsageError(
            f"The loop {low:g} ↔ {high:g} takes up {first:.3g} in each cycle, so it returns no energy."
        )
    if approach > -first * _MAX_CYCLES:
        raise UsageError(
            f"The loop {low:g} ↔ {high:g} returns {-first:.3g} in each cycle. To repay its approach ({approach:.3g}), "
            f"it would need more than {_MAX_CYCLES} cycles."
        )
    works = [float(approach), first]
    while (balance_so_far := math.fsum(works)) >= 0:
        many = min(_CYCLES_PER_CALL, math.floor(balance_so_far / -first) + 1)
        works.extend(cycle.drive(operator, many).tolist())
    return Violation(np.array([start, low, high]), len(works) - 1, works[0], works[-1], math.fsum(works))


class _SampledPath:
    """Monotone branches between turning points, sampled so that ∫ u dy = [u y] − ∫ y du follows from y alone."""

    def __init__(self, turns: list[float], cuts: Array) -> None:
        branches = [_nodes(a, b, cuts) for a, b in pairwise(turns) if a != b]
        self.inputs = np.concatenate([nodes for nodes, _ in branches])
        self.weights = np.concatenate([weights for _, weights in branches])
        self.turns = turns[0], turns[-1]

    def drive(self, operator: Preisach, times: int = 1) -> Array:
        """∫ u dy of each passage, shape (times,). The operator's state advances."""
        before = operator.y
        outputs = operator.simulate(np.tile(self.inputs, times), operator.state).reshape(times, -1)
        ends = outputs[:, -1]
        starts = np.concatenate([[before], ends[:-1]])
        return self.turns[1] * ends - self.turns[0] * starts - outputs @ self.weights


def _nodes(start: float, stop: float, cuts: Array) -> tuple[Array, Array]:
    """Gauss nodes of ∫ y du on one branch, with its end (weight zero). Panels end where y(u) is not smooth."""
    inner = cuts[(cuts > min(start, stop)) & (cuts < max(start, stop))]
    edges = np.concatenate([[start], inner if start < stop else inner[::-1], [stop]])
    half = np.diff(edges)[:, None] / 2
    nodes = edges[:-1, None] + half * (_NODES + 1)
    return np.append(nodes, stop), np.append(half * _WEIGHTS, 0.0)
