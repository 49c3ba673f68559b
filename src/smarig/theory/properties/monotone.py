"""Assumption 2.1: does the output follow the input? Slopes of every branch, and crossings of first-order curves.

    ∂F/∂α (α, β) = g(α) + 2∫_β^α μ dβ′ ≥ 0: rising branches rise;   ∂y/∂β ≥ 0: falling branches fall

for all β ≤ α. Every sweep is a sum of such strips, so the output then follows the input from any state, and an inverse
exists. The condition is weaker than μ ≥ 0. The identification tests noisy measured curves.

The steepest branch of a hysteresis: λ with |Δy| ≤ λ |Δu| for every monotone input change, from every state.

    λ = max over β ≤ α of { ∂F/∂α (α, β),  ∂y/∂β (α, β) }

Every sweep is a sum of such strips. If they are not negative either (Assumption 2.1, ``monotone``), the output change
of a move is σ Δu with 0 ≤ σ ≤ λ. For ν ≥ 0 the steepest strips are those of the major loop, and λ = sup K(ξ)/ξ (§4.1).
λ is never larger than C of Lemma 4.2, and usually much smaller.
"""

import math
from dataclasses import dataclass
from functools import singledispatch

import numpy as np

from smarig.core import Array
from smarig.preisach import Everett, FodSurface, Mirrored
from smarig.theory.properties import enclosure
from smarig.theory.properties.branch_and_bound import Extreme, least, least_of
from smarig.theory.properties.sweep_changes import largest_setback
from smarig.theory.properties.triangle_grid import TriangleGrid

_TOLERANCE = 1e-5  # relative, of the proved bound of a surface


@singledispatch
def largest_slope(hysteresis: Everett) -> Extreme:
    """λ (output per input) with its place (α, β) and a proved bound: exact for tables, infinite for relays.

    The bound is NaN for a hysteresis that is only sampled.

    >>> from smarig.preisach import thesis_surface
    >>> found = largest_slope(thesis_surface("one_c"))
    >>> round(found.value, 4), found.bound - found.value < 1e-5
    (0.354, True)
    """
    plane = TriangleGrid.of(hysteresis)
    if plane.kind == "relays":
        return Extreme(math.inf, (math.nan, math.nan), math.inf)
    rising, falling = _steepest_rise(plane), _steepest_rise(plane.mirrored()).mirrored_place()
    return max(rising, falling, key=lambda e: e.value)


@largest_slope.register
def _of_mirrored(hysteresis: Mirrored) -> Extreme:
    return largest_slope(hysteresis.image).mirrored_place()


@largest_slope.register
def _of_surface(hysteresis: FodSurface) -> Extreme:
    s = hysteresis
    rising, falling = (
        least(
            lambda a, b, slope=slope: -slope(a, b),
            lambda a, b, bounds=bounds: bounds(s, a, b).times(-1.0),
            s.lower,
            s.upper,
            _TOLERANCE,
        ).negated()
        for slope, bounds in ((s.strip_alpha, enclosure.rise), (s.strip_beta, enclosure.fall))
    )
    steeper = max(rising, falling, key=lambda e: e.value)
    return Extreme(steeper.value, steeper.at, max(rising.bound, falling.bound))


def _steepest_rise(plane: TriangleGrid) -> Extreme:
    """Largest (F(u_{i+1}, β) − F(u_i, β))/(u_{i+1} − u_i) over nodes β ≤ u_i; linear in β between the nodes."""
    u = plane.levels
    w = np.diff(u)
    F = plane.hysteresis.swept(u[:, None], np.minimum(u, u[:, None]))
    slopes = np.where(np.tri(w.size, dtype=bool), (F[1:] - F[:-1])[:, :-1] / w[:, None], np.nan)
    middle = (u[1:] + u[:-1]) / 2
    found = least_of(-slopes, *np.broadcast_arrays(middle[:, None], u[:-1])).negated()
    return Extreme(found.value, found.at, math.nan if plane.kind == "sampled" else found.value)


_ZERO = 1e-12


@dataclass(frozen=True)
class Monotonicity:
    """Least slopes (output per K) of rising branches ∂F/∂α and falling ones ∂y/∂β, with their places (α, β).

    For relays they are the least output changes between neighbouring thresholds instead. ``setback`` is the largest
    output change against the direction of a monotone input change; 0 if there is none.
    """

    rising: Extreme
    falling: Extreme
    setback: float

    @property
    def holds(self) -> bool:
        """Assumption 2.1 up to rounding. It is proved if the bounds of both slopes are non-negative."""
        return self.rising.value >= 0 and self.falling.value >= 0


@dataclass(frozen=True)
class Crossing:
    """Two first-order curves, turning at ``lower`` and ``higher``, in the wrong order at ``at``, by ``depth``.

    y(α₂, β) − y(α₁, β) = 2∬ μ over α₁ < α ≤ α₂, β′ < β, without g because β ≤ α₁. A negative value proves μ < 0 in that
    rectangle (Prop. 4.6, which includes the thesis's case of curves that merge again). The converse is not true: only
    rectangles that extend down to u₋ are visible.
    """

    lower: float
    higher: float
    at: float
    depth: float


@singledispatch
def monotone(hysteresis: Everett) -> Monotonicity:
    """The slopes of all branches and the largest setback of any hysteresis.

    >>> from smarig.preisach import thesis_surface
    >>> m = monotone(thesis_surface("two_p"))
    >>> m.holds, round(m.rising.value, 4), m.falling.bound >= 0
    (False, -0.0367, True)
    """
    plane = TriangleGrid.of(hysteresis)
    rising, falling = _least_rise(plane), _least_rise(plane.mirrored()).mirrored_place()
    return Monotonicity(rising, falling, largest_setback(hysteresis))


@monotone.register
def _mirrored_slopes(hysteresis: Mirrored) -> Monotonicity:
    m = monotone(hysteresis.image)
    return Monotonicity(m.falling.mirrored_place(), m.rising.mirrored_place(), m.setback)


@monotone.register
def _enclosed_slopes(hysteresis: FodSurface) -> Monotonicity:
    s = hysteresis
    rising = least(s.strip_alpha, lambda a, b: enclosure.rise(s, a, b), s.lower, s.upper)
    falling = least(s.strip_beta, lambda a, b: enclosure.fall(s, a, b), s.lower, s.upper)
    return Monotonicity(rising, falling, largest_setback(s))


def crossing_descending(hysteresis: Everett) -> Crossing | None:
    """The worst crossing of first-order descending curves inside the major loop; None if none is found.

    Exact for tables and relays. For others it uses a grid; a crossing that it finds is proved.
    """
    return _crossing(TriangleGrid.of(hysteresis))


def crossing_ascending(hysteresis: Everett) -> Crossing | None:
    """The worst crossing of first-order ascending curves (positive saturation → β → α); None if none is found.

    It is the mirror image of the descending case; ``lower`` > ``higher`` are the turning points β.
    """
    found = _crossing(TriangleGrid.of(hysteresis).mirrored())
    return found and Crossing(-found.lower, -found.higher, -found.at, found.depth)


def _least_rise(plane: TriangleGrid) -> Extreme:
    """Least (F(u_{i+1}, β) − F(u_i, β)) per K over nodes β ≤ u_i. For relays not per K, and also for β in between."""
    u = _between(plane)
    w = np.diff(u)
    F = plane.hysteresis.swept(u[:, None], np.minimum(u, u[:, None]))
    rows = np.where(np.tri(w.size, dtype=bool), (F[1:] - F[:-1])[:, :-1], np.nan)
    slopes = rows if plane.kind == "relays" else rows / w[:, None]
    alpha = u[1:] if plane.kind == "relays" else (u[1:] + u[:-1]) / 2
    found = least_of(slopes, *np.broadcast_arrays(alpha[:, None], u[:-1]))
    rounding = _ZERO * float(np.nanmax(np.abs(slopes)))
    value = 0.0 if -rounding <= found.value < 0 else found.value
    return Extreme(value, found.at, float("nan") if plane.kind == "sampled" else value)


def _crossing(plane: TriangleGrid) -> Crossing | None:
    u = _between(plane)
    F = plane.hysteresis.swept(u[:, None], np.minimum(u, u[:, None]))
    inside, curves = np.tri(u.size, dtype=bool), F[:, :1] - F  # row α, column β ≤ α
    y = np.where(inside, curves, -np.inf)
    depth = np.where(inside, np.maximum.accumulate(y, axis=0) - curves, 0.0)
    i, j = np.unravel_index(int(depth.argmax()), depth.shape)
    if depth[i, j] <= _ZERO * plane.height:
        return None
    owner = int(y[: i + 1, j].argmax())
    return Crossing(float(u[owner]), float(u[i]), float(u[j]), float(depth[i, j]))


def _between(plane: TriangleGrid) -> Array:
    """The levels; for relays also the points between them, where a state can end before a threshold."""
    u = plane.levels
    return np.unique(np.concatenate([u, (u[1:] + u[:-1]) / 2])) if plane.kind == "relays" else u
