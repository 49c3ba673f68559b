"""The largest output change of a monotone input change, over all states: the quantity that K bounds.

A rise from λ to λ + ξ sweeps {λ < α ≤ λ + ξ, β ≥ b(α)}. The memory allows any b ≤ λ that does not increase with α
(Prop. 3.4), so

    largest rise = max over such b of ∫_λ^{λ+ξ} ∂_αF(α, b(α)) dα.

On a table the integrand is linear in b between the nodes and constant in α, so the best b runs along the nodes, and
dynamic programming is exact. For relays b matters only at thresholds. On a surface the staircases of a grid are
attained, and ``variation.uncertainty`` bounds the rest. Falls are rises of the mirror image.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from smarig.core import Array
from smarig.preisach import Everett
from smarig.theory.properties.strip_integrals import K, candidates
from smarig.theory.properties.triangle_grid import LEVELS, TriangleGrid
from smarig.theory.properties.variation import uncertainty


@dataclass(frozen=True)
class ChangeBounds:
    """``attained``: reached by some state and input, arbitrarily closely; ``bound``: never exceeded.

    Both are equal if the value is exact. ``bound`` is NaN if nothing is proved.
    """

    attained: float
    bound: float


def largest_change(hysteresis: Everett, xi: float, levels: int = LEVELS) -> ChangeBounds:
    """Largest |Δy| of a monotone input change of exactly ξ, from any state that an input can produce.

    ``levels``: cells per side for a surface; attained value and bound converge with 1/levels².

    >>> from smarig.preisach import RelayMeasure
    >>> pair = RelayMeasure.from_arrays([1.0, 1.0, 2.0], [0.0, 0.5, 0.0], [1.0, -1.0, 1e-9])
    >>> float(pair.everett(1.0, 0.0)), largest_change(pair, 1.0).attained      # the whole strip does not show it
    (0.0, 2.0)
    """
    plane = TriangleGrid.of(hysteresis, levels)
    on_levels = max(abs(x) for side in (plane, plane.mirrored()) for x in _rises(side, xi))
    return ChangeBounds(max(on_levels, K(hysteresis, xi)), on_levels + uncertainty(plane))


def largest_setback(hysteresis: Everett) -> float:
    """Largest output change against the direction of a monotone input change of any size; 0 if there is none.

    Exact for tables and relays. For others it is the largest on the grid, which is attained. Zero means
    Assumption 2.1: the output follows the input.
    """
    plane = TriangleGrid.of(hysteresis)
    return max(_setback(plane), _setback(plane.mirrored()))


def _rises(plane: TriangleGrid, xi: float) -> tuple[float, float]:
    """Largest and smallest output change of a rise by ξ, row by row of the lattice."""
    F, u = plane.hysteresis.swept, plane.levels
    lam = _with_turning_points(plane, candidates(plane, xi), xi)
    top = np.minimum(lam + xi, u[-1])
    b = np.minimum(u, lam[:, None])
    first, last = np.searchsorted(u, lam, side="right"), np.searchsorted(u, top, side="left")
    below, most, least = F(lam[:, None], b), np.zeros(b.shape), np.zeros(b.shape)
    for step in range(int((last - first).max(initial=0)) + 1):
        reached = first + step
        level = np.where(reached < last, u[np.minimum(reached, u.size - 1)], top)
        here = F(level[:, None], b)
        most = here - below + _best_further_right(np.maximum, most)
        least = here - below + _best_further_right(np.minimum, least)
        below = here
    return float(most.max()), float(least.min())


def _best_further_right(best: np.ufunc, values: Array) -> Array:
    """Best value over b′ ≥ b, because the row below may not extend further to the left."""
    return best.accumulate(values[:, ::-1], axis=1)[:, ::-1]


def _with_turning_points(plane: TriangleGrid, lam: Array, xi: float) -> Array:
    """Add the vertices of F(λ + ξ, λ), piecewise quadratic on a table; all other terms are convex between ``lam``."""
    if plane.kind == "relays" or lam.size < 2:
        return lam
    low, high = lam[:-1], lam[1:]
    a, m, z = (
        plane.hysteresis.swept(np.minimum(x + xi, plane.levels[-1]), x) for x in (low, (low + high) / 2, high)
    )
    bend = 2 * (a - 2 * m + z)
    with np.errstate(divide="ignore", invalid="ignore"):
        part = (3 * a - 4 * m + z) / (2 * bend)
    inside = (part > 0) & (part < 1)
    return np.unique(np.concatenate([lam, (low + part * (high - low))[inside]]))


def _setback(plane: TriangleGrid) -> float:
    """−(least output change of any rise), which may start and end on any level."""
    u = plane.levels
    if plane.kind == "relays":
        u = np.unique(np.concatenate([u, (u[1:] + u[:-1]) / 2]))
    F = plane.hysteresis.swept
    least, worst = np.zeros(u.size), 0.0
    for low, high in pairwise(u.tolist()):
        b = np.minimum(u, low)
        swept = np.where(u <= low, F(high, b) - F(low, b), np.inf)
        least = swept + np.minimum.accumulate(least[::-1])[::-1]
        worst = max(worst, -float(least.min()))
        least = np.where(np.isfinite(least), least, 0.0)  # the move may start at any level
    return worst
