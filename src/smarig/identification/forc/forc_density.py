"""The density μ = ½ ∂²y/∂α∂β from first-order curves, by local regression, with standard errors.

Around every place a polynomial is fitted to the nearby points, weighted by distance (LOESS: Cleveland 1979,
Harrison & Feinberg 2008; or the VARIFORC window with a constant factor, Egli 2013). Its mixed derivative is the
density there. The density is not constrained, so it may be negative. It is not extrapolated: where the points do
not determine a fit, it is NaN, and these places are counted.
"""

from dataclasses import dataclass, field, replace
from numbers import Integral, Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from smarig.core import NOT_NUMBERS, Array, DataError, UsageError
from smarig.identification.fod_data import FodData
from smarig.identification.forc.forc_density_local import WINDOWS, LocalFits, local_fits
from smarig.identification.forc.forc_density_smoothing import (
    DEGREES,
    SmoothingChoice,
    choose_smoothing,
    nearest_widths,
)

_MAX_GAIN_RATIO = 30.0  # times the typical standard error: too few neighbours
_FEWEST = 12  # points: twice the terms of a quadratic
_NOISE_POINTS = 4000  # largest number of points for the noise, if the density is requested at other places


@dataclass(frozen=True, eq=False)
class DensityEstimate:
    """μ(α, β) at places (k,) with standard errors, in output per input²; NaN where it is not determined.

    ``se`` is the standard deviation of ``mu`` due to noise (exact for a linear estimator with independent noise of
    deviation ``noise``, in output units, estimated from the residuals). It does not include the bias of smoothing
    or noise shared by the points of a curve (drift). ``dof`` is the effective number of parameters of the fitted
    surface, ``points`` the number of data points. ``smoothing`` is the factor in units of ``steps`` (Δα, Δβ), None
    if neighbourhoods contain the ``nearest`` points instead. ``ill_conditioned`` counts the places with NaN. ``tried``
    holds the neighbourhoods that were compared if the smoothing was chosen.
    """

    alpha: Array = field(repr=False)
    beta: Array = field(repr=False)
    mu: Array = field(repr=False)
    se: Array = field(repr=False)
    noise: float
    dof: float
    points: int
    window: str
    degree: int
    smoothing: float | None
    nearest: int | None
    steps: tuple[float, float]
    ill_conditioned: int
    tried: tuple[SmoothingChoice, ...] = field(default=(), repr=False)


def forc_density(
    alpha: ArrayLike,
    beta: ArrayLike,
    y: ArrayLike,
    *,
    smoothing: float | None = None,
    nearest: int | None = None,
    degree: int | None = None,
    window: str = "loess",
    steps: tuple[float, float] | None = None,
    at: tuple[ArrayLike, ArrayLike] | None = None,
) -> DensityEstimate:
    """μ at the points themselves, or at the places ``at`` = (α, β), from scattered points (n,), β ≤ α.

    Without ``smoothing`` and ``nearest``, the number of neighbours and the ``degree`` (2 or 4) are those that
    predict whole curves best from the others (``forc_density_smoothing``). ``smoothing`` is a constant factor s in
    grid steps and ``nearest`` a number of neighbours; the degree is then 2 unless given. ``window`` is "loess"
    (tricube in the ellipse with half axes s·Δα, s·Δβ) or "variforc" (Egli's rounded box, half sides s in (α ∓
    β)/2). ``steps`` are the grid steps (Δα, Δβ), by default the medians in the data. Magnetic curves must be
    mirrored; ``fod_density`` takes them as measured.

    Raises UsageError for contradictory options, DataError for points that cannot be fitted and for places outside
    the triangle of the points.

    >>> grid = np.linspace(0.0, 1.0, 21)
    >>> a, b = (m[np.tri(21, dtype=bool)] for m in np.meshgrid(grid, grid, indexing="ij"))
    >>> density = forc_density(a, b, 3 * a * b + b**2, smoothing=4.0)
    >>> float(np.round(density.mu, 9).min()), float(np.round(density.mu, 9).max())
    (1.5, 1.5)
    """
    a, b, values = _points(alpha, beta, y)
    _check_options(smoothing, nearest, degree, window, values.size)
    where = (a, b) if at is None else _inside_triangle(_places(at), a, b)
    scale = _scale(grid_steps(a, b) if steps is None else steps)
    if WINDOWS[window].one_step:
        scale[:] = scale.mean()
    points, values = np.column_stack([a, b]) / scale, values - values.mean()
    tried: tuple[SmoothingChoice, ...] = ()
    if smoothing is None and nearest is None:
        chosen = choose_smoothing(points, values, (degree,) if degree else DEGREES)
        nearest, degree, tried = chosen.nearest, chosen.degree, chosen.tried
    degree = degree or 2

    def fits(places: Array) -> LocalFits:
        s = np.full(len(places), smoothing) if nearest is None else nearest_widths(places, points, nearest)
        return local_fits(places, points, values, s, WINDOWS[window], degree)

    stride = 1 if at is None else -(-values.size // _NOISE_POINTS)
    own = fits(points[::stride])
    noise, dof = _noise(values[::stride], own)
    requested = own if at is None else fits(np.column_stack(where) / scale)
    mu, se, missing = _determined(requested, own, noise, 0.5 / float(scale.prod()))
    return DensityEstimate(
        *where, mu, se, noise, dof * values.size, values.size, window, degree, smoothing, nearest,
        (float(scale[0]), float(scale[1])), missing, tried,
    )  # fmt: skip


def fod_density(
    data: FodData, *, at: tuple[ArrayLike, ArrayLike] | None = None, **options: Any
) -> DensityEstimate:
    """``forc_density`` of FOD data, with the measured α and β also if the data are mirrored.

    The mirror (u, y) → (−u, −y) maps (α, β) to (−β, −α) and does not change μ.
    """
    if not data.mirrored:
        return forc_density(data.alpha, data.beta, data.y, at=at, **options)
    inside = None
    if at is not None:
        own_alpha, own_beta = _places(at)
        inside = -own_beta, -own_alpha
    image = forc_density(data.alpha, data.beta, data.y, at=inside, **options)
    return replace(image, alpha=-image.beta, beta=-image.alpha, steps=image.steps[::-1])


def grid_steps(alpha: Array, beta: Array) -> tuple[float, float]:
    """Typical steps (Δα, Δβ): medians between neighbouring curves, and between neighbours along curves.

    Points that share no α form no curves; their steps then give each point of the triangle its own cell.
    """
    alphas = np.unique(alpha)
    order = np.lexsort((beta, alpha))
    along = np.diff(beta[order])[np.diff(alpha[order]) == 0]
    along = along[along > 0]
    if alphas.size < 2 or np.ptp(beta) == 0:
        raise DataError("The points lie on a single curve or at a single β. A density needs several of both.")
    if along.size < alpha.size / 2:
        per_side = float(np.sqrt(2 * alpha.size))
        return float(np.ptp(alpha)) / per_side, float(np.ptp(beta)) / per_side
    return float(np.median(np.diff(alphas))), float(np.median(along))


def _noise(y: Array, fits: LocalFits) -> tuple[float, float]:
    """Noise deviation √(Σ r²/Σ(1 − 2 leverage + gain²)) (Cleveland & Devlin 1988), and mean leverage of a point."""
    sound = ~fits.singular
    residual, leverage = (y - fits.value)[sound], fits.leverage[sound]
    freedom = float(np.sum(1 - 2 * leverage + fits.value_gain[sound] ** 2))
    if freedom < 1:
        raise DataError(
            "The neighbourhoods contain no more points than the polynomial has terms; choose a larger smoothing."
        )
    return float(np.sqrt(np.sum(residual**2) / freedom)), float(leverage.mean())


def _determined(requested: LocalFits, own: LocalFits, noise: float, unit: float) -> tuple[Array, Array, int]:
    """μ and its standard error, NaN if the nearby points are too few or too one-sided, and the number of NaN."""
    with np.errstate(invalid="ignore"):
        wild = ~(requested.mixed_gain <= _MAX_GAIN_RATIO * np.nanmedian(own.mixed_gain))
    mu, se = (np.where(wild, np.nan, unit * x) for x in (requested.mixed, noise * requested.mixed_gain))
    return mu, se, int(wild.sum())


def _points(alpha: ArrayLike, beta: ArrayLike, y: ArrayLike) -> tuple[Array, Array, Array]:
    try:
        a, b, values = (np.asarray(x, dtype=float) for x in (alpha, beta, y))
    except NOT_NUMBERS:
        raise DataError("α, β and y must be three lists of numbers.") from None
    if a.ndim != 1 or not a.shape == b.shape == values.shape:
        raise DataError(
            f"α, β and y must be three lists of one length, got shapes {a.shape}, {b.shape} and {values.shape}."
        )
    unknown = int(np.sum(~np.isfinite(a + b + values)))
    if unknown:
        raise DataError(f"{unknown} of {a.size} points are not numbers. Leave them out.")
    above = int(np.sum(b > a))
    if above:
        raise DataError(f"{above} of {a.size} points have β > α. Give rising (magnetic) curves mirrored.")
    if a.size < _FEWEST:
        raise DataError(f"{a.size} points are too few for a density. Give at least {_FEWEST}.")
    return a, b, values


def _places(at: tuple[ArrayLike, ArrayLike]) -> tuple[Array, Array]:
    wrong = DataError("The places must be two lists of numbers, α and β, of one length.")
    try:
        a, b = np.broadcast_arrays(*(np.asarray(x, dtype=float) for x in at))
    except NOT_NUMBERS:
        raise wrong from None
    if a.ndim != 1 or not np.all(np.isfinite(a + b)):
        raise wrong
    return a.copy(), b.copy()


def _inside_triangle(places: tuple[Array, Array], alpha: Array, beta: Array) -> tuple[Array, Array]:
    """The places; DataError for a place outside the triangle of the points."""
    low, high = beta.min(), alpha.max()
    slack = 1e-9 * (high - low)
    a, b = places
    outside = int(np.sum((b < low - slack) | (b > a + slack) | (a > high + slack)))
    if outside:
        raise DataError(
            f"{outside} of {a.size} places lie outside the triangle of the points (least β ≤ β ≤ α ≤ largest α): "
            "a density is not extrapolated."
        )
    return places


def _scale(steps: tuple[float, float]) -> Array:
    """(Δα, Δβ) as an array; UsageError unless they are two positive numbers."""
    try:
        scale = np.array(steps, dtype=float)
    except NOT_NUMBERS:
        scale = np.empty(0)
    if scale.shape != (2,) or not np.all((scale > 0) & np.isfinite(scale)):
        raise UsageError(f"The grid steps (Δα, Δβ) must be two positive numbers, got {steps!r:.60}.")
    return scale


def _check_options(
    smoothing: float | None, nearest: int | None, degree: int | None, window: str, points: int
) -> None:
    if window not in WINDOWS:
        raise UsageError(f"Window '{window}' is unknown. Choose from {', '.join(WINDOWS)}.")
    if smoothing is not None and nearest is not None:
        raise UsageError("Give a smoothing factor or a number of nearest points, not both.")
    if window != "loess" and smoothing is None:
        raise UsageError(f"Window '{window}' needs a smoothing factor. Give smoothing=….")
    if smoothing is not None and not (isinstance(smoothing, Real) and 0 < smoothing < np.inf):
        raise UsageError(
            f"The smoothing factor must be a positive number of grid steps, got {smoothing!r:.40}."
        )
    if nearest is not None and not (isinstance(nearest, Integral) and _FEWEST <= nearest <= points):
        raise UsageError(
            f"nearest must be a whole number between {_FEWEST} and the number of points {points}, "
            f"got {nearest!r:.40}."
        )
    if degree is not None and degree not in (2, 3, 4):
        raise UsageError(f"The polynomial's degree must be 2, 3 or 4, got {degree}.")
