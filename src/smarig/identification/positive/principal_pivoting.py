"""A convex quadratic programme with some unknowns ≥ 0, solved exactly by an exchange of its active constraints.

    minimise ½ xᵀH x − gᵀx   subject to  x_i ≥ 0 for the bounded i,      H positive definite, dense

by block principal pivoting (Portugal, Júdice & Vicente 1994; Kim & Park 2011): the unknowns that are not at their bound
follow from linear equations; all that violate a condition of optimality change sides at once, or only the last of them
if that does not help. From the active constraints of a similar problem it takes a few small factorisations.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cho_factor, cho_solve

from smarig.core import Array

Mask = NDArray[np.bool_]
MOST_EXCHANGES = 30
MAX_FAILURES = 3  # exchanges of all at once that may fail to reduce the violations
LEAST_VALUE, LEAST_MULTIPLIER = 1e-12, 1e-9  # for outputs of order 1: smaller violations are rounding


def solve_by_pivoting(H: Array, g: Array, bounded: int, positive: Mask | None = None) -> Array | None:
    """Minimise ½ xᵀHx − gᵀx with the first ``bounded`` unknowns ≥ 0; None if rounding or cycling prevents it.

    ``positive`` (bounded,) is a guess of the bounded unknowns that are not zero; None: all.

    >>> solve_by_pivoting(np.eye(3), np.array([1.0, -1.0, -2.0]), 2).tolist()
    [1.0, 0.0, -2.0]
    """
    free = np.arange(g.size) >= bounded
    inner = np.ones(g.size, dtype=bool)
    inner[:bounded] = True if positive is None else positive
    fewest, tries_left = g.size + 1, MAX_FAILURES
    for _ in range(MOST_EXCHANGES):
        at = np.flatnonzero(inner)
        x = np.zeros(g.size)
        try:
            factors = cho_factor(H[np.ix_(at, at)], lower=True, overwrite_a=True, check_finite=False)
        except LinAlgError:
            return None
        x[at] = cho_solve(factors, g[at], check_finite=False)
        multiplier = H @ x - g
        violated = ~free & np.where(inner, x < -LEAST_VALUE, multiplier < -LEAST_MULTIPLIER)
        count = int(violated.sum())
        if not count:
            return x
        if count < fewest:
            fewest, tries_left = count, MAX_FAILURES
        elif tries_left:
            tries_left -= 1
        else:
            violated[: np.flatnonzero(violated)[-1]] = False
        inner = inner ^ violated
    return None
