"""Any smooth density at all: the covariance of outputs when nothing is known of μ but that it is smooth.

    y = X w + S e,    w ~ N(0, v (R + A)⁻¹),    R = ∬ (second derivatives of the density)²,    A = ∬ density²
                      e ~ N(0, g ν)             ν the mass of a cell as believed: grains, each cell for itself

X are the rows of the FOD surface at the corners of each memory, on a triangle of cells; R and A are taken on a scale
on which the output moves evenly, so a steep transformation may be as structured as a flat tail. Knows no data but
where the memories lie and where the output moves.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from scipy.linalg import cho_solve_banded, cholesky_banded
from scipy.sparse import csr_matrix, triu

from smarig.identification.positive.observations import COMMON, Observations, corners_of
from smarig.identification.positive.partition import SAME, adapted
from smarig.identification.positive.triangle import Triangle
from smarig.preisach.everett import Everett
from smarig.preisach.operator import State
from smarig.story.retelling import Retelling

Array = NDArray[np.float64]
FEWEST, MOST = 96, 160  # intervals of the partition: enough for every measured level to be a node
EVEN = 0.5  # share of the scale that is plain input
KNOTS = 11
FAINT = 0.01  # of the mean mass: grains where the model has nothing
_RIDGE = 1e-14  # of the precision's mean, against rounding


def free_density(told: Retelling, hysteresis: Everett, path: Array, y: Array) -> tuple[Array, Array]:
    """Covariances (n, n) of the outputs at n memories, without a common zero: smooth for v = 1, grains for g = 1.

    ``path`` (m,) is the output along the retelling's ticks; ``y`` (n,) a guess of the outputs, to place cells.
    """
    lower, upper = hysteresis.lower, hysteresis.upper
    rows = observed(told.states, lower, upper, y)
    nodes = adapted(rows, _enough(rows, upper - lower))
    triangle = Triangle(nodes, _even(nodes, told.felt_K, path))
    X = csr_matrix(rows.matrix(triangle)[:, : triangle.unknowns - 1])  # without y₋, the common zero
    density = csr_matrix(triangle.masses.multiply(1 / triangle.areas[:, None]))
    square = density.T @ csr_matrix(density.multiply(triangle.areas[:, None]))
    smooth = _covariance(csr_matrix((triangle.roughness + square)[:-1, :-1]), X)
    signs = _switched(triangle, X) * np.sqrt(_believed(triangle, hysteresis))
    return smooth, signs @ signs.T


def _covariance(precision: csr_matrix, X: csr_matrix) -> Array:
    """X P⁻¹ Xᵀ for a precision whose neighbours are near in number."""
    upper = triu(precision).tocoo()
    banded = np.zeros((int((upper.col - upper.row).max()) + 1, precision.shape[0]))
    banded[upper.col - upper.row, upper.row] = upper.data  # lower form: P is symmetric
    banded[0] += _RIDGE * float(banded[0].mean())
    root = cholesky_banded(banded, lower=True, check_finite=False, overwrite_ab=True)
    covariance = X @ cho_solve_banded((root, True), X.toarray().T, check_finite=False)
    return (covariance + covariance.T) / 2


def _enough(rows: Observations, span: float) -> int:
    """Intervals for which ``adapted`` keeps the levels of the data."""
    levels = np.unique(np.round(np.concatenate([rows.alpha, rows.beta]) / (SAME * span)))
    return int(np.clip(2 * levels.size + 6, FEWEST, MOST))


def _switched(triangle: Triangle, X: csr_matrix) -> Array:
    """Which share of each cell is switched on at each memory, (n, cells)."""
    n = triangle.nodes.size - 1
    grid = np.zeros((X.shape[0], n, n))
    grid[:, triangle.i, triangle.j] = X.toarray()
    above = np.cumsum(np.cumsum(grid[:, ::-1, ::-1], axis=1), axis=2)[:, ::-1, ::-1]
    return above[:, triangle.i, triangle.j]


def _believed(triangle: Triangle, hysteresis: Everett) -> Array:
    """The mass of each cell as the model has it, in strokes (cells,), none quite empty."""
    a, b = np.meshgrid(triangle.nodes, triangle.nodes, indexing="ij")
    E = np.array([[hysteresis.everett(x, min(y, x)) for x, y in zip(p, q)] for p, q in zip(a, b)])
    i, j = triangle.i, triangle.j
    upper, right = E[i + 1, j], E[i, j]
    mass = np.abs(upper - right - np.where(i == j, 0.0, E[i + 1, j + 1] - E[i, np.minimum(j + 1, i)]))
    return (mass + FAINT * mass.mean()) / (mass.sum() or 1.0)


def observed(states: Sequence[State], lower: float, upper: float, y: Array) -> Observations:
    """Outputs y (n,) at memories as sums over the FOD surface; curves are not told apart."""
    terms: list[tuple[int, float, float, float]] = []
    released: list[tuple[int, float, float, float]] = []
    for k, state in enumerate(states):
        corners, diagonal = corners_of(state, lower)
        terms += [(k, *corner) for corner in corners]
        released += [(k, *move) for move in diagonal]
    table = np.array(terms, dtype=float).reshape(len(terms), 4)
    return Observations(
        y,
        np.zeros(y.size, dtype=np.int64),
        np.full(y.size, COMMON),
        table[:, 0].astype(np.int64),
        table[:, 1],
        table[:, 2],
        table[:, 3],
        tuple(released),
        lower,
        upper,
    )


def _even(nodes: Array, felt: Array, output: Array) -> Array:
    """Nodes on a scale [0, 1]: half by input, half by how much of all motion lies below, smoothly."""
    lower, upper = nodes[0], nodes[-1]
    edges = np.linspace(lower, upper, 41)
    middle, change = np.clip((felt[1:] + felt[:-1]) / 2, lower, upper), np.abs(np.diff(output))
    below = np.concatenate([[0.0], np.cumsum(np.histogram(middle, edges, weights=change)[0])])
    knots = np.linspace(lower, upper, KNOTS)
    share = np.interp(knots, edges, below / below[-1]) if below[-1] else np.linspace(0, 1, KNOTS)
    place = PchipInterpolator(knots, EVEN * np.linspace(0, 1, KNOTS) + (1 - EVEN) * share)(nodes)
    return np.asarray(place, dtype=float)
