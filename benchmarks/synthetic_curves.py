"""The fixed, published synthetic reversal curves on which density estimators are compared.

The truth is a positive density on the triangle −1 ≤ β ≤ α ≤ 1 with two features, a broad and a narrow one.
Each is a lognormal law of the half width b = (α − β)/2 times a normal law of the centre c = (α + β)/2. The
output at the nodes is its exact integral (Gauss-Legendre in every cell), so nothing is differentiated.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
NODES = 101
_ORDER = 12  # Gauss-Legendre points along one side of a cell


@dataclass(frozen=True)
class Feature:
    """One feature of the density: ``amplitude``·exp(−ln²(b/median)/2s²)·exp(−(c − centre)²/2width²)."""

    amplitude: float
    median: float
    s: float
    centre: float
    width: float

    def __call__(self, half_width: Array, centre: Array) -> Array:
        """The feature at half widths b > 0 and centres c."""
        coercivity = np.log(half_width / self.median) / self.s
        interaction = (centre - self.centre) / self.width
        return self.amplitude * np.exp(-0.5 * (coercivity**2 + interaction**2))


FEATURES = (
    Feature(1.0, 0.50, 0.55, 0.00, 0.37),
    Feature(0.7, 0.43, 0.32, -0.10, 0.22),
)
"""A broad and a narrow feature. They are published; other values are another benchmark."""


def truth_density(alpha: ArrayLike, beta: ArrayLike) -> Array:
    """μ(α, β) ≥ 0 in output per input², 0 on the diagonal and NaN above it (β > α)."""
    a, b = np.broadcast_arrays(np.asarray(alpha, dtype=float), np.asarray(beta, dtype=float))
    inside = a > b
    half_width = np.where(inside, (a - b) / 2, 1.0)
    mu = np.sum([feature(half_width, (a + b) / 2) for feature in FEATURES], axis=0)
    return np.where(inside, mu, np.where(a == b, 0.0, np.nan))


@cache
def _exact(nodes: int) -> tuple[Array, Array, Array]:
    """α, β and y (k,) of every node of the triangle, curve by curve, falling; read-only."""
    u = np.linspace(-1.0, 1.0, nodes)
    F = 2 * _corner_integrals(u)
    i, j = (k[::-1] for k in np.tril_indices(nodes))
    order = np.lexsort((-j, i))
    i, j = i[order], j[order]
    y = F[i, 0] - F[i, j] - F[-1, 0] / 2
    for array in (alpha := u[i], beta := u[j], y):
        array.flags.writeable = False
    return alpha, beta, y


def _corner_integrals(u: Array) -> Array:
    """∬μ over the triangle with corner (α_i, β_j), for all nodes (n, n)."""
    x, w = np.polynomial.legendre.leggauss(_ORDER)
    x, w = (x + 1) / 2, w / 2
    step = np.diff(u)
    a = u[:-1, None] + step[:, None] * x  # (cells, order)
    mass = np.zeros((step.size, step.size))
    for row, rising in enumerate(a):  # all cells at once would take 80 MB
        square = np.nan_to_num(truth_density(rising[None, :, None], a[:, None, :]))
        mass[row] = np.einsum("jpq,p,q->j", square, w, w) * step[row] * step
    # On the diagonal the cell is half a square: α = lower + h t, β = lower + h t v, with Jacobian h² t.
    lower = u[:-1, None, None]
    h = step[:, None, None]
    triangle = truth_density(lower + h * x[:, None], lower + h * x[:, None] * x)
    mass[np.arange(step.size), np.arange(step.size)] = step**2 * np.einsum("ipq,p,q->i", triangle, w * x, w)
    total = np.zeros((u.size, u.size))
    total[1:, :-1] = np.cumsum(np.cumsum(np.tril(mass), axis=0)[:, ::-1], axis=1)[:, ::-1]
    return total


def curves(noise: float = 0.0, seed: int = 0, nodes: int = NODES) -> tuple[Array, Array, Array]:
    """α, β, y (k,) of the curves falling from every node α of [−1, 1]; k = nodes·(nodes + 1)/2.

    y(α, β) = −Y + 2∬_{α' ≤ α} μ − 2∬_{β ≤ β' ≤ α' ≤ α} μ [(3.2), (3.5)], plus normal noise whose standard
    deviation is ``noise`` times the output Y of saturation. A seed always gives the same noise.
    """
    alpha, beta, y = _exact(nodes)
    sd = noise * (y.max() - y.min()) / 2
    return alpha, beta, y + sd * np.random.default_rng(seed).standard_normal(y.size)
