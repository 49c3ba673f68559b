"""The classes of Def. 4.1: is μ bounded and piecewise continuous (M_PC), and is it non-negative (M_P)?

The extremes of μ and of the reversible g are given with their places. The minimum is where μ ≥ 0 or g ≥ 0 is violated
most. M_PC and M_P concern the density alone; the theorems that use them also need g ≥ 0 (theory.md §8, erratum 8). For
a table the results concern the interpolated hysteresis, not the wire.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import singledispatch

import numpy as np

from smarig.core import Array
from smarig.preisach import Everett, FodSurface, Interval, Mirrored, RelayMeasure
from smarig.theory.properties import enclosure
from smarig.theory.properties.branch_and_bound import Extreme, least, least_of
from smarig.theory.properties.triangle_grid import TriangleGrid, masses

_ZERO = 1e-9  # relative to the largest value; smaller values are rounding
_INTERVALS = 4096


@dataclass(frozen=True)
class MeasureClasses:
    """Extremes of μ (output per K², at (α, β)) and g (output per K, at (β, β)), and the resulting classes.

    For relays (``atoms``) the "densities" are the masses of single relays: α > β in ``mu``, α = β in ``g``. No class
    holds then, because a measure of points has no density. ``reversible_share`` is ∫g divided by y₊ − y₋ (NaN where
    that is zero).
    """

    mu_min: Extreme
    mu_max: Extreme
    g_min: Extreme
    g_max: Extreme
    reversible_share: float
    atoms: bool

    @property
    def M_PC(self) -> bool:
        """Whether μ is bounded and piecewise continuous."""
        return not self.atoms and all(
            np.isfinite(e.value) or np.isnan(e.value) for e in (self.mu_min, self.mu_max)
        )

    @property
    def M_P(self) -> bool:
        """Whether M_PC holds and μ ≥ 0 up to rounding; the proof is ``mu_min.bound``."""
        return self.M_PC and _positive(self.mu_min, self.mu_max)

    @property
    def positive(self) -> bool:
        """ν ≥ 0: neither μ nor g is negative anywhere. The theorems need this, also for relays."""
        return _positive(self.mu_min, self.mu_max) and _positive(self.g_min, self.g_max)


@singledispatch
def classes(hysteresis: Everett) -> MeasureClasses:
    """Extremes and classes of any hysteresis: exact for tables and relays, bounded for surfaces.

    >>> from smarig.preisach import thesis_surface
    >>> one_c, one_e = classes(thesis_surface("one_c")), classes(thesis_surface("one_e"))
    >>> one_c.M_P, one_e.M_P, round(one_e.mu_min.value, 5), one_c.mu_min.bound > 0
    (True, False, -0.00189, True)
    """
    return _of_cells(TriangleGrid.of(hysteresis))


def _positive(low: Extreme, high: Extreme) -> bool:
    """Whether there is no negative value. An empty set has none."""
    return not low.value < -_ZERO * max(abs(low.value), abs(high.value))


@classes.register
def _of_mirrored(h: Mirrored) -> MeasureClasses:
    return _each(Extreme.mirrored_place, classes(h.image))


@classes.register
def _of_surface(s: FodSurface) -> MeasureClasses:
    def negated_mu(alpha: Array, beta: Array) -> Array:
        return -s.density(alpha, beta)

    low = least(s.density, lambda a, b: enclosure.density(s, a, b), s.lower, s.upper)
    high = least(negated_mu, lambda a, b: enclosure.density(s, a, b).times(-1.0), s.lower, s.upper, 1e-4)
    u = np.linspace(s.lower, s.upper, _INTERVALS + 1)
    g, g_interval = s.reversible(u), enclosure.reversible(s, Interval(u[:-1], u[1:]))
    share = float(np.trapezoid(g, u)) / (s.y_upper - s.y_lower) if s.y_upper != s.y_lower else float("nan")
    lowest, highest = float(u[g.argmin()]), float(u[g.argmax()])
    return MeasureClasses(
        mu_min=low,
        mu_max=high.negated(),
        g_min=Extreme(float(g.min()), (lowest, lowest), float(g_interval.low.min())),
        g_max=Extreme(float(g.max()), (highest, highest), float(g_interval.high.max())),
        reversible_share=share,
        atoms=False,
    )


@classes.register
def _of_relays(h: RelayMeasure) -> MeasureClasses:
    place, at = np.unique(np.stack([h.alpha, h.beta]), axis=1, return_inverse=True)
    mass = np.bincount(at.ravel(), h.mass)
    mu, g = (np.where(here, mass, np.nan) for here in (place[0] > place[1], place[0] == place[1]))
    return _from_values(mu, g, place, np.nansum(g) / mass.sum() if mass.sum() else float("nan"), atoms=True)


def _of_cells(plane: TriangleGrid) -> MeasureClasses:
    """μ is constant over a cell, g constant along a diagonal one, as a ``FodTable`` interpolates between its nodes."""
    u, w = plane.levels, np.diff(plane.levels)
    nu = masses(plane.hysteresis, u)
    middle = (u[1:] + u[:-1]) / 2
    place = np.stack(np.broadcast_arrays(middle[:, None], middle))
    below = np.tri(w.size, k=-1, dtype=bool)
    mu = np.where(below, nu / (2 * w[:, None] * w), np.nan)
    g = np.where(np.eye(w.size, dtype=bool), nu / w, np.nan)
    total = float(nu.sum())
    found = _from_values(mu, g, place, float(np.trace(nu)) / total if total else float("nan"), atoms=False)
    return found if plane.kind == "table" else _each(_unproved, found)


def _from_values(mu: Array, g: Array, place: Array, share: float, *, atoms: bool) -> MeasureClasses:
    """Least and largest of a finite number of values at places (2, …)."""
    alpha, beta = place
    return MeasureClasses(
        mu_min=least_of(mu, alpha, beta),
        mu_max=least_of(-mu, alpha, beta).negated(),
        g_min=least_of(g, alpha, beta),
        g_max=least_of(-g, alpha, beta).negated(),
        reversible_share=float(share),
        atoms=atoms,
    )


def _each(change: Callable[[Extreme], Extreme], c: MeasureClasses) -> MeasureClasses:
    return replace(
        c,
        mu_min=change(c.mu_min),
        mu_max=change(c.mu_max),
        g_min=change(c.g_min),
        g_max=change(c.g_max),
    )


def _unproved(e: Extreme) -> Extreme:
    return replace(e, bound=float("nan"))
