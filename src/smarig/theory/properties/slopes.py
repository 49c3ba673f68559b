"""The steepest branch of a hysteresis: λ with |Δy| ≤ λ |Δu| for every monotone input change, from every state.

    λ = max over β ≤ α of { ∂F/∂α (α, β),  ∂y/∂β (α, β) }

Every sweep is a sum of such strips. If they are not negative either (Assumption 2.1, ``monotone``), the output change
of a move is σ Δu with 0 ≤ σ ≤ λ. For ν ≥ 0 the steepest strips are those of the major loop, and λ = sup K(ξ)/ξ (§4.1).
λ is never larger than C of Lemma 4.2, and usually much smaller.
"""

import math
from functools import singledispatch

import numpy as np

from smarig.preisach import Everett, FodSurface, Mirrored
from smarig.theory.properties import enclosure
from smarig.theory.properties.branch_and_bound import Extreme, least, least_of
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
