"""How well the other blocks predict each block of readings: the log predictive density of a Gaussian model.

    log p(y_b | y_rest) = − ½ v_bᵀ P_bb⁻¹ v_b + ½ log det P_bb − const,      y_b − E[y_b | y_rest] = P_bb⁻¹ v_b

P = C⁻¹, without the free directions, and v = P y (for single readings: Sundararajan and Keerthi, Neural Computation 13,
2001).

Free directions are traces whose strengths are unknown: each block is predicted with strengths fitted to the others. If
these do not determine a strength, nothing predicts the block: its log density is −∞.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cho_factor, cho_solve, solve_triangular

from smarig.diagnosis.refit.refit import Refit
from smarig.replay import Timeline

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LeftOutBlocks:
    """The log density (blocks,) of each block given all others; scaled errors (N,) of readings, and their sds."""

    log_density: Array
    error: Array
    sd: Array


def left_out_blocks(timeline: Timeline, refitted: Refit, traces: Array | None = None) -> LeftOutBlocks:
    """Each block of readings predicted from all others; ``traces`` (N, k) have free strengths."""
    size = refitted.data.size
    inverse = solve_triangular(refitted.factor, np.eye(size), lower=True, check_finite=False)
    data = refitted.data
    if traces is not None:
        q = np.linalg.qr(refitted.whitened(traces))[0]
        inverse, data = inverse - q @ (q.T @ inverse), data - q @ (q.T @ data)
    block = np.concatenate([timeline.block[r.step] for r in timeline.all_readings])
    found, error, sd = [], np.empty(size), np.empty(size)
    for b in np.unique(block):
        own = inverse[:, block == b]
        try:
            v, precision = own.T @ data, cho_factor(own.T @ own, lower=True, check_finite=False)
        except LinAlgError:  # no other block determines a trace
            found.append(-np.inf)
            error[block == b], sd[block == b] = 0.0, np.inf
            continue
        error[block == b] = cho_solve(precision, v, check_finite=False)
        sd[block == b] = np.sqrt(np.diag(cho_solve(precision, np.eye(v.size), check_finite=False)))
        log_determinant = float(np.log(np.diag(precision[0])).sum())
        found.append(log_determinant - 0.5 * float(v @ error[block == b]))
    return LeftOutBlocks(np.array(found), error, sd)
