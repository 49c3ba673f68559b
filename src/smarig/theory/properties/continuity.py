"""Continuity of the operator: the constant C of Lemma 4.2, and the modulus of continuity on C⁰.

In r = (α − β)/2, s = (α + β)/2 the boundary is s = p_r(t), the play of half-width r. It is 1-Lipschitz in r (BP3) and
in the input: |p_r[u] − p_r[v]| ≤ sup|u − v| from one state. Relays that differ therefore lie in a band between such a
boundary and the same boundary moved by ξ along the diagonal, and

    ω(ξ) = sup |Γu − Γv| over sup|u − v| ≤ ξ   ≤   max over boundaries of |ν|(band)   ≤   C ξ,
    C = 2M(u₊ − u₋) + G,     M ≥ |μ|,  G ≥ |g|                  (Lemma 4.2, with g: theory.md §8.8)

since dα dβ = 2 dr ds. The first bound is attained for ν ≥ 0: u = v + ξ after a visit to saturation. As printed,
Lemma 4.2 bounds K by the same C without G. Inputs beyond saturation are clipped.
"""

import math
from functools import singledispatch

import numpy as np

from smarig.core import Array
from smarig.preisach import Everett, FodSurface, Interval, unmirrored
from smarig.theory.properties import enclosure
from smarig.theory.properties.classes import MeasureClasses, classes
from smarig.theory.properties.sweep_changes import ChangeBounds, largest_change
from smarig.theory.properties.triangle_grid import TriangleGrid, masses
from smarig.theory.properties.variation import variation_masses

_LATTICE_LINES = 192
_INTERVALS = 4096
_OFF_THRESHOLDS = (math.sqrt(5) - 1) / 2


def lipschitz(hysteresis: Everett) -> float:
    """C with K(ξ) ≤ ω(ξ) ≤ C ξ: |Δy| ≤ C |Δu|, and |Γu − Γv| ≤ C sup|u − v|. Infinite for relays.

    It is proved for surfaces and tables. It is NaN for anything else, because only samples are known.

    >>> from smarig.preisach import thesis_surface
    >>> round(lipschitz(thesis_surface("two_c")), 3)                                # degrees per kelvin
    0.769
    """
    h = unmirrored(hysteresis)
    plane = TriangleGrid.of(h)
    if plane.kind == "relays":
        return math.inf
    c = classes(h)
    M = max(abs(c.mu_min.bound), abs(c.mu_max.bound))
    return 2 * M * plane.span + _largest_g(h, c)


def modulus(hysteresis: Everett, xi: float, levels: int = _LATTICE_LINES) -> ChangeBounds:
    """ω(ξ), the largest difference of two outputs from one state whose inputs differ by at most ξ.

    ``attained``: two inputs ξ apart reach it; found on a lattice of about ``levels`` lines that ξ divides. ``bound``:
    proved for surfaces, tables and relays, also for signed ν (then it need not be attained). If ξ is k lines, a band of
    width ξ touches at most k + 1 cells of every diagonal, so both values converge with 1/k where ν ≥ 0.
    """
    plane = TriangleGrid.of(hysteresis)
    moved = largest_change(hysteresis, xi).attained  # u = v, then only one of them moves
    if xi == 0.0:
        return ChangeBounds(0.0, 0.0)
    k = max(1, math.ceil(xi / plane.span * levels))
    lattice = plane.levels[0] + xi / k * np.arange(math.floor(plane.span / xi * k) + 3)
    cells = masses(hysteresis, lattice)
    attained = max(moved, _heaviest_band(cells, k), _heaviest_band(-cells, k))
    if plane.kind == "relays":
        lattice = lattice - _OFF_THRESHOLDS * xi / k  # the count of touched cells assumes relays inside them
    band = _heaviest_band(variation_masses(plane, lattice), k + 1)
    return ChangeBounds(attained, float(np.maximum(attained, band)))  # NaN stays NaN


def _heaviest_band(cells: Array, width: int) -> float:
    """Largest mass of ``width`` consecutive cells on every diagonal i − j = d, for neighbouring diagonals.

    A boundary leaves c(d) cells of diagonal d below it, and c(d + 1) is c(d) or c(d) − 1 (Prop. 3.4). c may exceed
    either end by ``width``; the band is then partly empty.
    """
    n = cells.shape[0]
    best = np.zeros(n + 2 * width + 1)
    for d in range(n - 1, -1, -1):
        upto = np.concatenate([[0.0], np.cumsum(np.diagonal(cells, -d))])
        c = np.arange(-width, n + width + 1)
        band = upto[np.clip(c + width, 0, n - d)] - upto[np.clip(c, 0, n - d)]
        best = band + np.maximum(best, np.concatenate([best[:1], best[:-1]]))
    return float(best.max())


@singledispatch
def _largest_g(hysteresis: Everett, c: MeasureClasses) -> float:
    """G ≥ |g|."""
    del hysteresis
    return max(abs(c.g_min.bound), abs(c.g_max.bound))


@_largest_g.register
def _largest_g_of_surface(hysteresis: FodSurface, c: MeasureClasses) -> float:
    del c
    u = np.linspace(hysteresis.lower, hysteresis.upper, _INTERVALS + 1)
    return float(enclosure.reversible(hysteresis, Interval(u[:-1], u[1:])).size.max())
