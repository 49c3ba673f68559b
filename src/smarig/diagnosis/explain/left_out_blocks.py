"""How well the other blocks predict each block of readings: the log predictive density of a Gaussian model.

    log p(y_b | y_rest) = − ½ v_bᵀ P_bb⁻¹ v_b + ½ log det P_bb − const,      P = C⁻¹ (or C⁻¹ without free directions),  v = P y

Free directions are traces whose strengths are unknown: each block is predicted with strengths fitted to the others.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve, solve_triangular

from smarig.diagnosis.refit.refit import Refit
from smarig.replay import Timeline

Array = NDArray[np.float64]


def log_densities_left_out(timeline: Timeline, refitted: Refit, traces: Array | None = None) -> Array:
    """The log density (blocks,) of each block's readings given all others; ``traces`` (N, k) have free strengths."""
    size = refitted.data.size
    inverse = solve_triangular(refitted.factor, np.eye(size), lower=True, check_finite=False)
    data = refitted.data
    if traces is not None:
        q = np.linalg.qr(refitted.whitened(traces))[0]
        inverse, data = inverse - q @ (q.T @ inverse), data - q @ (q.T @ data)
    block = np.concatenate([timeline.block[r.step] for r in timeline.all_readings])
    found = []
    for b in np.unique(block):
        own = inverse[:, block == b]
        v, precision = own.T @ data, cho_factor(own.T @ own, lower=True, check_finite=False)
        log_determinant = float(np.log(np.diag(precision[0])).sum())
        found.append(log_determinant - 0.5 * float(v @ cho_solve(precision, v, check_finite=False)))
    return np.array(found)
