"""The available storage S_a(B): the most energy that any input can extract from a state (Willems; thesis Def. 7.1).

    S_a(B) = sup over inputs from B of −∫ u dy

It is the smallest storage function. It is finite for every state exactly if the model is dissipative, it equals Q_r for
μ ≥ 0 and g ≥ 0, and S_a(B*) = 0 means passivity with zero bias (Thm 8.1). A closed loop costs A ≥ 0, so the best input
closes none: its excursions first grow, which wipes out B, and then shrink. On n levels this leaves n² situations, which
are solved backwards. The result is exact for relays, whose thresholds are the levels. Otherwise it is the best among
inputs that turn on the levels: a lower bound that rises with n.
"""

import math
from dataclasses import dataclass
from functools import singledispatch
from numbers import Integral

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, UsageError
from smarig.preisach import Everett, Initial, RelayMeasure, State
from smarig.theory.energy.dissipation import initial_state
from smarig.theory.energy.moments import breaks, moments_on, rounding
from smarig.theory.energy.sweep_work import MovingBoundary, work_of_segments

_MAX_LEVELS = 2000  # n² situations of some hundred bytes each


@dataclass(frozen=True)
class AvailableStorage:
    """``value`` in output times input units; inf if some loop on the levels returns energy.

    It is ``exact`` for relay measures. Otherwise it is a lower bound over the inputs that turn on ``levels`` levels.
    """

    value: float
    levels: int
    exact: bool


def available_storage(
    hysteresis: Everett, initial: Initial = "negative", levels: int = 129
) -> AvailableStorage:
    """S_a of a state, by dynamic programming over the inputs that close no loop.

    ``levels`` is the number of evenly spaced levels, 2 … 2000 (else UsageError). Relays use their thresholds.

    >>> from smarig.preisach import thesis_surface
    >>> available_storage(thesis_surface("one_e"), "negative").value      # passive with zero bias
    0.0
    """
    if not (isinstance(levels, Integral) and 2 <= levels <= _MAX_LEVELS):
        raise UsageError(
            f"The number of levels must be a whole number from 2 to {_MAX_LEVELS}, got {levels!r:.40}."
        )
    state = initial_state(hysteresis, initial)
    inner, exact = _inner_levels(hysteresis, levels)
    grid = _levels(hysteresis, state, inner)
    rising, falling = moments_on(hysteresis, grid)
    if (rising - falling).min() < -rounding(hysteresis):
        return AvailableStorage(math.inf, grid.size, exact)
    shrinking = _best_shrinking(rising, falling)
    value = _best_growing(_BoundaryLevels.of(hysteresis, state, grid), rising, falling, shrinking)
    return AvailableStorage(value, grid.size, exact)


@singledispatch
def _inner_levels(hysteresis: Everett, count: int) -> tuple[Array, bool]:
    """Levels at which inputs turn, and whether no input does better between them, as for thresholds of relays."""
    even = np.linspace(hysteresis.lower, hysteresis.upper, count)
    return np.concatenate([breaks(hysteresis), even]), False


@_inner_levels.register
def _thresholds(hysteresis: RelayMeasure, count: int) -> tuple[Array, bool]:
    del count
    return breaks(hysteresis), True


def _levels(hysteresis: Everett, state: State, inner: Array) -> Array:
    """Levels that include every corner of the boundary, in pairs about the centre of a diagonal state."""
    levels = np.concatenate([inner, state.extrema, [state.u, 0.0]])
    if state.diagonal:
        levels = np.concatenate([levels, 2 * state.extrema[0] - levels])
    levels = np.unique(levels[(levels >= hysteresis.lower) & (levels <= hysteresis.upper)])
    apart = np.diff(levels, prepend=-np.inf) > 1e-12 * (hysteresis.upper - hysteresis.lower)
    return levels[apart | np.isin(levels, [*state.extrema, state.u])]


def _best_shrinking(rising: Array, falling: Array) -> tuple[Array, Array]:
    """Most energy from inputs that stay inside the last turn: at a maximum i above floor j, and at a minimum j
    below ceiling i. Shape (n, n) each."""
    at_maximum, at_minimum = np.zeros_like(rising), np.zeros_like(rising)
    for i in range(1, len(rising)):
        turn = at_maximum[i - 1] - rising[i - 1]
        turn[i - 1 :] = 0.0
        at_minimum[i] = np.maximum(at_minimum[i - 1], turn)
        fall = falling[i] + at_minimum[i]
        fall[i:] = 0.0
        at_maximum[i] = np.maximum(np.maximum.accumulate(fall[::-1])[::-1], 0.0)
    return at_maximum, at_minimum


@dataclass(frozen=True)
class _BoundaryLevels:
    """The boundary of the initial state, level by level. ``rise[k]`` is the work of its strip between levels
    ``at`` + k and the next, and ``left[k]`` the level where that strip ends. ``fall[j]`` is the energy that the strip
    between levels j and j + 1 returns, and ``top[j]`` the level where it ends. ``at`` is the level of the input."""

    at: int
    rise: Array
    left: NDArray[np.intp]
    fall: Array
    top: NDArray[np.intp]

    @classmethod
    def of(cls, hysteresis: Everett, state: State, levels: Array) -> "_BoundaryLevels":
        """Boundary of a state, found by leaving it upwards and downwards, level by level."""
        at = int(np.searchsorted(levels, state.u))
        rise, left = _strips(hysteresis, state, levels[at:])
        fall, top = _strips(hysteresis, state, levels[at::-1])
        boundary = (
            np.append(left, np.inf),
            np.append(top[::-1], np.inf),
        )  # the last level has no strip
        near = 1e-9 * float(np.ptp(levels))
        left, top = (np.searchsorted(levels, np.clip(e, levels[0], levels[-1]) - near) for e in boundary)
        return cls(at, rise, left, -fall[::-1], top)


def _strips(hysteresis: Everett, state: State, stops: Array) -> tuple[Array, Array]:
    """Work of each strip of a monotone move from stop to stop, and the far end of each strip."""
    memory = MovingBoundary(state, hysteresis.lower, hysteresis.upper)
    segments = [segment for stop in stops[1:].tolist() for segment in memory.move(stop)]
    ends = [2 * p.base - p.stop if p.diagonal else p.base for p in segments]
    return work_of_segments(hysteresis, segments), np.array(ends)


def _best_growing(
    boundary: _BoundaryLevels, rising: Array, falling: Array, shrinking: tuple[Array, Array]
) -> float:
    """Most energy from the state, over windows [j, i] of levels visited so far, widest first."""
    n, at = len(rising), boundary.at
    at_maximum, at_minimum = shrinking
    high, low = (
        np.full((n + 1, n + 1), -np.inf),
        np.full((n + 1, n + 1), -np.inf),
    )  # [i, j + 1]; the border lies outside
    for i in range(n - 1, at - 1, -1):
        for j in range(at + 1):
            down = up = -math.inf
            if i + 1 < n:
                strip = (
                    rising[i + 1, j] - rising[i, j] if j <= boundary.left[i - at] else boundary.rise[i - at]
                )
                up = high[i + 1, j + 1] - strip
            if j > 0:
                strip = (
                    falling[i, j - 1] - falling[i, j] if i >= boundary.top[j - 1] else boundary.fall[j - 1]
                )
                down = low[i, j] + strip
            high[i, j + 1] = max(at_maximum[i, j], up, falling[i, j] + down)
            low[i, j + 1] = max(at_minimum[i, j], down, up - rising[i, j])
    return float(high[at, at + 1])
