"""The choice of the "best" kind of surface for ``identify``, by the prediction of held-out curves.

Whole curves are held out, in up to five groups. The highest and the lowest stay, because nothing could interpolate
to them. A simpler kind is chosen if its error is within 10 % of the best. The smoothness of the positive measure is
chosen once, on all curves, and kept for every group.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, DataError
from smarig.identification.fod_data import FodData, curve_table, table
from smarig.identification.positive.observations import Observations
from smarig.identification.positive.positive_fit import PositiveFit, fit_positive
from smarig.identification.positive.quadratic_programme import MeasureProblem
from smarig.identification.positive.smoothing_choice import COMPARISON_ACCURACY
from smarig.identification.surface.surface_fit import MajorLoopWeighting, SurfaceFit, fit_surface
from smarig.identification.surface.surface_kinds import POSITIVE_KIND, kinds_by_freedom, surface_kinds
from smarig.preisach import FodSurface, FodTable, ForcTable, lattice, surface_forms

Mask = NDArray[np.bool_]
FittedImage = FodSurface | FodTable | ForcTable
# Over 25 seeds of the one-wire constant surface, a freer kind was better by at most 7 % by chance.
SIMPLER_TOLERANCE = 1.1
GROUPS = 5
FEWEST_CURVES = 4
MOST_POINTS = 1500  # largest number of points for the comparison of surfaces: magnetic data have thousands
MOST_OBSERVATIONS = 4000  # of a positive measure, for which more points mean finer cells
RESAMPLES = 2000
INTERVAL_LEVEL = 0.9
_CELLS = 120  # intervals of the grid on which negative mass is summed


@dataclass(frozen=True)
class SurfaceChoice:
    """The chosen kind, and the error of every kind on the ``curves`` held-out curves, in the data's unit.

    ``held_out_rms`` is the rms over curves of a curve's rms error. ``held_out_interval`` is its 90 % interval by
    resampling the curves. ``negative_share`` is ∬μ⁻/∬|μ| of the kind fitted to all curves. ``fit`` is the fit of
    the chosen surface to all compared points, None for other kinds.
    """

    kind: str
    held_out_rms: dict[str, float]
    curves: int
    held_out_interval: dict[str, tuple[float, float]] = field(default_factory=dict)
    negative_share: dict[str, float] = field(default_factory=dict)
    fit: SurfaceFit | None = field(default=None, repr=False, compare=False)


@dataclass(frozen=True)
class _Candidate:
    """One kind: its fit to all curves, and the function that fits it to the points of a mask of ``data``."""

    whole: FittedImage
    data: FodData
    fitted: Callable[[Mask], FittedImage]
    fit: SurfaceFit | None = None


def choose_surface(
    data: FodData, *, anchor: bool = False, weights: MajorLoopWeighting = "residual"
) -> SurfaceChoice:
    """Compare all kinds of surface by held-out curves.

    Raises DataError if there are fewer than four curves, or if no kind can be fitted.
    """
    alphas = np.unique([d.alpha for d in data.descending_curves()])
    if alphas.size < FEWEST_CURVES:
        raise DataError(
            f"Choosing the best surface holds out curves and needs at least {FEWEST_CURVES}; there are "
            f"{alphas.size}. Name a surface instead (positive needs no curves)."
        )
    held = alphas[1:-1]
    errors: dict[str, Array] = {}
    shares: dict[str, float] = {}
    fits: dict[str, SurfaceFit | None] = {}
    for kind in surface_kinds():
        try:
            candidate = _candidate(data, kind, anchor, weights)
            errors[kind] = _held_out_errors(candidate, held, data)
        except DataError:
            continue
        shares[kind] = 0.0 if kind == POSITIVE_KIND else negative_share(candidate.whole)
        fits[kind] = candidate.fit
    if not errors:
        raise DataError("No kind of surface could be fitted with curves held out. Name a surface instead.")
    rms = {kind: float(np.sqrt(e.mean())) for kind, e in errors.items()}
    intervals = {kind: rms_interval(e) for kind, e in errors.items()}
    best = _simplest(rms)
    return SurfaceChoice(best, rms, held.size, intervals, shares, fits[best])


def rms_interval(squares: Array, level: float = INTERVAL_LEVEL) -> tuple[float, float]:
    """Interval of √mean of the curves' mean square errors (curves,): percentiles of resampled curves.

    >>> rms_interval(np.full(7, 4.0))
    (2.0, 2.0)
    """
    drawn = np.random.default_rng(0).integers(squares.size, size=(RESAMPLES, squares.size))
    low, high = np.quantile(np.sqrt(squares[drawn].mean(axis=1)), [0.5 - level / 2, 0.5 + level / 2])
    return float(low), float(high)


def negative_share(hysteresis: FittedImage) -> float:
    """∬μ⁻/∬|μ| from the masses of a table's own cells, or of a fine grid; 0 if μ is 0 everywhere."""
    u = lattice(hysteresis, _CELLS)
    F = hysteresis.swept(np.maximum(u[:, None], u), np.minimum(u[:, None], u))
    mass = (F[1:, :-1] - F[:-1, :-1] - F[1:, 1:] + F[:-1, 1:])[np.tri(u.size - 1, k=-1, dtype=bool)]
    whole = float(np.abs(mass).sum())
    return float(np.abs(mass[mass < 0]).sum()) / whole if whole else 0.0


def _simplest(rms: dict[str, float]) -> str:
    """The best kind among the simplest that are within ``SIMPLER_TOLERANCE`` of the best of all."""
    enough = SIMPLER_TOLERANCE * min(rms.values())
    for level in kinds_by_freedom():
        good = [kind for kind in level if rms.get(kind, np.inf) <= enough]
        if good:
            return min(good, key=lambda kind: rms[kind])
    return min(rms, key=lambda kind: rms[kind])


def _held_out_errors(candidate: _Candidate, held: Array, data: FodData) -> Array:
    """Mean square error (curves,) of each held-out curve over all its points; only the fit uses thinned data."""
    errors = np.full(held.size, np.nan)
    for group in range(min(GROUPS, held.size)):
        out = np.arange(held.size) % GROUPS == group
        surface = candidate.fitted(~np.isin(candidate.data.alpha, held[out]))
        for k in np.flatnonzero(out):
            mine = data.alpha == held[k]
            errors[k] = np.mean((surface.y(data.alpha[mine], data.beta[mine]) - data.y[mine]) ** 2)
    return errors


def _candidate(data: FodData, kind: str, anchor: bool, weights: MajorLoopWeighting) -> _Candidate:
    if kind in surface_forms():
        some = thinned(data, MOST_POINTS)
        whole = fit_surface(some, kind, anchor=anchor, weights=weights)

        def fitted(train: Mask) -> FodSurface:
            form = whole.surface.form  # started at the fit to all curves
            return fit_surface(some.where(train), form, anchor=anchor, weights=weights, start=whole).surface

        return _Candidate(whole.surface, some, fitted, whole)
    if kind == POSITIVE_KIND:
        some = thinned(data, MOST_OBSERVATIONS)
        fit = fit_positive(Observations.of_fod(some))
        return _Candidate(fit.table, some, _positive_refit(some, fit))
    return _Candidate(table(data), data, lambda train: curve_table(data.where(train)))


def _positive_refit(data: FodData, whole: PositiveFit) -> Callable[[Mask], FodTable]:
    """The positive measure of the training curves, with the cells and the λ of the fit to all curves."""
    triangle, (zero, scale) = whole.triangle, (float(data.y.min()), float(np.ptp(data.y)))
    problem = MeasureProblem.of(triangle, Observations.of_fod(data), scale, zero)

    def fitted(train: Mask) -> FodTable:
        solution = problem.solved(whole.smoothing, train, accuracy=COMPARISON_ACCURACY)
        return triangle.table(scale * solution.s, zero + scale * float(solution.x[triangle.unknowns - 1]))

    return fitted


def thinned(data: FodData, most: int) -> FodData:
    """Every k-th point of the curves, about ``most`` of them, including the first and last of each curve."""
    return data.where(thinning_mask(data.curve, most))


def thinning_mask(curve: NDArray[np.int64], most: int) -> Mask:
    """Mask (m,) of every k-th point in order of measurement, and of the first and last of each longer curve.

    >>> thinning_mask(np.array([0, 0, 0, 0, 1, 1, 1, 1]), 4).astype(int).tolist()
    [1, 0, 1, 1, 1, 0, 1, 1]
    """
    stride = max(1, -(-curve.size // most))
    keep = np.arange(curve.size) % stride == 0
    edges = np.concatenate([[0], np.flatnonzero(np.diff(curve)) + 1, [curve.size]])
    long = np.diff(edges) > stride  # noise of a dense record produces thousands of short ones
    keep[edges[:-1][long]] = keep[edges[1:][long] - 1] = True
    return keep
