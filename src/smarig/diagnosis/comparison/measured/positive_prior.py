"""A prior of relay densities around a positive fit: K_w = F diag(w₀) C diag(w₀) Fᵀ, mean zero.

w₀ is a non-negative least-squares fit by multiplicative steps, w ← w · Fᵀy / FᵀFw (Lee and Seung 2001). Deviations in
proportion to w₀ keep the density positive in effect. A free density would represent outputs that lead their input, and
a lag of the input could not be seen.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d

from smarig.core import Array
from smarig.diagnosis.comparison.measured.memory_features import MemoryGrid
from smarig.diagnosis.comparison.measured.reading_problem import ReadingProblem

STEPS = 150
WARP_CELLS = 40
WARP = 0.5  # share of the cells that follow the output; a Preisach model knows no scale of its input
GRID = MemoryGrid()
SLOPE_STEP = 0.01


@dataclass(frozen=True, eq=False)
class PositiveDensity:
    """Features (m, k) of all readings for an input that acts, and density w₀ (k,).

    ``variance`` is the mean over the training readings of the variance of deviations as large as w₀.
    """

    features: Array
    density: Array
    warped: tuple[Array, ...]
    variance: float

    def slope(self, problem: ReadingProblem, dual: Array) -> Array:
        """Difference (m,) of the readings between inputs shifted up and down by a warped step, from K⁻¹y (n,)."""
        up, down = (_features(problem, [v + step for v in self.warped]) for step in (SLOPE_STEP, -SLOPE_STEP))
        train = self.features[problem.train]
        return GRID.predicted(up - down, train, self.density, dual) / self.variance


@dataclass(frozen=True, eq=False)
class PositivePrior:
    """A density, and the covariance (m, m) of deviations as large as it, over ``relays.variance``."""

    relays: PositiveDensity
    covariance: Array


def positive_prior(
    problem: ReadingProblem, inputs: Sequence[Array], target: Array, near: PositivePrior | None = None
) -> PositivePrior:
    """The prior for inputs (n,) of each record that act on the wire, and a ``target`` (m,) of its positive fit.

    If ``near`` is of the same inputs, both hold one array of features.
    """
    warped = tuple(_warped(problem, inputs))
    same = near is not None and all(map(np.array_equal, near.relays.warped, warped))
    features = near.relays.features if near is not None and same else _features(problem, warped)
    train = problem.train
    density = _positive_fit(features[train], target[train])
    covariance = GRID.covariance(features, density)
    variance = float(np.mean(np.diag(covariance)[train])) or 1.0
    return PositivePrior(PositiveDensity(features, density, warped, variance), covariance / variance)


def _features(problem: ReadingProblem, inputs: Sequence[Array]) -> Array:
    return np.vstack(
        [
            GRID.features(v, rows, up=up if up is not None else bool(v[0] > 0.5))
            for v, rows, up in zip(inputs, problem.rows, problem.starts_up)
        ]
    )


def _warped(problem: ReadingProblem, inputs: Sequence[Array]) -> list[Array]:
    """ψ(v): the cumulative of half a uniform and half the histogram of |Δy| over v."""
    low = min(float(v.min()) for v in inputs)
    high = max(float(v.max()) for v in inputs)
    edges = np.linspace(low, high, WARP_CELLS + 1)
    weight = np.zeros(WARP_CELLS)
    for number, (v, rows) in enumerate(zip(inputs, problem.rows)):
        here = problem.record == number
        known = problem.train[here]
        at, y = v[rows][known], problem.y[here][known]
        if y.size < 3:
            continue
        steps = np.abs(np.diff(y))
        steps = np.maximum(steps - 0.5 * float(np.median(steps)), 0)
        weight += np.histogram(0.5 * (at[1:] + at[:-1]), edges, weights=steps)[0]
    weight = gaussian_filter1d(weight, 1.0)
    density = WARP * weight / max(float(weight.sum()), 1e-12) + (1 - WARP) / WARP_CELLS
    psi = np.r_[0.0, np.cumsum(density)]
    return [np.interp(v, edges, psi / psi[-1]) for v in inputs]


def _positive_fit(features: Array, y: Array) -> Array:
    columns = np.c_[features, np.ones(len(features))]
    target = y - y.min() + 1e-3 * np.ptp(y)
    w = np.full(columns.shape[1], target.mean() / columns.sum(axis=1).mean())
    right, gram = columns.T @ target, columns.T @ columns
    for _ in range(STEPS):
        below = gram @ w
        w = np.where(below > 1e-9 * below.max(), w * right / np.maximum(below, 1e-300), w)
    return w[:-1]
