"""The prior of the density: covariance of the outputs if μ deviates in proportion to itself.

    μ = m Σ_s ε_s + grains,    m: μ₀ smoothed
                               ε_s: bilinear on a grid of s intervals, independent standard normal at its nodes
                               grains: each cell for itself, variance g m, as of a finite number of relays

The cells are a triangle on a scale on which the output moves evenly, so that a steep transformation may have as
much structure as a flat tail.
"""

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.sparse import csr_matrix

from smarig.core import Array
from smarig.identification import SAME_LEVEL, Observations, Triangle, adapted_nodes
from smarig.preisach import Everett
from smarig.replay import Prediction

MIN_INTERVALS, MAX_INTERVALS = 200, 240  # of the partition: every measured level can be a node
LEVEL_SHARE = 0.5  # share of the levels in the scale
KNOTS = 11
HAT_INTERVALS = (6, 20)  # hats across the range: resolution of the proportional deviations
SMOOTHING = 0.01  # of the even scale: a prior as rough as its density would confirm what that has taken up
SHARED_PRIORS = 8  # number of cached priors: their covariances are large
MIN_PRIOR_SHARE = 0.05  # of the mean mass: prior scale where the model has no mass


@dataclass(frozen=True, eq=False)
class DensityPrior:
    """Cells of a triangle with prior masses (cells,) in strokes, and rows X (n, cells) of its unknowns for the
    observations.

    ``prior_scale`` (cells,) scales the deviations: as smooth as products of two ``hats`` (N, s + 1), with one array
    for each scale of smoothness, then grains of variance ``prior_scale``. ``whole``: the prior whose first rows
    these are.
    """

    triangle: Triangle
    rows: csr_matrix
    mass: Array
    prior_scale: Array
    hats: tuple[Array, ...]
    whole: "DensityPrior | None" = None

    @cached_property
    def covariances(self) -> tuple[Array, ...]:
        """Covariances (n, n) of the outputs at the memories, in strokes², without a common zero: by scale, then
        grains.
        """
        if self.whole is not None:
            n = self.rows.get_shape()[0]
            return tuple(c[:n, :n] for c in self.whole.covariances)
        shapes = [self._hat_responses(hats) for hats in self.hats]
        return (*(shape @ shape.T for shape in shapes), self._grains())

    @property
    def bare(self) -> "DensityPrior":
        """The same without covariances that were computed: they are large."""
        return replace(self, whole=None)

    def first(self, n: int) -> "DensityPrior":
        """The same at the first n memories."""
        return replace(self, rows=csr_matrix(self.rows[:n]), whole=self)

    def _hat_responses(self, hats: Array) -> Array:
        """Outputs (n, products) of the prior masses times each product of two hats.

        Sums over β up to each level that is used, then over α; a hat is narrow, so only its own cells are summed.
        """
        used = np.unique(self.rows.indices)
        alphas, i = np.unique(self.triangle.i[used], return_inverse=True)
        betas, j = np.unique(self.triangle.j[used], return_inverse=True)
        up_to = np.tri(len(hats))  # (cells, cells): which cells lie below each
        over_beta = (up_to[betas].T[:, :, None] * hats[:, None, :]).reshape(len(hats), -1)
        across = _grid(self.triangle, self.prior_scale) @ over_beta
        across = across.reshape(len(hats), betas.size, -1)  # (α, β, hat over β)
        sums = []
        for a, hat in enumerate(hats.T):
            own = np.flatnonzero(hat)  # none, if the hat lies between two cells
            parts = across[own, :, : a + 1].reshape(own.size, betas.size * (a + 1))
            sums.append(
                ((up_to[alphas][:, own] * hat[own]) @ parts).reshape(alphas.size, betas.size, a + 1)[i, j]
            )
        return np.asarray(csr_matrix(self.rows[:, used]) @ np.concatenate(sums, axis=1))

    def _grains(self) -> Array:
        """Covariance by grains: two outputs share the grains of the cells that lie below both."""
        used = np.unique(self.rows.indices)
        i, j = self.triangle.i[used], self.triangle.j[used]
        total = np.cumsum(np.cumsum(_grid(self.triangle, self.prior_scale), axis=0), axis=1)
        shared = total[np.minimum(i[:, None], i), np.minimum(j[:, None], j)]
        rows = self.rows[:, used].toarray()  # few cells, and each in many rows
        return np.asarray(rows @ shared @ rows.T)

    def outputs(self, mass: Array) -> Array:
        """Outputs (n,) at the memories, in strokes, of masses (cells,)."""
        return np.asarray(self.rows @ _below(self.triangle, mass)).ravel()

    def posterior_masses(self, variances: Array, dual_weights: Array, mass: Array | None = None) -> Array:
        """Masses (cells,) ≥ 0 in strokes: the posterior mean for variances of the parts and ``dual_weights`` (n,) =
        C⁻¹y.

        The deviations are from the prior masses or from others. Masses that are negative there may stay so.
        """
        start_mass = self.mass if mass is None else mass
        adjoint = _grid(self.triangle, self.rows.T @ dual_weights)[::-1, ::-1]
        cells = _of_cells(self.triangle, np.cumsum(np.cumsum(adjoint, axis=0), axis=1)[::-1, ::-1])
        weighted_cells = _grid(self.triangle, self.prior_scale * cells)
        increments = [
            w
            * self.prior_scale
            * _of_cells(self.triangle, hats @ np.tril(hats.T @ weighted_cells @ hats) @ hats.T)
            for w, hats in zip(variances, self.hats)
        ]
        grains = variances[len(self.hats)] * self.prior_scale * cells
        masses = start_mass + np.sum(increments, axis=0) + grains
        return np.maximum(masses, np.minimum(self.mass, 0.0))


def density_prior(prediction: Prediction, hysteresis: Everett, smoothing: float = SMOOTHING) -> DensityPrior:
    """The prior about a hysteresis along a prediction, whose outputs place the cells if the hysteresis has none.

    ``smoothing`` 0: the density deviates in proportion to itself, as rough as it is.
    """
    return _cached_prior(_SharedPath(prediction), hysteresis, smoothing)


@dataclass(frozen=True, eq=False)
class _SharedPath:
    """A prediction that equals others of the same memories and outputs: effects after the hysteresis share a prior."""

    prediction: Prediction

    @cached_property
    def _key(self) -> tuple[object, ...]:
        p = self.prediction
        settled = p.of("settled") if "settled" in p.values else None
        arrays = (p.output, p.tick_index, p.hysteresis_input_K)
        return settled, p.states, *(a.tobytes() for a in arrays)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _SharedPath) and self._key == other._key

    def __hash__(self) -> int:
        return hash(self.prediction.output.tobytes())


@lru_cache(maxsize=SHARED_PRIORS)
def _cached_prior(path: _SharedPath, hysteresis: Everett, smoothing: float) -> DensityPrior:
    prediction = path.prediction
    y = prediction.output
    lower, upper = hysteresis.lower, hysteresis.upper
    rows = Observations.of_states(prediction.states, y, np.zeros(y.size, dtype=np.int64), (lower, upper))
    nodes = _nodes(hysteresis, rows, np.array([s.extrema[-1] for s in prediction.states]))
    triangle = Triangle(nodes, _even_scale(nodes, prediction))
    X = csr_matrix(rows.matrix(triangle).tocsc()[:, : triangle.unknowns - 1])  # without y₋, the common zero
    mass = _model_masses(triangle, hysteresis)
    prior_scale = _smoothed(triangle, np.abs(mass), smoothing)
    prior_scale /= prior_scale.sum() or 1.0
    prior_scale += MIN_PRIOR_SHARE * prior_scale.mean()
    hats = tuple(_hats(triangle, n) for n in HAT_INTERVALS)
    return DensityPrior(triangle, X, _smoothed(triangle, mass, smoothing), prior_scale, hats)


def _grid(triangle: Triangle, values: Array) -> Array:
    """Values of cells (cells,) on the square of α and β, (N, N)."""
    n = triangle.nodes.size - 1
    grid = np.zeros(n * n)
    grid[triangle.i * n + triangle.j] = values
    return grid.reshape(n, n)


def _of_cells(triangle: Triangle, grid: Array) -> Array:
    """The values of the cells (cells,) on the square."""
    return grid.ravel().take(triangle.i * grid.shape[1] + triangle.j)


def _below(triangle: Triangle, mass: Array) -> Array:
    """Sums over the cells with α and β up to those of each cell, (cells,): the FOD surface of a mass."""
    return _of_cells(triangle, np.cumsum(np.cumsum(_grid(triangle, mass), axis=0), axis=1))


def _hats(triangle: Triangle, n: int) -> Array:
    """Hats on a grid of n intervals of the even scale, at the centres of cells: (N, n + 1)."""
    place = _node_positions(triangle)
    middle = (place[1:] + place[:-1]) / 2
    return np.maximum(0.0, 1 - n * np.abs(middle[:, None] - np.linspace(0, 1, n + 1)))


def _node_positions(triangle: Triangle) -> Array:
    span = triangle.nodes[-1] - triangle.nodes[0]
    return (triangle.nodes - triangle.nodes[0]) / span if triangle.place is None else triangle.place


def _nodes(hysteresis: Everett, rows: Observations, extrema: Array) -> Array:
    """The nodes of the density itself if it has enough: on others it would be another density; else adapted ones."""
    own = np.asarray(getattr(hysteresis, "kinks", ()))
    if own.size > MIN_INTERVALS:
        return own
    return adapted_nodes(rows, _interval_count(rows, hysteresis.upper - hysteresis.lower), extrema)


def _interval_count(rows: Observations, span: float) -> int:
    """Number of intervals for which ``adapted_nodes`` keeps the levels of the data."""
    levels = np.unique(np.round(np.concatenate([rows.alpha, rows.beta]) / (SAME_LEVEL * span)))
    return int(np.clip(2 * levels.size + 6, MIN_INTERVALS, MAX_INTERVALS))


def _model_masses(triangle: Triangle, hysteresis: Everett) -> Array:
    """The mass of each cell in the model, in strokes (cells,)."""
    a, b = np.meshgrid(triangle.nodes, triangle.nodes, indexing="ij")
    E = np.asarray(hysteresis.swept(a, np.minimum(a, b)))
    i, j = triangle.i, triangle.j
    inner_corner = np.where(i == j, 0.0, E[i + 1, j + 1] - E[i, np.minimum(j + 1, i)])
    mass = E[i + 1, j] - E[i, j] - inner_corner
    return mass / (mass.sum() or 1.0)


def _smoothed(triangle: Triangle, mass: Array, width: float) -> Array:
    """A mass (cells,), spread over cells within about a width on the even scale; its sum stays."""
    if not width:
        return mass
    place = _node_positions(triangle)
    centre, size = (place[1:] + place[:-1]) / 2, np.diff(place)
    kernel = np.exp(-0.5 * ((centre[:, None] - centre) / width) ** 2)
    i, j = triangle.i, triangle.j
    area = size[i] * size[j] * np.where(i == j, 0.5, 1.0)

    def spread(values: Array) -> Array:
        return _of_cells(triangle, kernel @ _grid(triangle, values) @ kernel.T)

    found = area * spread(mass) / spread(area)
    return found * (mass.sum() / (found.sum() or 1.0))


def _even_scale(nodes: Array, prediction: Prediction) -> Array:
    """Nodes on a scale [0, 1]: half by the number of levels below, half by the smoothed motion of the output.

    If an effect moves the input and the density with it, nothing changes on this scale: a reparametrisation
    gains nothing.
    """
    at = prediction.of("settled") if "settled" in prediction.values else slice(None)
    ticks = prediction.tick_index[at]
    order = np.argsort(ticks)
    inputs = np.clip(prediction.hysteresis_input_K[ticks][order], nodes[0], nodes[-1])
    levels = np.unique(np.concatenate([nodes[[0, -1]], inputs]))
    levels = levels[np.append(True, np.diff(levels) > SAME_LEVEL * (nodes[-1] - nodes[0]))]
    levels[-1] = nodes[-1]
    rank = np.linspace(0, 1, levels.size)
    knots = np.linspace(0, 1, min(KNOTS, levels.size))
    ends = np.interp(inputs, levels, rank)
    low, high = np.minimum(ends[1:], ends[:-1]), np.maximum(ends[1:], ends[:-1])
    change = np.abs(np.diff(prediction.output[at][order]))
    below = np.clip((knots[:, None] - low) / np.maximum(high - low, SAME_LEVEL), 0.0, 1.0) @ change
    share = below / below[-1] if below[-1] else knots
    place = PchipInterpolator(np.interp(knots, rank, levels), LEVEL_SHARE * knots + (1 - LEVEL_SHARE) * share)
    return np.asarray(place(nodes), dtype=float)
