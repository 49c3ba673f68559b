"""Random wires with a hysteresis outside every surface family, from a fixed, published generator.

A truth is a positive measure on the triangle β ≤ α. It consists of Gaussians with random orientation, one
feature that is lognormal in the half width (α − β)/2 and normal in the centre (α + β)/2, and a reversible
part g that varies along the diagonal. No exponential of §5.4 and no constant density can represent it.
"""

import numpy as np
from numpy.typing import NDArray

from smarig.preisach import FodTable
from smarig.protocols import Setup

Array = NDArray[np.float64]
CELLS = 233  # prime, so that no partition of a fit coincides with that of the truth


def random_truth(seed: int, rig: str = "one_wire_twin", *, cells: int = CELLS) -> FodTable:
    """A random hysteresis with a rig's ranges of input and output. A seed always gives the same truth.

    ν = (1 − r) Σ w_k ρ_k/∬ρ_k + r g/∫g over the rig's output range: 2 to 4 Gaussians and one lognormal
    feature ρ_k with random weights w_k, and a reversible share r of 3 to 15 %. Its density is constant on
    each of the ``cells``² / 2 cells, so a twin's output is exact.

    >>> truth = random_truth(1)
    >>> truth.lower, truth.upper, round(truth.everett(truth.upper, truth.lower), 2)
    (0.0, 174.1, 12.54)
    >>> bool(np.diff(truth.values[-1]).min() > 0)
    True
    """
    setup = Setup.of(rig)
    nominal = setup.actuator.hysteresis
    masses = setup.actuator.stroke * _shares(np.random.default_rng([seed, 1997]), cells)
    grid = np.zeros((cells + 1, cells + 1))
    grid[1:, 1:] = masses
    values = nominal.y_lower + np.cumsum(np.cumsum(grid, axis=0), axis=1)
    nodes = np.linspace(setup.lower_K, setup.upper_K, cells + 1)
    return FodTable(nodes, np.where(np.tri(cells + 1, dtype=bool), values, np.nan), setup.actuator.unit)


def _shares(rng: np.random.Generator, cells: int) -> Array:
    """Share of the output range in each cell (α, β), (cells, cells), zero above the diagonal; sum 1."""
    middle = (np.arange(cells) + 0.5) / cells
    alpha, beta = middle[:, None], middle[None, :]
    area = np.tri(cells) - 0.5 * np.eye(cells)  # half of a cell on the diagonal lies below it
    parts = [_gaussian(rng, alpha, beta) for _ in range(rng.integers(2, 5))]
    parts.append(_lognormal(rng, alpha, beta))
    weights = rng.dirichlet(np.full(len(parts), 2.0))
    irreversible = sum(w * part * area / np.sum(part * area) for w, part in zip(weights, parts))
    g = 0.3 + np.exp(-0.5 * ((middle - rng.uniform(0.1, 0.9)) / rng.uniform(0.1, 0.3)) ** 2)
    share = rng.uniform(0.03, 0.15)
    return (1 - share) * irreversible + share * np.diag(g / g.sum())


def _gaussian(rng: np.random.Generator, alpha: Array, beta: Array) -> Array:
    """exp(−(p²/s² + q²/t²)/2), with p and q along axes of random orientation; centred inside the triangle."""
    at = rng.uniform(0.25, 0.95)
    da, db = alpha - at, beta - rng.uniform(0.05, at - 0.1)
    angle = rng.uniform(0.0, np.pi)
    p, q = da * np.cos(angle) + db * np.sin(angle), db * np.cos(angle) - da * np.sin(angle)
    s, t = np.exp(rng.uniform(np.log(0.06), np.log(0.3), 2))
    return np.exp(-0.5 * ((p / s) ** 2 + (q / t) ** 2))


def _lognormal(rng: np.random.Generator, alpha: Array, beta: Array) -> Array:
    """exp(−ln²(b/m)/2s²) exp(−(c − c₀)²/2w²), b = (α − β)/2 and c = (α + β)/2."""
    half = np.maximum(alpha - beta, 1e-12) / 2
    coercivity = np.log(half / rng.uniform(0.05, 0.3)) / rng.uniform(0.3, 0.7)
    interaction = ((alpha + beta) / 2 - rng.uniform(0.3, 0.7)) / rng.uniform(0.08, 0.3)
    return np.exp(-0.5 * (coercivity**2 + interaction**2))
