"""Any smooth density at all: the covariance of outputs when nothing is known of μ but that it is smooth.

    y = X w,    w ~ N(0, v (R + A)⁻¹),    R = ∬ (second derivatives of the density)²,    A = ∬ density²

X are the rows of the FOD surface at the corners of each memory, on a triangle of cells; R and A are taken on a scale
on which the output moves evenly, so a steep transformation may be as structured as a flat tail. Knows no data but
where the memories lie and where the output moves.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from scipy.linalg import cholesky, solve_triangular
from scipy.sparse import csr_matrix

from smarig.diagnosis.retelling import Retelling
from smarig.identification.positive.observations import COMMON, Observations, corners_of
from smarig.identification.positive.partition import adapted
from smarig.identification.positive.triangle import Triangle
from smarig.preisach.everett import Everett

Array = NDArray[np.float64]
INTERVALS = 64
EVEN = 0.5  # share of the scale that is plain input
KNOTS = 11
_RIDGE = 1e-14  # of the precision's mean, against rounding


def free_density(told: Retelling, hysteresis: Everett, path: Array, y: Array) -> Array:
    """Covariance (n, n) for v = 1 of the outputs at n memories, without a common zero.

    ``path`` (m,) is the output along the retelling's ticks; ``y`` (n,) a guess of the outputs, to place cells.
    """
    lower, upper = hysteresis.lower, hysteresis.upper
    rows = _rows(told, lower, upper, y)
    nodes = adapted(rows, INTERVALS)
    triangle = Triangle(nodes, _even(nodes, told.felt_K, path))
    X = rows.matrix(triangle)[:, : triangle.unknowns - 1]  # without y₋, the common zero
    density = csr_matrix(triangle.masses.multiply(1 / triangle.areas[:, None]))
    square = density.T @ csr_matrix(density.multiply(triangle.areas[:, None]))
    precision = (triangle.roughness + square).toarray()[:-1, :-1]
    precision[np.diag_indices_from(precision)] += _RIDGE * float(np.trace(precision)) / len(precision)
    root = cholesky(precision, lower=True, check_finite=False)
    half = solve_triangular(root, X.toarray().T, lower=True, check_finite=False)
    return half.T @ half  # a square, so that rounding leaves it one


def _rows(told: Retelling, lower: float, upper: float, y: Array) -> Observations:
    """The memories as sums over the FOD surface; curves do not matter here."""
    terms: list[tuple[int, float, float, float]] = []
    released: list[tuple[int, float, float, float]] = []
    for k, state in enumerate(told.states):
        corners, diagonal = corners_of(state, lower)
        terms += [(k, *corner) for corner in corners]
        released += [(k, *move) for move in diagonal]
    table = np.array(terms, dtype=float).reshape(len(terms), 4)
    names = table[:, 0].astype(np.int64)
    common = np.full(y.size, COMMON)
    return Observations(
        y,
        np.zeros(y.size, dtype=np.int64),
        common,
        names,
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
