"""The width of a local regression, chosen by cross-validation of whole curves.

The score is the mean square error of the prediction of measured points from the other curves only. So noise that
the points of a curve share (drift, the encoder's zero) is not taken for signal, as it would be by leaving out
single points or by generalised cross-validation (Chu & Marron 1991). Points that share no α are left out singly.
Neighbourhoods contain the k nearest points, so they widen towards the edges. Polynomials of degree 2 and 4 are
compared. ``benchmark.density`` measures the error against true densities.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.distance import cdist

from smarig.core import Array, DataError
from smarig.identification.forc.forc_density_local import WINDOWS, local_fits, neighbourhoods

DEGREES = (2, 4)
_PLACES = 1500  # largest number of places for the score, evenly spaced in the data
_ALLOWED_RISES = 2  # number of rises of the error that end the search for k
_REFINEMENT_FACTORS = (0.63, 0.79, 1.26, 1.59)  # between powers of two: widths 12 % apart
_SOUND = 0.9  # share of places at which a fit must be possible
_TINY = np.finfo(float).tiny
_WIDER = 1.0 + 1e-9  # the k-th nearest point keeps a small weight


@dataclass(frozen=True)
class SmoothingChoice:
    """A neighbourhood: ``nearest`` points, polynomial ``degree``, mean square ``error`` in output².

    The chosen one holds all that were ``tried``.
    """

    nearest: int
    degree: int
    error: float
    tried: "tuple[SmoothingChoice, ...]" = ()

    @property
    def factor(self) -> float:
        """The smoothing factor SF of the square of (2 SF + 1)² grid points with as many points (Pike et al. 1999)."""
        return smoothing_factor(self.nearest)


def smoothing_factor(nearest: int) -> float:
    """The smoothing factor SF, in grid steps, of a square with ``nearest`` points: (√nearest − 1)/2.

    >>> smoothing_factor(49)
    3.0
    """
    return (float(np.sqrt(nearest)) - 1) / 2


def nearest_widths(places: Array, points: Array, nearest: int) -> Array:
    """Distance (t,) from every place (t, 2) to its k-th nearest of the points (n, 2), k ≤ n, in grid steps."""
    widths = np.full(len(places), np.nan)
    reach = 1.2 * np.sqrt(nearest)  # sufficient with one point per square step, except in corners
    while (open_ := np.flatnonzero(np.isnan(widths))).size:
        for mine, theirs in neighbourhoods(places[open_], points, np.full(open_.size, reach)):
            if theirs.size >= nearest:
                distance = cdist(places[open_[mine]], points[theirs])
                distance.partition(nearest - 1, axis=1)
                kth = distance[:, nearest - 1]
                widths[open_[mine]] = np.where(kth <= reach, kth, np.nan)
        reach *= 2
    return np.maximum(widths, _TINY) * _WIDER


def choose_smoothing(points: Array, y: Array, degrees: tuple[int, ...] = DEGREES) -> SmoothingChoice:
    """The k and degree of least error for ``points`` (n, 2) in grid steps, ``y`` (n,); DataError if none is
    possible.
    """
    tried = [choice for degree in degrees for choice in _tried_smoothings(points, y, degree)]
    best = min(tried, key=lambda f: f.error)
    if best.error == np.inf:
        raise DataError(
            f"No smoothing of these {len(points)} points determines a density. Measure more curves, or more "
            "points on each."
        )
    return replace(best, tried=tuple(tried))


def _tried_smoothings(points: Array, y: Array, degree: int) -> list[SmoothingChoice]:
    """k doubled until the error has risen twice, then between the neighbours of the minimum."""
    stride = -(-len(points) // _PLACES)
    places, outputs = points[stride // 2 :: stride], y[stride // 2 :: stride]

    def scored(nearest: int) -> SmoothingChoice:
        widths = nearest_widths(places, points, nearest)
        curves = places[:, 0], points[:, 0]
        fits = local_fits(places, points, y, widths, WINDOWS["loess"], degree, without=curves)
        sound = ~fits.singular
        if sound.mean() < _SOUND:
            return SmoothingChoice(nearest, degree, np.inf)
        return SmoothingChoice(nearest, degree, float(np.mean((outputs - fits.value)[sound] ** 2)))

    def best_index(tried: list[SmoothingChoice]) -> int:
        return int(np.argmin([t.error for t in tried]))

    fewest = (degree + 1) * (degree + 2)
    tried = [scored(min(fewest, len(points)))]
    while 2 * tried[-1].nearest <= len(points) and len(tried) - best_index(tried) <= _ALLOWED_RISES:
        tried.append(scored(2 * tried[-1].nearest))
    centre = tried[best_index(tried)].nearest
    for factor in _REFINEMENT_FACTORS:
        if fewest <= (nearest := round(centre * factor)) <= len(points):
            tried.append(scored(nearest))
    return tried
