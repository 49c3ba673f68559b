"""Recovery of a known density from noisy curves: estimators that do not use the truth, and a peer tuned with
it.

Five seeds of the published curves (``synthetic_curves``) at 0.1 % and 0.5 % noise. The score is the relative
L2 error of μ over the nodes. The estimators of smarig choose their own smoothing. PmagPy, if installed, gets
the smoothing factor that is best against the truth: its best case.
"""

from collections.abc import Callable
from importlib import import_module
from importlib.metadata import version
from time import process_time
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator

from benchmarks.synthetic_curves import NODES, curves, truth_density
from smarig.identification import forc_density

Array = NDArray[np.float64]
Estimator = Callable[[Array, Array, Array], Array]
"""(α, β, y) (k,) of curves → μ (k,), NaN where there is no estimate."""

NOISES = (0.001, 0.005)
SEEDS = 5
MARGIN = 3  # steps from every edge to an interior node
_FACTORS = range(6, 16)


def estimators() -> dict[str, Estimator]:
    """The compared estimators by name; none uses the truth. Add one here."""
    found: dict[str, Estimator] = {"loess": _loess, "loess_degree_2": _quadratic}
    positive = _positive()
    return found if positive is None else found | {"positive": positive}


def run(quick: bool = False) -> dict[str, Any]:
    """Mean and standard deviation of the error by noise and estimator; ``quick`` runs one seed.

    ``{"nodes", "seeds", "margin_steps", "results": [{"noise", "estimator", "oracle", "interior",
    "interior_sd", "all", "coverage", "seconds"}], "peer": "pmagpy …" | None}``; errors are relative, seconds
    are processor time per data set.
    """
    seeds = range(1 if quick else SEEDS)
    peer = _pmagpy()
    results = [
        _row(noise, name, [_estimator_scores(estimate, noise, seed) for seed in seeds], oracle=False)
        for noise in NOISES
        for name, estimate in estimators().items()
    ]
    if peer is not None:
        results += [_tuned(noise, peer[1], seeds) for noise in NOISES]
    return {
        "nodes": NODES,
        "seeds": len(seeds),
        "margin_steps": MARGIN,
        "results": results,
        "peer": None if peer is None else f"pmagpy {peer[0]}",
    }


def score(mu: Array, interior: bool = True) -> float:
    """Relative L2 error ‖μ − truth‖/‖truth‖ over the interior nodes, or over all nodes off the diagonal."""
    alpha, beta, _ = curves()
    margin = (MARGIN if interior else 1) * 2 / (NODES - 1) - 1e-9
    counted = (alpha - beta > margin) & np.isfinite(mu)
    if interior:
        counted &= (beta + 1 > margin) & (1 - alpha > margin)
    truth = truth_density(alpha, beta)[counted]
    return float(np.linalg.norm(mu[counted] - truth) / np.linalg.norm(truth))


def _estimator_scores(estimate: Estimator, noise: float, seed: int) -> tuple[float, float, float, float]:
    """Interior error, error of all nodes, share of nodes with a value, processor seconds."""
    data = curves(noise, seed)
    begin = process_time()
    mu = estimate(*data)
    seconds = process_time() - begin
    return score(mu), score(mu, interior=False), float(np.isfinite(mu).mean()), seconds


def _row(
    noise: float, name: str, estimator_scores: list[tuple[float, float, float, float]], oracle: bool
) -> dict[str, Any]:
    interior, everywhere, coverage, seconds = np.array(estimator_scores).T
    return {
        "noise": noise,
        "estimator": name,
        "oracle": oracle,
        "interior": float(interior.mean()),
        "interior_sd": float(interior.std(ddof=1)) if len(estimator_scores) > 1 else None,
        "all": float(everywhere.mean()),
        "coverage": float(coverage.mean()),
        "seconds": float(np.median(seconds)),
    }


def _tuned(noise: float, loess: Callable[[int], Estimator], seeds: range) -> dict[str, Any]:
    """The row of the smoothing factor with the least mean interior error over the seeds."""
    rows = [
        _row(
            noise, "pmagpy_loess", [_estimator_scores(loess(sf), noise, seed) for seed in seeds], oracle=True
        )
        | {"smoothing": sf}
        for sf in _FACTORS
    ]
    return min(rows, key=lambda row: row["interior"])


def _loess(alpha: Array, beta: Array, y: Array) -> Array:
    return forc_density(alpha, beta, y).mu


def _quadratic(alpha: Array, beta: Array, y: Array) -> Array:
    return forc_density(alpha, beta, y, degree=2).mu


def _positive() -> Estimator | None:
    """The non-negative identification, if available: cell masses over areas, linear between the cells."""
    try:
        from smarig.identification import Observations, fit_positive
    except ImportError:
        return None

    def estimate(alpha: Array, beta: Array, y: Array) -> Array:
        curve = np.unique(alpha, return_inverse=True)[1].astype(np.int64)
        fit = fit_positive(Observations.of_points(alpha, beta, y, curve, (-1.0, 1.0)))
        nodes, i, j = fit.triangle.nodes, fit.triangle.i, fit.triangle.j
        middle, width, inner = (nodes[1:] + nodes[:-1]) / 2, np.diff(nodes), i > j
        i, j = i[inner], j[inner]
        cells = np.column_stack([middle[i], middle[j]])
        mu = fit.masses[inner] / (2 * width[i] * width[j])
        places = np.column_stack([alpha, beta])
        between = LinearNDInterpolator(cells, mu)(places)
        return np.where(np.isnan(between), NearestNDInterpolator(cells, mu)(places), between)

    return estimate


def _pmagpy() -> tuple[str, Callable[[int], Estimator]] | None:
    """PmagPy's version and its LOESS by smoothing factor; None if it is not installed."""
    try:
        loess = import_module("pmagpy.forc").loess_rho_from_grid_fast
    except ImportError:
        return None

    def of(factor: int) -> Estimator:
        def estimate(alpha: Array, beta: Array, y: Array) -> Array:
            field = np.linspace(-1.0, 1.0, NODES)
            # Magnetic curves are mirrored: reversal field −α, field −β, moment −y.
            row, column = (NODES - 1 - np.rint((u + 1) / 2 * (NODES - 1)).astype(int) for u in (alpha, beta))
            moment = np.full((NODES, NODES), np.nan)
            moment[row, column] = -y
            span = factor * (field[1] - field[0]) * (1 - 1e-9)  # PmagPy rounds up to whole steps
            return loess(field, field, moment, span, span)[row, column]

        return estimate

    return version("pmagpy"), of
