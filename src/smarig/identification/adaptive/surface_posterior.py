"""What is believed of the FOD surface, how wrong it may be, and what an observation would teach.

The density is a Gaussian process on the cells of a triangle, its standard deviation at each cell proportional
to the density that ``positive`` found around it: where there is much, there is much to be wrong about, and
where the measure is held at zero there is little. Correlation length and scale are those under which the
readings are most probable. Observations are rows over the unknowns of the triangle. Refuses to know plans.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve, cholesky, solve_triangular
from scipy.sparse import csr_matrix

from smarig.identification.positive.triangle import Triangle

Array = NDArray[np.float64]
LENGTHS = (0.07, 0.11, 0.17, 0.26)  # correlation lengths tried, parts of the range
BASE_DENSITY_SHARE = 0.2  # part of the mean density that is believed possible where none was found
_AROUND = 0.12  # part of the range over which the density found is averaged
_ROUNDING = 1e-10  # keeps readings of one memory from being singular
_GRID = 41  # inputs of the grid over which the error is averaged


@dataclass(frozen=True, eq=False)
class SurfacePosterior:
    """Covariance (n, n) of the triangle's unknowns, and the mean square error an observation sees of it.

    ``shared_reduction`` (n, n) is C W C, W the average over the triangle: x·shared·x / (x·C·x + noise²) is what an
    observation x takes off the mean variance. ``rms`` predicts the error of y(α, β). Outputs in counts.
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
    """The belief after readings ``change`` (m,), outputs above negative saturation, of ``rows`` (m, n).

    ``density`` (cells,) is the standard deviation of the density up to a factor; noise is of one reading.
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
    """Density (cells,) found around each cell, and everywhere at least a part of its mean; diagonal apart."""
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
    """(log likelihood, length, posterior covariance, stretch) of one correlation length.

    The scale of the prior is its most probable one; ``error_inflation`` is the rms of the readings' left-out errors in
    units of what was expected of them, where that is more than 1.
    """
    prior = _prior(triangle, density, length, noise)
    across = rows @ prior
    projected = np.asarray(rows @ across.T)
    projected += _ROUNDING * np.trace(projected) / change.size * np.eye(change.size)
    level = noise**2 * np.eye(change.size)
    scale = 1.0
    for _ in range(6):  # a fixed point: scale such that the readings are as large as expected
        factor = cho_factor(scale * projected + level, lower=True)
        scale *= float(change @ cho_solve(factor, change)) / change.size
    lower = cholesky(scale * projected + level, lower=True)
    whitened = solve_triangular(lower, change, lower=True)
    likelihood = -0.5 * float(whitened @ whitened) - float(np.log(np.diag(lower)).sum())
    half = solve_triangular(lower, scale * across, lower=True)
    inverse = cho_solve((lower, True), np.eye(change.size))
    left_out = (inverse @ change) / np.sqrt(np.diag(inverse))
    error_inflation = max(1.0, float(np.sqrt(np.mean(left_out**2))))
    return likelihood, length, scale * prior - half.T @ half, error_inflation


def _prior(triangle: Triangle, density: Array, length: float, noise: float) -> Array:
    """Covariance (n, n) of the unknowns: Matérn-3/2 densities on the cells, summed up; y₋ known to a reading."""
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
    """α and β of the cells' centres, scaled to [0, 1], and which cells lie on the diagonal."""
    x = triangle.scaled(triangle.nodes)
    middle = (x[1:] + x[:-1]) / 2
    return middle[triangle.i], middle[triangle.j], triangle.i == triangle.j


def reading_noise_sd(counts_sd: Iterable[float], n: Iterable[int]) -> float:
    """Standard uncertainty, in counts, of a typical window mean; without dither, that of a whole count."""
    sd, size = np.array(list(counts_sd), dtype=float), np.maximum(np.array(list(n), dtype=float), 1.0)
    squares = sd**2 / size + np.where(sd < 0.3, 1 / 12, 0.0)
    return float(np.sqrt(np.median(squares)))
