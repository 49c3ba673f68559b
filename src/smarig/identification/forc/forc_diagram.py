"""The FORC diagram of a run: the density on a grid of half width and centre, its peak, widths and significance.

With the relay (α, β) of a pair of switching inputs α ≥ β, the half width is (α − β)/2 (in magnetism the coercive field
H_c) and the centre (α + β)/2 (the interaction field H_u): Pike, Roberts & Verosub 1999. The density and its standard
error are those of ``forc_density``.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from smarig.core import Array, DataError, UsageError
from smarig.identification.fod_data import FodData
from smarig.identification.forc.forc_density import DensityEstimate, fod_density
from smarig.identification.forc.forc_density_smoothing import SmoothingChoice, smoothing_factor

SIGNIFICANT = 1.96  # standard errors: 95 %, at a single place
_PLACES = 25_000  # number of grid places, roughly
_REACH = 1.5  # grid steps of the data from the nearest point: further away, the density would be extrapolated
_MAX_FACTOR = 100.0


@dataclass(frozen=True)
class ForcPeak:
    """The largest significant density: place, value ± standard error, and full widths at half maximum through it.

    A width is NaN if the density does not fall to half within the diagram, on one side of it.
    """

    half_width: float
    centre: float
    mu: float
    se: float
    fwhm_half_width: float
    fwhm_centre: float


@dataclass(frozen=True, eq=False)
class ForcDiagram:
    """μ (m, n) with its standard error over ``centre`` (m,) and ``half_width`` (n,), in the units of the input.

    NaN where no point is near. ``estimate`` holds window, degree and noise; ``curves`` and ``points`` count the data.
    """

    half_width: Array = field(repr=False)
    centre: Array = field(repr=False)
    mu: Array = field(repr=False)
    se: Array = field(repr=False)
    estimate: DensityEstimate = field(repr=False)
    curves: int
    points: int

    @property
    def significance(self) -> Array:
        """|μ| in standard errors (m, n)."""
        return np.abs(self.mu) / self.se

    @property
    def significant_share(self) -> float:
        """Share of the area where μ differs from zero at 95 % (of a density that is zero, 0.05 is expected)."""
        known = np.isfinite(self.significance)
        return float(np.mean(self.significance[known] > SIGNIFICANT)) if known.any() else 0.0

    @property
    def smoothing_factor(self) -> float:
        """The smoothing factor SF in grid steps, of the square with as many points as the neighbourhood."""
        assert self.estimate.nearest is not None  # noqa: S101 - set by ``forc_diagram``
        return smoothing_factor(self.estimate.nearest)

    @property
    def tried(self) -> tuple[SmoothingChoice, ...]:
        """The neighbourhoods that were compared, by degree and width; empty if the smoothing was given."""
        possible = [choice for choice in self.estimate.tried if np.isfinite(choice.error)]
        return tuple(sorted(possible, key=lambda choice: (choice.degree, choice.nearest)))

    @property
    def peak(self) -> ForcPeak | None:
        """The largest density at more than one grid step from the diagonal; None if nothing is significant."""
        step = min(self.estimate.steps)
        shown = (self.significance > SIGNIFICANT) & (self.half_width >= step)
        if not shown.any():
            return None
        i, j = divmod(int(np.argmax(np.where(shown, self.mu, -np.inf))), self.half_width.size)
        if self.mu[i, j] <= 0:
            return None
        return ForcPeak(
            half_width=float(self.half_width[j]),
            centre=float(self.centre[i]),
            mu=float(self.mu[i, j]),
            se=float(self.se[i, j]),
            fwhm_half_width=_width_at_half(self.half_width, self.mu[i], j),
            fwhm_centre=_width_at_half(self.centre, self.mu[:, j], i),
        )


def forc_diagram(data: FodData, *, factor: float | None = None) -> ForcDiagram:
    """The diagram of first-order data; the smoothing ``factor`` SF, in grid steps, is chosen if it is None.

    A given factor fits a quadratic to the nearest (2 SF + 1)² points. Raises UsageError for a factor that is not a
    positive number, DataError for data that determine no density.
    """
    options = {} if factor is None else {"nearest": _nearest(factor, len(data)), "degree": 2}
    alpha, beta = (-data.beta, -data.alpha) if data.mirrored else (data.alpha, data.beta)
    half_width, centre = _grid(alpha, beta)
    h, c = np.meshgrid(half_width, centre)
    inside = _near(h, c, data)
    if not inside.any():
        raise DataError("The points lie too far apart for a density between them. Measure more curves.")
    estimate = fod_density(data, at=((c + h)[inside], (c - h)[inside]), **options)
    mu, se = np.full(h.shape, np.nan), np.full(h.shape, np.nan)
    mu[inside], se[inside] = estimate.mu, estimate.se
    return ForcDiagram(half_width, centre, mu, se, estimate, data.curves, len(data))


def check_factor(factor: float | None) -> None:
    """Raise UsageError unless a smoothing factor is possible for some data; None is."""
    if factor is not None and not 1 <= factor <= _MAX_FACTOR:
        raise UsageError(
            f"The smoothing factor must lie between 1 and {_MAX_FACTOR:.0f} grid steps, got {factor:g}."
        )


def _nearest(factor: float, points: int) -> int:
    check_factor(factor)
    nearest = max(12, round((2 * factor + 1) ** 2))
    if nearest > points:
        raise UsageError(f"Smoothing factor {factor:g} needs {nearest} points, but there are {points}.")
    return nearest


def _grid(alpha: Array, beta: Array) -> tuple[Array, Array]:
    """Half widths (n,) from zero and centres (m,), of one step, over the range of the points."""
    half_width, centre = (alpha - beta) / 2, (alpha + beta) / 2
    width, height = float(half_width.max()), float(np.ptp(centre))
    if not width > 0 or not height > 0:
        raise DataError("The points lie on one line, so they determine no density. Measure several curves.")
    step = np.sqrt(width * height / _PLACES)
    return np.arange(0.0, width + step, step), np.arange(centre.min(), centre.max() + step, step)


def _near(h: Array, c: Array, data: FodData) -> NDArray[np.bool_]:
    """Mask (m, n) of places inside the triangle with a point within ``_REACH`` usual gaps along both axes."""
    alpha, beta = (h - c, -c - h) if data.mirrored else (c + h, c - h)
    inside = (beta >= data.beta.min()) & (alpha <= data.alpha.max()) & (beta <= alpha)
    gaps = _usual_gaps(data)
    distance, _ = KDTree(np.column_stack([data.alpha, data.beta]) / gaps).query(
        np.column_stack([alpha.ravel(), beta.ravel()]) / gaps, p=np.inf, distance_upper_bound=_REACH
    )
    return inside & np.isfinite(distance).reshape(h.shape)


def _usual_gaps(data: FodData) -> Array:
    """Distances (2,) between curves, and of neighbours along curves, that nine tenths do not exceed."""
    between = np.diff(np.unique(data.alpha))
    order = np.lexsort((data.beta, data.alpha))
    along = np.diff(data.beta[order])[np.diff(data.alpha[order]) == 0]
    gaps = [float(np.quantile(x[x > 0], 0.9)) if (x > 0).any() else np.inf for x in (between, along)]
    if not np.all(np.isfinite(gaps)):
        raise DataError("The points lie on one line, so they determine no density. Measure several curves.")
    return np.array(gaps)


def _width_at_half(x: Array, y: Array, k: int) -> float:
    """Full width at half maximum of y (n,) around index k, linear between places; NaN if a side is missing."""
    half = y[k] / 2
    ends = []
    for way in (-1, 1):
        i = k
        while 0 <= i + way < y.size and y[i + way] > half:
            i += way
        if not 0 <= i + way < y.size or not np.isfinite(y[i + way]):
            return float("nan")
        share = (y[i] - half) / (y[i] - y[i + way])
        ends.append(x[i] + share * (x[i + way] - x[i]))
    return float(ends[1] - ends[0])
