"""The central ridge of a FORC diagram, told apart from its background by its width along the centre axis.

Particles that do not interact switch at ±H_c: their density is a line H_u = const, a ridge as narrow as the regression
resolves (Egli et al. 2010). Interacting or multi-domain particles spread over H_u. The density is averaged along the
ridge. A parabola (the background) and a Gaussian of unknown width, as the regression shows it, are fitted to it.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d
from scipy.optimize import least_squares

from smarig.core import Array, DataError, root_mean_square
from smarig.identification.fod_data import FodData
from smarig.identification.forc.forc_density import forc_density
from smarig.identification.forc.forc_diagram import SIGNIFICANT, ForcDiagram, ForcPeak

_NEAREST = 49  # points of a neighbourhood (SF = 3): a wider one would widen the ridge
_FEWEST_CURVES = 30
_REACH = 12  # grid steps on both sides of the ridge
_PER_STEP = 2  # places per grid step
_FIRST = 4  # grid steps from the diagonal, where the density is one-sided
_LONGEST_RATIO = 2.0  # of the resolution: a wider ridge is spread by interactions
_LEAST_ELONGATION = 3.0  # length over width
_FWHM = 2.3548  # of a Gaussian, in standard deviations
_TRIALS = 8  # sets of noise for the standard error of the height


@dataclass(frozen=True, eq=False)
class CentralRidge:
    """The mean density across the ridge, and the fit. Inputs in the units of the data.

    ``offset`` (k,): centre − that of the peak; ``mean`` (k,): μ averaged over half widths ``between``; ``background``
    and ``fitted`` (k,): the fit. ``fwhm``: the ridge's own width, without the regression's ``resolution``. ``height`` ±
    ``height_se``: of the ridge above the background; ``share`` of the ridge in the density within the offsets.
    """

    offset: Array = field(repr=False)
    mean: Array = field(repr=False)
    background: Array = field(repr=False)
    fitted: Array = field(repr=False)
    between: tuple[float, float]
    centre: float
    fwhm: float
    resolution: float
    height: float
    height_se: float
    share: float

    @property
    def present(self) -> bool:
        """Whether there is a ridge: significant, hardly wider than the resolution, and elongated."""
        width = max(self.fwhm, self.resolution)
        return (
            self.height > 5 * self.height_se
            and self.fwhm <= _LONGEST_RATIO * self.resolution
            and self.between[1] - self.between[0] >= _LEAST_ELONGATION * width
        )


def central_ridge(data: FodData, diagram: ForcDiagram) -> CentralRidge | None:
    """The ridge through the peak of a diagram; None with fewer than 30 curves or without a peak to look at."""
    peak = diagram.peak
    if peak is None or data.curves < _FEWEST_CURVES or len(data) < 4 * _NEAREST:
        return None
    step = float(np.median(np.diff(np.unique(data.alpha))))
    between = _extent(diagram, peak, step)
    if between is None:
        return None
    offset = np.arange(-_REACH * _PER_STEP, _REACH * _PER_STEP + 1) * step / _PER_STEP
    places = _Places.of(data, np.arange(*between, step), peak.centre + offset)
    mean = places.averaged(data.y)
    answer = places.averaged(_line_of_relays(data, peak.centre))
    known = np.isfinite(mean) & np.isfinite(answer)
    if known.sum() < _REACH * _PER_STEP:
        return None
    return _fitted(
        offset[known], mean[known], answer[known], between, peak, places, diagram.estimate.noise, step
    )


def _extent(diagram: ForcDiagram, peak: ForcPeak, step: float) -> tuple[float, float] | None:
    """Half widths between which the density at the centre of the peak is significant without a gap."""
    i = int(np.argmin(np.abs(diagram.centre - peak.centre)))
    j = int(np.argmin(np.abs(diagram.half_width - peak.half_width)))
    shown = (diagram.significance[i] > SIGNIFICANT) & (diagram.mu[i] > 0)
    low = high = j
    while low > 0 and shown[low - 1]:
        low -= 1
    while high + 1 < shown.size and shown[high + 1]:
        high += 1
    ends = max(float(diagram.half_width[low]), _FIRST * step), float(diagram.half_width[high])
    return ends if ends[1] - ends[0] >= 4 * step else None


@dataclass(frozen=True, eq=False)
class _Places:
    """Places of the profile: (α, β) of those inside the data, in the frame of the data, and their rows."""

    data: FodData
    alpha: Array
    beta: Array
    inside: NDArray[np.bool_]

    @classmethod
    def of(cls, data: FodData, half_width: Array, centre: Array) -> "_Places":
        h, c = np.meshgrid(half_width, centre)
        alpha, beta = (h - c, -c - h) if data.mirrored else (c + h, c - h)
        inside = (alpha <= data.alpha.max()) & (beta >= data.beta.min())
        return cls(data, alpha, beta, inside)

    def averaged(self, y: Array) -> Array:
        """The mean density (k,) over the half widths of each centre, for outputs ``y`` (n,) of the points."""
        found = np.full(self.alpha.shape, np.nan)
        at = self.alpha[self.inside], self.beta[self.inside]
        found[self.inside] = forc_density(
            self.data.alpha, self.data.beta, y, nearest=_NEAREST, degree=2, at=at
        ).mu
        known = np.isfinite(found)
        counts = known.sum(axis=1)
        sums = np.where(known, found, 0.0).sum(axis=1)
        return np.where(counts * 2 >= known.shape[1], sums / np.maximum(counts, 1), np.nan)


def _line_of_relays(data: FodData, centre: float) -> Array:
    """Outputs (n,) of relays with one centre and all half widths, at the points of the data.

    Relays with half width up to min(α − c, c − β) have switched back: y = −2 of them, up to terms of α alone.
    """
    c = -centre if data.mirrored else centre
    return -2 * np.clip(np.minimum(data.alpha - c, c - data.beta), 0, None)


def _fitted(
    offset: Array,
    mean: Array,
    answer: Array,
    between: tuple[float, float],
    peak: ForcPeak,
    places: _Places,
    noise: float,
    step: float,
) -> CentralRidge:
    x, size, top = offset / step, float(np.max(np.abs(mean))), float(np.max(answer))
    if not size > 0 or not top > 0:
        raise DataError("The density across the ridge is zero, so no ridge can be fitted.")
    response = answer / top

    def ridge(sigma: float, shift: float) -> Array:
        spread = gaussian_filter1d(response, max(abs(sigma), 1e-3) * _PER_STEP, mode="nearest")
        return np.interp(x - shift, x, spread / spread.max())

    def columns(sigma: float, shift: float) -> Array:
        return np.column_stack([np.ones_like(x), x, x**2, ridge(sigma, shift)])

    def misfit(p: Array) -> Array:
        basis = columns(*p)
        return basis @ np.linalg.lstsq(basis, mean / size, rcond=None)[0] - mean / size

    bounds = ([0.0, -_REACH / 2], [_REACH / 2, _REACH / 2])
    tried = [least_squares(misfit, [start, 0.0], bounds=bounds) for start in (0.2, 1.0, 3.0)]
    sigma, shift = min(tried, key=lambda found: found.cost).x
    basis = columns(sigma, shift)
    weights = np.linalg.lstsq(basis, mean, rcond=None)[0]
    background, fitted = basis[:, :3] @ weights[:3], basis @ weights
    total = float(np.trapezoid(np.abs(mean), x))
    return CentralRidge(
        offset=offset,
        mean=mean,
        background=background,
        fitted=fitted,
        between=between,
        centre=peak.centre + float(shift) * step,
        fwhm=_FWHM * float(sigma) * step,
        resolution=_full_width(offset, response),
        height=float(weights[3]),
        height_se=_height_error(places, basis, offset.size, noise),
        share=float(np.trapezoid(fitted - background, x)) / total if total else float("nan"),
    )


def _full_width(x: Array, y: Array) -> float:
    above = np.flatnonzero(y > 0.5 * y.max())
    return float(x[above[-1]] - x[above[0]] + (x[1] - x[0]))


def _height_error(places: _Places, basis: Array, size: int, noise: float) -> float:
    """Standard deviation of the fitted height for outputs of noise alone: the estimate is linear in the outputs."""
    rng = np.random.default_rng(0)
    heights = []
    for _ in range(_TRIALS):
        profile = places.averaged(rng.normal(0.0, noise, len(places.data)))
        known = np.isfinite(profile)
        if known.sum() == size:
            heights.append(np.linalg.lstsq(basis, profile[known], rcond=None)[0][3])
    return root_mean_square(heights) if heights else float("inf")
