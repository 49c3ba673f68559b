"""The Preisach plane: the boundary, and the density μ as an image.

The abscissa is β, the ordinate α. Relays lie above the line α = β.
"""

import numpy as np
from numpy.typing import NDArray

from smarig.live.colours import GROUND, Colour, blend
from smarig.live.primitives import Array
from smarig.preisach import Everett, State
from smarig.theory import staircase_points

CELLS = 96
POSITIVE: Colour = (203, 84, 84)
NEGATIVE: Colour = (74, 140, 207)
MAX_SHADE = 0.98  # quantile of |μ| with the full colour, so that single ridges do not darken the rest


def boundary(state: State, lower: float, upper: float) -> Array:
    """Corners (n, 2) of the boundary, (β, α), from the edge of the plane to the present input (u, u).

    >>> from smarig.preisach import Preisach
    >>> from smarig.preisach import RelayMeasure
    >>> memory = Preisach(RelayMeasure.zero(0.0, 100.0))
    >>> for u in (80.0, 20.0, 60.0):
    ...     _ = memory.step(u)
    >>> boundary(memory.state, 0.0, 100.0).tolist()
    [[0.0, 80.0], [20.0, 80.0], [20.0, 60.0], [60.0, 60.0]]
    """
    clipped = [min(max(u, lower), upper) for u in (*state.extrema, state.u)]
    path = [u for k, u in enumerate(clipped) if k == 0 or u != clipped[k - 1]]
    if not state.diagonal:
        return np.array(staircase_points(path), dtype=float)
    centre = path[0]
    enters = max(lower, 2 * centre - upper)
    start = (enters, 2 * centre - enters)
    if len(path) == 1:
        return np.array([start, (centre, centre)])
    first = path[1]
    leaves = (2 * centre - first, first) if first > centre else (first, 2 * centre - first)
    return np.array([start, leaves, *staircase_points(path[1:])])


def density(hysteresis: Everett, cells: int = CELLS) -> Array:
    """Mean of μ in each cell (row α, column β), NaN below the diagonal: μ = −½ ∂²F/∂α∂β."""
    edges = np.linspace(hysteresis.lower, hysteresis.upper, cells + 1)
    alpha, beta = np.meshgrid(edges, edges, indexing="ij")
    F = np.asarray(hysteresis.swept(np.maximum(alpha, beta), beta), dtype=float)
    mass = 0.5 * (F[1:, :-1] - F[:-1, :-1] - F[1:, 1:] + F[:-1, 1:])
    mass[np.triu_indices(cells, 0)] = (
        np.nan
    )  # cells on the diagonal hold the reversible part, which is not part of the density
    return mass / (edges[1] - edges[0]) ** 2


def density_image(mu: Array) -> NDArray[np.uint8]:
    """The density as an image: red positive, blue negative, darker if weaker; background where there are no
    relays."""
    finite = np.isfinite(mu)
    top = float(np.quantile(np.abs(mu[finite]), MAX_SHADE)) if finite.any() else 0.0
    pixels = np.full((*mu.shape, 3), GROUND, np.uint8)
    for i, j in np.argwhere(finite):
        share = float(mu[i, j]) / top if top > 0 else 0.0
        hue = blend(GROUND, POSITIVE if share > 0 else NEGATIVE, abs(share))
        pixels[i, j] = hue
    return pixels
