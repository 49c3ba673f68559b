"""The ``positive`` identification: a non-negative measure, smooth where the data is silent (§5.6, §9.2).

    minimise  Σ (Xθ − y)²/m  +  λ ∬ (ρ_αα² + 2 ρ_αβ² + ρ_ββ²) + λ ∫ g″²     over masses ≥ 0

in the spirit of Banks, Kurdila and Webb: measures on finer and finer triangles converge, the programme is
strictly convex, so its solution is unique, and M_P holds by construction, reversible part included. λ is the
one under which held-out curves are predicted best. What the data leaves open is counted, and predictions
carry intervals. Refuses to know where observations come from.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import structural_rank
from scipy.special import ndtri

from smarig.errors import DataError, UsageError
from smarig.identification.positive.held_out import HeldOut, judged
from smarig.identification.positive.nonnegative import Solution
from smarig.identification.positive.observations import Observations, joined
from smarig.identification.positive.partition import adapted
from smarig.identification.positive.problem import Problem, columns, quadratic
from smarig.identification.positive.smoothing import chosen, folds, smoothest, stretches
from smarig.identification.positive.triangle import Triangle
from smarig.preisach.fod_table import FodTable

Array = NDArray[np.float64]
INTERVALS, COARSE = 40, 25  # of the triangle that is fitted, of the one that chooses λ
MANY, MORE = 2000, 1.5  # thousands of points pay for finer ones
FEWEST_CURVES = 4
DEFAULT_SMOOTHING = 1e-12
_ZERO = 1e-8  # a mass below this part of the output range is zero


@dataclass(frozen=True, eq=False)
class PositiveFit:
    """A non-negative measure and what the data says of it. Outputs in ``unit``.

    ``table`` is the hysteresis, ``masses`` (cells,) ≥ 0 its measure ν. ``smoothing`` is λ; ``by_smoothing``
    the typical held-out error of a curve by λ (empty when λ was given), ``held_out`` what the held-out
    curves say of the fit. ``sigma`` is the residual standard deviation, ``freedom`` the effective number
    of parameters; ``null_space`` counts the directions of the measure that no point of the data sees,
    and that smoothness alone decides.
    """

    table: FodTable
    triangle: Triangle
    masses: Array
    smoothing: float
    by_smoothing: dict[float, float]
    held_out: HeldOut
    sigma: float
    rms: float
    freedom: float
    null_space: int
    points: int
    curves: int
    symmetric: bool
    unit: str
    _solution: Solution

    @property
    def cells(self) -> int:
        """Number of cells of the triangle, those on the diagonal included."""
        return self.masses.size

    @property
    def at_zero(self) -> int:
        """Number of cells the constraint holds at zero."""
        return int(np.sum(self.masses == 0))

    @property
    def rank(self) -> int:
        """Number of directions that the data fixes, the zero of the output included."""
        return self._solution.x.size - self.null_space

    @property
    def reversible_share(self) -> float:
        """Part of the output range that the cells on the diagonal carry."""
        return float(self.masses[self.triangle.i == self.triangle.j].sum() / self.masses.sum())

    def y(self, alpha: ArrayLike, beta: ArrayLike) -> Array:
        """y(α, β), vectorised."""
        return self.table.y(alpha, beta)

    def covariance(self, rows: csr_matrix, others: csr_matrix | None = None) -> Array:
        """Posterior covariance, unit² (k, l), of linear functions (k, n) and (l, n) of the triangle's unknowns.

        Gaussian, on the constraints that hold; ``held_out.stretch`` is included.
        """
        n = self._solution.x.size
        left, right = columns(rows, n), columns(rows if others is None else others, n)
        return self._variance * (left.T @ self._solution.inverse(right))

    @property
    def _variance(self) -> float:
        return (self.held_out.stretch * self.sigma) ** 2 / self.points

    def sd(self, alpha: ArrayLike, beta: ArrayLike) -> Array:
        """Standard deviation of the predicted y(α, β), broadcast, stretched as ``held_out`` says."""
        a, b = np.broadcast_arrays(np.asarray(alpha, dtype=float), np.asarray(beta, dtype=float))
        rows = self.triangle.values(a.ravel(), b.ravel())
        spread = quadratic(self._solution.inverse, rows, self._solution.x.size)
        return np.sqrt(self._variance * spread).reshape(a.shape)

    def interval(self, alpha: ArrayLike, beta: ArrayLike, level: float = 0.9) -> tuple[Array, Array]:
        """(low, high) in which a new reading of y(α, β) lies with probability ``level``."""
        if not 0 < level < 1:
            raise UsageError(f"An interval's level lies between 0 and 1, not at {level:g}.")
        half = ndtri(0.5 + level / 2) * np.hypot(self.sd(alpha, beta), self.held_out.stretch * self.sigma)
        y = self.y(alpha, beta)
        return y - half, y + half

    def __repr__(self) -> str:
        return (
            f"PositiveFit({self.points} points, {self.curves} curves; {self.cells} cells, {self.at_zero} at "
            f"zero; rms {self.rms:.4g} {self.unit}, λ {self.smoothing:.1g}, {self.freedom:.0f} effective "
            f"parameters, {self.null_space} directions left to smoothness)"
        )


def fit_positive(
    observations: Observations,
    *,
    intervals: int | None = None,
    nodes: ArrayLike | None = None,
    smoothing: float | None = None,
    symmetric: bool = False,
) -> PositiveFit:
    """Fit a non-negative measure to observations of any history.

    ``intervals`` of the partition (default 40, or 60 for thousands of points), or its ``nodes``;
    ``smoothing`` λ, chosen by held-out curves when None, by held-out stretches where symmetric curves are too
    few; ``symmetric`` asks for the symmetry of (u, y) → (−u, −y). Raises DataError when nothing moves, or there
    are fewer than three points.

    >>> u = np.linspace(0.0, 1.0, 9)
    >>> alpha, beta = (u[k] for k in np.tril_indices(9))
    >>> exact = Observations.of_points(alpha, beta, alpha * beta, np.tril_indices(9)[0], (0.0, 1.0))
    >>> fit = fit_positive(exact, intervals=16)
    >>> bool(abs(fit.y(0.55, 0.3) - 0.55 * 0.3) < 2e-3), bool((fit.masses >= 0).all())
    (True, True)
    """
    return _described(_posed(observations, intervals, nodes, smoothing, symmetric), observations.unit)


def fit_table(observations: Observations, smoothing: float | None = None) -> FodTable:
    """The hysteresis of ``fit_positive`` and nothing said about it; as coarse as can be where λ is known."""
    posed = _posed(observations, INTERVALS if smoothing else None, None, smoothing, symmetric=False)
    solution = posed.problem.solved(posed.smoothing)
    return posed.table(solution, _masses(solution, posed.scale), observations.unit)


@dataclass(frozen=True, eq=False)
class _Posed:
    """A problem with its λ, before anything is said of its solution."""

    problem: Problem
    every: Observations
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


def _posed(
    observations: Observations,
    intervals: int | None,
    nodes: ArrayLike | None,
    smoothing: float | None,
    symmetric: bool,
) -> _Posed:
    scale, zero = _scales(observations, smoothing)
    every = joined([observations, observations.mirrored()]) if symmetric else observations
    masks = _folds(observations, copies=2 if symmetric else 1)
    more = MORE if len(observations) > MANY else 1.0
    fine = intervals or int(INTERVALS * more)
    triangle = Triangle(adapted(observations, fine) if nodes is None else np.array(nodes, dtype=float))
    problem = Problem.of(triangle, every, scale, zero)
    by_smoothing: dict[float, float] = {}
    if smoothing is None and (masks or symmetric):
        coarse = adapted(observations, min(int(COARSE * more), fine))
        same = np.array_equal(coarse, triangle.nodes)
        rough = problem if same else Problem.of(Triangle(coarse), every, scale, zero)
        smoothing, errors = _smoothing(rough, masks, every, observations)
        by_smoothing = {k: scale * v for k, v in errors.items()}
    smoothing = smoothing or DEFAULT_SMOOTHING
    return _Posed(problem, every, masks, smoothing, by_smoothing, scale, zero, symmetric)


def _masses(solution: Solution, scale: float) -> Array:
    return scale * np.where(solution.s > _ZERO, solution.s, 0.0)


def _smoothing(
    problem: Problem, masks: list[NDArray[np.bool_]], every: Observations, observations: Observations
) -> tuple[float, dict[float, float]]:
    """λ by whole curves held out, or by stretches of symmetric loops too few for that."""
    if masks:
        return chosen(problem, masks, every.curve)
    parts = [np.tile(mask, 2) for mask in stretches(observations.curve)]
    return smoothest(problem, parts, every.curve)


def _scales(observations: Observations, smoothing: float | None) -> tuple[float, float]:
    if smoothing is not None and not (np.isfinite(smoothing) and smoothing > 0):
        raise UsageError(f"The smoothing is a positive number, not {smoothing:g}.")
    if len(observations) < 3:
        raise DataError(f"A measure cannot be fitted to {len(observations)} points; three are the least.")
    spread = float(np.ptp(observations.y))
    if not np.isfinite(spread) or spread == 0:
        raise DataError("The output is the same at every point: nothing moves, nothing to identify.")
    return spread, float(observations.y.min())


def _folds(observations: Observations, copies: int) -> list[NDArray[np.bool_]]:
    if np.unique(observations.curve).size < FEWEST_CURVES:
        return []
    return [np.tile(mask, copies) for mask in folds(observations.curve)]


def _described(posed: _Posed, unit: str) -> PositiveFit:
    problem, every, scale, smoothing = posed.problem, posed.every, posed.scale, posed.smoothing
    solution = problem.solved(smoothing)
    masses = _masses(solution, scale)
    residual = problem.rows @ solution.x - problem.y
    freedom = min(_freedom(problem, solution), 0.9 * problem.y.size)
    sigma = float(np.sqrt(residual @ residual / (problem.y.size - freedom)))
    seen = judged(problem, posed.masks, every.curve, smoothing, sigma)
    return PositiveFit(
        table=posed.table(solution, masses, unit),
        triangle=problem.triangle,
        masses=masses,
        smoothing=smoothing,
        by_smoothing=posed.by_smoothing,
        held_out=HeldOut(scale * seen.rms, scale * seen.signed_rms, seen.stretch, seen.curves),
        sigma=scale * sigma,
        rms=scale * float(np.sqrt(np.mean(residual**2))),
        freedom=freedom,
        null_space=problem.rows.get_shape()[1] - int(structural_rank(problem.rows)),
        points=problem.y.size,
        curves=int(np.unique(every.curve).size),
        symmetric=posed.symmetric,
        unit=unit,
        _solution=solution,
    )


def _freedom(problem: Problem, solution: Solution) -> float:
    """tr(X M⁻¹ Xᵀ)/m, the trace of the smoother on the constraints that hold."""
    m, n = problem.rows.get_shape()
    if m < n:
        return float(quadratic(solution.inverse, problem.rows, n).sum() / m)
    return float(np.trace(solution.inverse((problem.rows.T @ problem.rows).toarray()))) / m
