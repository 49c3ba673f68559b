"""The posterior of the FOD surface: its uncertainty, and the information of an observation.

The density is a Gaussian process on the cells of a triangle. Its standard deviation at each cell is proportional to
the density that ``positive`` found around the cell, because a large density can be wrong by more. Correlation
length and scale are those of largest likelihood of the readings. Observations are rows over the unknowns of the
triangle.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve, cholesky, solve_triangular
from scipy.sparse import csr_matrix

from smarig.core import Array, root_mean_square
from smarig.identification.positive.triangle import Triangle

LENGTHS = (0.07, 0.11, 0.17, 0.26)  # correlation lengths tried, as shares of the range
BASE_DENSITY_SHARE = 0.2  # share of the mean density that is the prior sd where none was found
_AROUND = 0.12  # share of the range over which the density is averaged
_ROUNDING = 1e-10  # regularises repeated readings of one memory
_GRID = 41  # inputs of the grid over which the error is averaged


@dataclass(frozen=True, eq=False)
class SurfacePosterior:
    """Covariance (n, n) of the triangle's unknowns, and the reduction of the mean variance by observations.

    ``shared_reduction`` (n, n) is C W C, with W the average over the triangle: x·shared·x / (x·C·x + noise²) is the
    reduction of the mean variance by an observation x. ``rms`` predicts the error of y(α, β). Outputs are in
    counts.
    """

    triangle: Triangle
    covariance: Array
    shared_reduction: Array
    noise: float
    rms: float
    length: float


def surface_posterior(
    triangle: Triangle, density: Array, rows: csr_matrix, change: Array, noise: float
) -> SurfacePosterior:
    """The posterior after readings ``change`` (m,), outputs above negative saturation, of ``rows`` (m, n).

    ``density`` (cells,) is the standard deviation of the density up to a factor. ``noise`` is that of one reading.
    """
    candidates = (_conditioned(triangle, density, length, rows, change, noise) for length in LENGTHS)
    _, length, covariance, error_inflation = max(candidates, key=lambda found: found[0])
    u = np.linspace(triangle.nodes[0], triangle.nodes[-1], _GRID)
    high, low = np.tril_indices(_GRID)
    grid = triangle.values(u[high], u[low])
    projected = grid @ covariance
    mean_square = max(0.0, float(np.asarray(grid.multiply(projected).sum()))) / high.size
    shared_reduction = projected.T @ projected / high.size
    return SurfacePosterior(
        triangle, covariance, shared_reduction, noise, error_inflation * float(np.sqrt(mean_square)), length
    )


def density_amplitude(triangle: Triangle, masses: Array) -> Array:
    """Mean density (cells,) around each cell, at least a share of its overall mean; diagonal cells separately."""
    alpha, beta, on = _centres(triangle)
    around = np.exp(-0.5 * ((alpha[:, None] - alpha) ** 2 + (beta[:, None] - beta) ** 2) / _AROUND**2)
    around *= on[:, None] == on
    local = (around @ masses) / (around @ triangle.areas)
    for part in (on, ~on):
        local[part] += BASE_DENSITY_SHARE * masses[part].sum() / triangle.areas[part].sum()
    return local


def _conditioned(
    triangle: Triangle, density: Array, length: float, rows: csr_matrix, change: Array, noise: float
) -> tuple[float, float, Array, float]:
    """(log likelihood, length, posterior covariance, error inflation) of one correlation length.

    The scale of the prior is its most probable one. ``error_inflation`` is the rms of the leave-one-out errors in
    units of their expected size, if that is more than 1.
    """
    prior = _prior(triangle, density, length, noise)
    across = rows @ prior
    projected = np.asarray(rows @ across.T)
    projected += _ROUNDING * np.trace(projected) / change.size * np.eye(change.size)
    level = noise**2 * np.eye(change.size)
    scale = 1.0
    for _ in range(6):  # fixed point: the scale for which the readings have their expected size
        factor = cho_factor(scale * projected + level, lower=True)
        scale *= float(change @ cho_solve(factor, change)) / change.size
    lower = cholesky(scale * projected + level, lower=True)
    whitened = solve_triangular(lower, change, lower=True)
    likelihood = -0.5 * float(whitened @ whitened) - float(np.log(np.diag(lower)).sum())
    half = solve_triangular(lower, scale * across, lower=True)
    inverse = cho_solve((lower, True), np.eye(change.size))
    left_out = (inverse @ change) / np.sqrt(np.diag(inverse))
    error_inflation = max(1.0, root_mean_square(left_out))
    return likelihood, length, scale * prior - half.T @ half, error_inflation


def _prior(triangle: Triangle, density: Array, length: float, noise: float) -> Array:
    """Covariance (n, n) of the unknowns: Matérn-3/2 densities on the cells, summed; y₋ known to the noise of a
    reading.
    """
    alpha, beta, on = _centres(triangle)
    far = np.sqrt(3.0) * np.hypot(alpha[:, None] - alpha, beta[:, None] - beta) / length
    spread = density * triangle.areas
    masses = (1 + far) * np.exp(-far) * (on[:, None] == on) * spread[:, None] * spread
    once = _summed(triangle, masses)
    covariance = np.full((triangle.unknowns,) * 2, noise**2)
    covariance[:-1, :-1] += _summed(triangle, once.T)
    return covariance


def _summed(triangle: Triangle, columns: Array) -> Array:
    """Surface above y₋ at the nodes, for each column of cell masses (cells, k): sums over the cells below."""
    n = triangle.nodes.size - 1
    grid = np.zeros((n, n, columns.shape[1]))
    grid[triangle.i, triangle.j] = columns
    return grid.cumsum(axis=0).cumsum(axis=1)[triangle.i, triangle.j]


def _centres(triangle: Triangle) -> tuple[Array, Array, NDArray[np.bool_]]:
    """α and β of the cells' centres, scaled to [0, 1], and the mask of diagonal cells."""
    x = triangle.scaled(triangle.nodes)
    middle = (x[1:] + x[:-1]) / 2
    return middle[triangle.i], middle[triangle.j], triangle.i == triangle.j


def reading_noise_sd(counts_sd: Iterable[float], n: Iterable[int]) -> float:
    """Standard uncertainty, in counts, of a typical window mean; without dither, that of one count."""
    sd, size = np.array(list(counts_sd), dtype=float), np.maximum(np.array(list(n), dtype=float), 1.0)
    squares = sd**2 / size + np.where(sd < 0.3, 1 / 12, 0.0)
    return float(np.sqrt(np.median(squares)))
