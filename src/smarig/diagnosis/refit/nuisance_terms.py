"""Nuisance terms: the most likely effect is included while the noise is estimated, so that it is not taken for
noise.

    gain of traces T at a covariance C:  ½ bᵀ(1 + G)⁻¹ b − ½ log det(1 + G),   G = Tᵀ C⁻¹ T,   b = Tᵀ C⁻¹ y

selects promising sets at two covariances: the likeliest without nuisance terms, and the likeliest with all of them.
For each selected set, all variances are then estimated again.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, solve_triangular

from smarig.diagnosis.refit.variance_components import ReadingCovariance

Array = NDArray[np.float64]
SETS_TRIED = 4  # sets evaluated at each covariance, most promising first


def likeliest_nuisance(
    reading_covariance: ReadingCovariance,
    memory: Array,
    without_nuisance: tuple[float, Array],
    sets: Sequence[Array],
) -> Array | None:
    """The set of columns (n, k) that makes the readings likeliest, or None if they are likeliest without any.

    ``without_nuisance``: the cost and the variances without a nuisance term.
    """
    cost, log_components = without_nuisance
    with_all = reading_covariance.likeliest(memory, log_components, np.column_stack(sets))[1]
    candidates_tried: dict[int, None] = {}
    for trial_components in (log_components, with_all):
        gains = _gains(reading_covariance, reading_covariance.covariance(memory, trial_components), sets)
        candidates_tried |= dict.fromkeys(np.argsort(-gains)[:SETS_TRIED].tolist())
    best = None
    for k in candidates_tried:
        cost_with_set = reading_covariance.likeliest(memory, with_all, sets[k])[0]
        if cost_with_set < cost:
            cost, best = cost_with_set, sets[k]
    return best


def _gains(reading_covariance: ReadingCovariance, C: Array, sets: Sequence[Array]) -> Array:
    """Gains (sets,) of the sets at a covariance, nats."""
    factor = cholesky(C, lower=True, check_finite=False)
    columns = np.column_stack([*sets, reading_covariance.y])
    *whitened, y = np.split(
        solve_triangular(factor, columns, lower=True, check_finite=False),
        np.cumsum([s.shape[1] for s in sets]),
        axis=1,
    )
    return np.array([_gain(T, y[:, 0]) for T in whitened])


def _gain(T: Array, y: Array) -> float:
    L = cholesky(np.eye(T.shape[1]) + T.T @ T, lower=True, check_finite=False)
    b = solve_triangular(L, T.T @ y, lower=True, check_finite=False)
    return 0.5 * float(b @ b) - float(np.log(np.diag(L)).sum())
