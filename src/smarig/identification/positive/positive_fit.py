"""The ``positive`` identification: a non-negative measure, determined by smoothness where there are no data (§5.6,
§9.2).

    minimise  Σ (Xθ − y)²/m  +  λ ∬ (ρ_αα² + 2 ρ_αβ² + ρ_ββ²) + λ ∫ g″²     over masses ≥ 0

It follows Banks, Kurdila and Webb: measures on finer and finer triangles converge. The programme is strictly convex, so
its solution is unique, and M_P holds by construction, including the reversible part. λ is the value with the best
prediction of held-out curves; without any, it is small, and smaller where the output moves over a small part of the
range only: the roughness of a density of given mass grows with the sixth power of its inverse width. The directions
that the data do not determine are counted, and predictions have intervals. A roughness weighted by 1/density was better
at its best λ, and worse at the λ that can be chosen.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import structural_rank
from scipy.special import ndtri
from threadpoolctl import threadpool_limits

from smarig.core import Array, DataError, UsageError, root_mean_square, spaced
from smarig.identification.positive.adapted_partition import active_width, adapted_nodes
from smarig.identification.positive.interior_point import Solution
from smarig.identification.positive.observations import MIN_REVERSAL, Observations, joined_observations
from smarig.identification.positive.quadratic_programme import MeasureProblem, dense_columns, quadratic_forms
from smarig.identification.positive.smoothing_choice import (
    HeldOut,
    curve_folds,
    held_out_test,
    largest_smoothing_within_one_error,
    segment_folds,
    smoothing_by_held_out,
)
from smarig.identification.positive.triangle import Triangle
from smarig.preisach import FodTable

INTERVALS, COARSE = 40, 25  # intervals of the fitted triangle, and of the one that chooses λ
MANY_POINTS, REFINEMENT = 2000, 1.5  # from so many points on, finer cells
FEWEST_CURVES = 4
DEFAULT_SMOOTHING = 1e-12  # of an output that moves over the whole range
ROUGHNESS_POWER = 6  # of the inverse width of a density of given mass
_ZERO = 1e-8  # of the output range: a smaller mass counts as zero
# A band is some sixty entries wide. BLAS would share that among threads, which then wait for each other.
_one_thread = threadpool_limits.wrap(limits=1, user_api="blas")


@dataclass(frozen=True, eq=False)
class PositiveFit:
    """A non-negative measure and its fit to the data. Outputs are in ``unit``.

    ``table`` is the hysteresis, ``masses`` (cells,) ≥ 0 its measure ν. ``smoothing`` is λ. ``by_smoothing`` is the
    typical held-out error of a curve by λ (empty if λ was given). ``sigma`` is the residual standard deviation,
    ``freedom`` the effective number of parameters. ``null_space`` is the number of directions of the measure that no
    data point determines; smoothness alone decides them.
    """

    table: FodTable
    triangle: Triangle
    masses: Array
    smoothing: float
    by_smoothing: dict[float, float]
    sigma: float
    rms: float
    freedom: float
    null_space: int
    points: int
    curves: int
    symmetric: bool
    unit: str
    _solution: Solution
    _posed_problem: "_PosedProblem"

    @cached_property
    @_one_thread
    def held_out(self) -> HeldOut:
        """The result of held-out curves."""
        posed, scale = self._posed_problem, self._posed_problem.scale
        curve, sigma = posed.all_observations.curve, self.sigma / scale
        found = held_out_test(posed.problem, posed.masks, curve, self.smoothing, sigma)
        return HeldOut(scale * found.rms, scale * found.signed_rms, found.spread_factor, found.curves)

    @property
    def cells(self) -> int:
        """Number of cells of the triangle, including the diagonal."""
        return self.masses.size

    @property
    def zeros(self) -> Array:
        """Free zeros of the outputs (k,), in output units: those in addition to y₋."""
        return self._posed_problem.scale * self._solution.x[self.triangle.unknowns :]

    @property
    def at_zero(self) -> int:
        """Number of cells that the constraint holds at zero."""
        return int(np.sum(self.masses == 0))

    @property
    def rank(self) -> int:
        """Number of directions that the data determine, including the zero of the output."""
        return self._solution.x.size - self.null_space

    @property
    def reversible_share(self) -> float:
        """Share of the output range in the cells on the diagonal; NaN for a constant output."""
        total = float(self.masses.sum())
        diagonal = float(self.masses[self.triangle.i == self.triangle.j].sum())
        return diagonal / total if total else float("nan")

    def y(self, alpha: ArrayLike, beta: ArrayLike) -> Array:
        """y(α, β), vectorised."""
        return self.table.y(alpha, beta)

    def covariance(self, rows: csr_matrix, second_rows: csr_matrix | None = None) -> Array:
        """Posterior covariance, unit² (k, l), of linear functions (k, n) and (l, n) of the triangle's unknowns.

        It is Gaussian, on the active constraints, and includes ``held_out.spread_factor``.
        """
        n = self._solution.x.size
        left, right = dense_columns(rows, n), dense_columns(rows if second_rows is None else second_rows, n)
        return self._variance * (left.T @ self._solution.inverse(right))

    @property
    def _variance(self) -> float:
        return (self.held_out.spread_factor * self.sigma) ** 2 / self.points

    def sd(self, alpha: ArrayLike, beta: ArrayLike) -> Array:
        """Standard deviation of the predicted y(α, β), broadcast, with the spread factor of ``held_out``."""
        a, b = np.broadcast_arrays(np.asarray(alpha, dtype=float), np.asarray(beta, dtype=float))
        rows = self.triangle.values(a.ravel(), b.ravel())
        spread = quadratic_forms(self._solution.inverse, rows, self._solution.x.size)
        return np.sqrt(self._variance * spread).reshape(a.shape)

    def interval(self, alpha: ArrayLike, beta: ArrayLike, level: float = 0.9) -> tuple[Array, Array]:
        """(low, high) that contains a new reading of y(α, β) with probability ``level``."""
        if not 0 < level < 1:
            raise UsageError(f"The level of an interval must lie between 0 and 1, but is {level:g}.")
        half = ndtri(0.5 + level / 2) * np.hypot(
            self.sd(alpha, beta), self.held_out.spread_factor * self.sigma
        )
        y = self.y(alpha, beta)
        return y - half, y + half

    def __repr__(self) -> str:
        return (
            f"PositiveFit({self.points} points, {self.curves} curves; {self.cells} cells, {self.at_zero} at "
            f"zero; rms {self.rms:.4g}{spaced(self.unit)}, λ {self.smoothing:.1g}, {self.freedom:.0f} effective "
            f"parameters, {self.null_space} directions left to smoothness)"
        )


@_one_thread
def fit_positive(
    observations: Observations,
    *,
    intervals: int | None = None,
    nodes: ArrayLike | None = None,
    smoothing: float | None = None,
    symmetric: bool = False,
) -> PositiveFit:
    """Fit a non-negative measure to observations of any history.

    ``intervals`` is the number of intervals of the partition (default 40, or 60 for thousands of points), ``nodes``
    the partition itself. ``smoothing`` is λ. If None, it is chosen by held-out curves, or by held-out segments if
    there are too few symmetric curves. ``symmetric`` requires the symmetry (u, y) → (−u, −y). Raises DataError if
    the output does not move or there are fewer than three points.

    >>> u = np.linspace(0.0, 1.0, 9)
    >>> alpha, beta = (u[k] for k in np.tril_indices(9))
    >>> exact = Observations.of_points(alpha, beta, alpha * beta, np.tril_indices(9)[0], (0.0, 1.0))
    >>> fit = fit_positive(exact, intervals=16)
    >>> bool(abs(fit.y(0.55, 0.3) - 0.55 * 0.3) < 2e-3), bool((fit.masses >= 0).all())
    (True, True)
    """
    return _positive_fit(
        _posed_problem(observations, intervals, nodes, smoothing, symmetric), observations.unit
    )


@_one_thread
def fit_table(observations: Observations, smoothing: float | None = None) -> FodTable:
    """The hysteresis of ``fit_positive`` without its statistics; on the coarsest sufficient triangle if λ is known."""
    posed_problem = _posed_problem(
        observations, INTERVALS if smoothing else None, None, smoothing, symmetric=False
    )
    solution = posed_problem.problem.solved(posed_problem.smoothing)
    return posed_problem.table(solution, _masses(solution, posed_problem.scale), observations.unit)


@dataclass(frozen=True, eq=False)
class _PosedProblem:
    """A problem with its λ, before its solution is analysed."""

    problem: MeasureProblem
    all_observations: Observations
    masks: list[NDArray[np.bool_]]
    smoothing: float
    by_smoothing: dict[float, float]
    scale: float
    zero: float
    symmetric: bool

    def y_lower(self, solution: Solution) -> float:
        """The output of negative saturation."""
        return self.zero + self.scale * float(solution.x[self.problem.triangle.unknowns - 1])

    def table(self, solution: Solution, masses: Array, unit: str) -> FodTable:
        """The hysteresis of a solution."""
        return self.problem.triangle.table(masses, self.y_lower(solution), unit)


def _posed_problem(
    observations: Observations,
    intervals: int | None,
    nodes: ArrayLike | None,
    smoothing: float | None,
    symmetric: bool,
) -> _PosedProblem:
    scale, zero = _scales(observations, smoothing)
    all_observations = (
        joined_observations([observations, observations.mirrored()]) if symmetric else observations
    )
    masks = _folds(observations, copies=2 if symmetric else 1)
    more = REFINEMENT if len(observations) > MANY_POINTS else 1.0
    fine = intervals or int(INTERVALS * more)
    triangle = Triangle(adapted_nodes(observations, fine) if nodes is None else np.array(nodes, dtype=float))
    problem = MeasureProblem.of(triangle, all_observations, scale, zero)
    by_smoothing: dict[float, float] = {}
    if smoothing is None and (masks or symmetric):
        coarse = (
            adapted_nodes(observations, min(int(COARSE * more), fine))
            if nodes is None
            else np.append(triangle.nodes[:-1:2], triangle.nodes[-1])
        )
        same = np.array_equal(coarse, triangle.nodes)
        rough = problem if same else MeasureProblem.of(Triangle(coarse), all_observations, scale, zero)
        smoothing, errors = _chosen_smoothing(rough, masks, all_observations, observations)
        by_smoothing = {k: scale * v for k, v in errors.items()}
    smoothing = smoothing or DEFAULT_SMOOTHING * active_width(observations) ** ROUGHNESS_POWER
    return _PosedProblem(
        problem=problem,
        all_observations=all_observations,
        masks=masks,
        smoothing=smoothing,
        by_smoothing=by_smoothing,
        scale=scale,
        zero=zero,
        symmetric=symmetric,
    )


def _masses(solution: Solution, scale: float) -> Array:
    return scale * np.where(solution.s > _ZERO, solution.s, 0.0)


def _chosen_smoothing(
    problem: MeasureProblem,
    masks: list[NDArray[np.bool_]],
    all_observations: Observations,
    observations: Observations,
) -> tuple[float, dict[float, float]]:
    """λ by whole held-out curves, or by segments if there are too few symmetric loops for that."""
    if masks:
        return smoothing_by_held_out(problem, masks, all_observations.curve)
    segment_masks = [np.tile(mask, 2) for mask in segment_folds(observations.curve)]
    return largest_smoothing_within_one_error(problem, segment_masks, all_observations.curve)


def _scales(observations: Observations, smoothing: float | None) -> tuple[float, float]:
    if smoothing is not None and not (np.isfinite(smoothing) and smoothing > 0):
        raise UsageError(f"The smoothing must be a positive number, but is {smoothing:g}.")
    if len(observations) < 3:
        raise DataError(f"A measure cannot be fitted to {len(observations)} points. Give at least three.")
    spread = float(np.ptp(observations.y))
    if not np.isfinite(spread) or spread == 0:
        raise DataError("The output is the same at every point. There is no motion to identify.")
    return spread, float(observations.y.min())


def _folds(observations: Observations, copies: int) -> list[NDArray[np.bool_]]:
    if np.unique(observations.curve).size < FEWEST_CURVES:
        return []
    masks = curve_folds(observations.curve, _farthest(observations))
    return [np.tile(mask, copies) for mask in masks or curve_folds(observations.curve)]


def _farthest(observations: Observations) -> int | None:
    """The curve whose largest input no other reaches; None if another nearly does."""
    curves, number = np.unique(observations.curve, return_inverse=True)
    reached = np.full(curves.size, -np.inf)
    np.maximum.at(reached, number[observations.term], observations.alpha)
    second, first = np.sort(reached)[-2:]
    beyond = first - second > MIN_REVERSAL * (observations.upper - observations.lower)
    return int(curves[np.argmax(reached)]) if beyond else None


def _positive_fit(posed_problem: _PosedProblem, unit: str) -> PositiveFit:
    problem, all_observations, scale, smoothing = (
        posed_problem.problem,
        posed_problem.all_observations,
        posed_problem.scale,
        posed_problem.smoothing,
    )
    solution = problem.solved(smoothing)
    masses = _masses(solution, scale)
    residual = problem.rows @ solution.x - problem.y
    freedom = min(_freedom(problem, solution), 0.9 * problem.y.size)
    sigma = float(np.sqrt(residual @ residual / (problem.y.size - freedom)))
    return PositiveFit(
        table=posed_problem.table(solution, masses, unit),
        triangle=problem.triangle,
        masses=masses,
        smoothing=smoothing,
        by_smoothing=posed_problem.by_smoothing,
        sigma=scale * sigma,
        rms=scale * root_mean_square(residual),
        freedom=freedom,
        null_space=problem.rows.get_shape()[1] - int(structural_rank(problem.rows)),
        points=problem.y.size,
        curves=np.unique(all_observations.curve).size,
        symmetric=posed_problem.symmetric,
        unit=unit,
        _solution=solution,
        _posed_problem=posed_problem,
    )


def _freedom(problem: MeasureProblem, solution: Solution) -> float:
    """tr(X M⁻¹ Xᵀ)/m, the trace of the smoother on the active constraints."""
    m, n = problem.rows.get_shape()
    if m < n:
        return float(quadratic_forms(solution.inverse, problem.rows, n).sum() / m)
    return float(np.trace(solution.inverse((problem.rows.T @ problem.rows).toarray()))) / m
