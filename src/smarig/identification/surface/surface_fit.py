"""Least-squares fit of the surface (5.5) to FOD data, with confidence intervals (thesis §5.4.2).

Points on the major loop have double weight, as in the thesis. The thesis does not state whether it doubled
residuals or their squares, so both are available. The saturation values y(u₊,u₊) and y(u₊,u₋) are fitted like any
other parameter, or anchored to their measured values, as in the thesis.

Weights express the desired match, not the noise. With equal noise σ at every point the covariance of the weighted
estimate is σ² (JᵀWJ)⁻¹ JᵀW²J (JᵀWJ)⁻¹, and σ² is the plain sum of squares over tr((I − H)ᵀ(I − H)), H = J (JᵀWJ)⁻¹
JᵀW. The fit reports these. Residuals of slopes (``slope_residuals``) add SᵀS to W.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.optimize import least_squares
from scipy.sparse import csr_matrix

from smarig.core import Array, DataError, UsageError, spaced, t_quantile
from smarig.identification.fod_data import FodData
from smarig.identification.surface.surface_jacobian import FLATTEST, jacobian, ranked_starts, slope_rows
from smarig.preisach import FodSurface, Parameters, SurfaceForm, surface_form

MajorLoopWeighting = Literal["residual", "square"]
ROOT_WEIGHT: dict[MajorLoopWeighting, float] = {"residual": 2.0, "square": float(np.sqrt(2.0))}
REFINED_STARTS = 3
_STEEPEST = 500.0  # upper bound of x₂ and x₄ times the range
_DEGENERATE_RESIDUAL = 1e3


@dataclass(frozen=True, eq=False)
class SurfaceFit:
    """A fitted surface and the statistics of its fit.

    ``names`` (p,) of the free parameters, their ``values`` (p,), ``covariance`` (p, p) and 95 % ``intervals``
    (Student's t, n − p degrees of freedom). ``sse`` = Σe² over the points, ``rms`` = √(sse/n), ``norm2`` = √sse;
    ``weighted_sse`` = Σw e² and its root ``weighted_norm2``. Units are those of the data.
    """

    surface: FodSurface
    names: tuple[str, ...]
    values: Array
    covariance: Array
    intervals: dict[str, tuple[float, float]]
    sigma: float
    rms: float
    sse: float
    norm2: float
    weighted_sse: float
    weighted_norm2: float
    points: int
    curves: int
    weights: MajorLoopWeighting
    anchored: bool
    converged: bool
    starts: int
    slope_weight: float = 0.0

    @property
    def determined(self) -> bool:
        """Whether the data determine every parameter."""
        return bool(np.isfinite(self.covariance).all())

    def __repr__(self) -> str:
        unit = self.surface.unit
        parts = (
            f"{name} = {value:.5g} ± {(high - low) / 2:.2g}"
            for (name, (low, high)), value in zip(self.intervals.items(), self.values)
        )
        return (
            f"SurfaceFit({self.surface.form}, {self.points} points, {self.curves} curves, "
            f"rms {self.rms:.4g}{spaced(unit)}; {', '.join(parts)})"
        )


@dataclass(frozen=True, eq=False)
class _SurfaceProblem:
    """Data, form and ends: maps a parameter vector to a surface, residuals and their Jacobian."""

    form: str
    data: FodData
    ends: tuple[float, float] | None  # (y_upper, y_lower) when anchored
    root_weights: Array
    slopes: csr_matrix | None = None  # maps errors of outputs to weighted errors of slopes

    @property
    def surface_form(self) -> SurfaceForm:
        return surface_form(self.form)

    @property
    def names(self) -> tuple[str, ...]:
        return self.surface_form.parameters + (() if self.ends else ("y_upper", "y_lower"))

    def surface(self, p: Array) -> FodSurface:
        n = len(self.surface_form.parameters)
        y_upper, y_lower = self.ends or (float(p[n]), float(p[n + 1]))
        x = tuple(float(v) for v in p[:n])
        return FodSurface(
            form=self.form,
            x=x,
            lower=self.data.lower,
            upper=self.data.upper,
            y_lower=y_lower,
            y_upper=y_upper,
            unit=self.data.unit,
        )

    def residuals(self, p: Array) -> Array:
        surface = self.surface(p)
        # The step went too far: no height to scale.
        if surface.shape(surface.upper, surface.upper) < FLATTEST:
            size = self.root_weights.size + (0 if self.slopes is None else self.slopes.nnz // 2)
            return np.full(size, _DEGENERATE_RESIDUAL * float(np.ptp(self.data.y)))
        error = surface.y(self.data.alpha, self.data.beta) - self.data.y
        weighted = error * self.root_weights
        return weighted if self.slopes is None else np.concatenate([weighted, self.slopes @ error])

    def jacobian(self, p: Array) -> Array:
        J = self.plain_jacobian(p)
        weighted = J * self.root_weights[:, None]
        return weighted if self.slopes is None else np.vstack([weighted, self.slopes @ J])

    def weighted(self, J: Array) -> Array:
        """W J, with W of outputs and slopes."""
        by_output = (self.root_weights**2)[:, None] * J
        return by_output if self.slopes is None else by_output + self.slopes.T @ (self.slopes @ J)

    def plain_jacobian(self, p: Array) -> Array:
        return jacobian(self.surface(p), self.data.alpha, self.data.beta)[:, : len(self.names)]

    def bounds(self) -> tuple[Array, Array]:
        span = self.data.upper - self.data.lower
        steep = _STEEPEST / span
        bounds = {
            "x2": (0.0, steep),
            "x3": (-(self.data.upper + span), -(self.data.lower - span)),
            "x4": (0.0, steep),
            **self.surface_form.bounds(self.data.lower, self.data.upper),
        }
        low, high = np.array([bounds.get(name, (-np.inf, np.inf)) for name in self.names]).T
        return low, high


def fit_surface(
    data: FodData,
    form: str = "exponential",
    *,
    anchor: bool = False,
    weights: MajorLoopWeighting = "residual",
    start: SurfaceFit | None = None,
    slopes: float = 0.0,
) -> SurfaceFit:
    """Fit (5.5) with f(α) of a form by least squares from several starts.

    ``weights`` doubles the "residual" or the "square" on the major loop. ``anchor`` fixes y(u₊,u₊) and y(u₊,u₋) at
    their measured means. ``start`` is an earlier fit to start from instead of searching. ``slopes`` is the weight of
    residuals in the slopes along the curves (§9.2), 0: none. Raises UsageError for an unknown form or weight, DataError
    if there are fewer points than parameters, or none at an anchor.
    """
    if not 0.0 <= slopes < np.inf:
        raise UsageError(f"The weight of slopes must be 0 or a positive number, got {slopes:g}.")
    surface_form(form)
    if weights not in ROOT_WEIGHT:
        raise UsageError(f"Weights '{weights}' are not one of {', '.join(ROOT_WEIGHT)}.")
    root_weights = np.where(data.major, ROOT_WEIGHT[weights], 1.0)
    rows = slope_rows(data, slopes) if slopes else None
    problem = _SurfaceProblem(form, data, _measured_ends(data) if anchor else None, root_weights, rows)
    needed = len(problem.names) + 1
    if len(data) < needed:
        raise DataError(
            f"The {form} surface has {needed - 1} parameters here and needs {needed} FOD points or more; "
            f"there are {len(data)}."
        )
    starts = [start.values] if start is not None and start.names == problem.names else _starts(problem)
    trials = [_refined(problem, p) for p in starts]
    if not trials:
        raise DataError(
            f"No {form} surface resembles the data: the output does not rise with the input. Change the sign of the "
            "output, or check the input."
        )
    best = min(trials, key=lambda trial: trial.cost)
    return _surface_fit(problem, best.x, weights, best.status > 0, len(trials), slopes)


def _starts(problem: _SurfaceProblem) -> list[Array]:
    data, root_weights = problem.data, problem.root_weights
    fitted: Parameters = ()
    grows_from = problem.surface_form.grows_from
    if grows_from is not None:
        simple = _SurfaceProblem(grows_from, data, problem.ends, root_weights, problem.slopes)
        trials = [_refined(simple, p) for p in _starts(simple)]
        if not trials:
            return []
        p = min(trials, key=lambda trial: trial.cost).x
        fitted = tuple(p[: len(simple.surface_form.parameters)].tolist())
    guesses = ranked_starts(problem.form, data, root_weights, fitted)
    # Neighbours in rank are often close in space, so every third start is used.
    chosen = guesses[: 3 * REFINED_STARTS : 3]
    ends = [] if problem.ends else list(_rough_ends(data))
    return [np.array([*guess, *ends]) for guess in chosen]


def _refined(problem: _SurfaceProblem, start: Array):
    low, high = problem.bounds()
    margin = 1e-9 * np.where(np.isfinite(high - low), high - low, 1.0)
    return least_squares(
        problem.residuals,
        np.clip(start, low + margin, high - margin),
        jac=problem.jacobian,
        bounds=(low, high),
        x_scale="jac",
        xtol=1e-10,
        ftol=1e-10,
        gtol=1e-12,
        max_nfev=300,
    )


def _surface_fit(
    problem: _SurfaceProblem,
    p: Array,
    weights: MajorLoopWeighting,
    converged: bool,
    starts: int,
    slope_weight: float,
) -> SurfaceFit:
    data = problem.data
    surface = problem.surface(p)
    error = surface.y(data.alpha, data.beta) - data.y
    sse, weighted_sse = float(error @ error), float(np.sum(problem.residuals(p)[: len(data)] ** 2))
    covariance, sigma = _covariance(problem, p, sse)
    half = t_quantile(0.975, len(data) - p.size) * np.sqrt(np.diag(covariance))
    intervals = {n: (float(v - h), float(v + h)) for n, v, h in zip(problem.names, p, half)}
    return SurfaceFit(
        surface=surface,
        names=problem.names,
        values=p,
        covariance=covariance,
        intervals=intervals,
        sigma=sigma,
        rms=float(np.sqrt(sse / len(data))),
        sse=sse,
        norm2=float(np.sqrt(sse)),
        weighted_sse=weighted_sse,
        weighted_norm2=float(np.sqrt(weighted_sse)),
        points=len(data),
        curves=data.curves,
        weights=weights,
        anchored=problem.ends is not None,
        converged=converged,
        starts=starts,
        slope_weight=slope_weight,
    )


def _covariance(problem: _SurfaceProblem, p: Array, sse: float) -> tuple[Array, float]:
    """Sandwich covariance and σ for equal noise (see the module); NaN if J is rank deficient."""
    J = problem.plain_jacobian(p)
    scale = np.linalg.norm(J, axis=0)
    if not scale.all() or np.linalg.cond(J / scale) > 1e10:
        return np.full((J.shape[1],) * 2, np.nan), float("nan")
    scaled = J / scale
    weighted = problem.weighted(scaled)
    bread = np.linalg.inv(scaled.T @ weighted)
    gain = bread @ weighted.T  # estimate = gain · noise
    freedom = J.shape[0] - 2 * J.shape[1] + float(np.sum((gain @ gain.T) * (scaled.T @ scaled)))
    variance = sse / freedom
    return variance * (gain @ gain.T) / np.outer(scale, scale), float(np.sqrt(variance))


def _measured_ends(data: FodData) -> tuple[float, float]:
    """Mean measured y(u₊,u₊) and mean of the curves' ends at u₋ (§5.5: they may not merge)."""
    top = data.y[(data.alpha == data.upper) & (data.beta == data.upper)]
    bottom = data.y[data.beta == data.lower]
    if not top.size or not bottom.size:
        raise DataError(
            f"Anchoring needs measured outputs at both ends of the range: ({data.upper:g}, {data.upper:g}) "
            f"and β = {data.lower:g}."
        )
    return float(top.mean()), float(bottom.mean())


def _rough_ends(data: FodData) -> tuple[float, float]:
    return float(data.y.max()), float(data.y.min())
