"""Predictions of blocks left out of a Gaussian problem, in closed form from one factorisation.

    y ~ N(0, K),  P = K⁻¹,  α = P y:     y_b − E[y_b | y_−b] = P_bb⁻¹ α_b,     Cov[y_b | y_−b] = P_bb⁻¹

A block is scored by the multivariate t with ``NU`` degrees of freedom, so that one bad block does not decide.
Source: Sundararajan and Keerthi, Neural Computation 13 (2001) 1103, for blocks.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError
from scipy.linalg.lapack import dpotrf, dpotri, dpotrs
from scipy.special import gammaln

from smarig.core import Array

Rows = NDArray[np.int64]
NU = 4  # degrees of freedom: tails of blocks


def inverse(matrix: Array) -> tuple[Array, float]:
    """(inverse (n, n), log of its root determinant) of a positive definite matrix. Raises LinAlgError if it is not."""
    factor = _factor(matrix)
    log_root = -float(np.log(np.diag(factor)).sum())
    lower = dpotri(factor, lower=1, overwrite_c=1)[0]
    whole = lower + lower.T
    whole[np.diag_indices_from(whole)] *= 0.5
    return whole, log_root


def _factor(matrix: Array) -> Array:
    """Its lower Cholesky factor (n, n)."""
    factor, failed = dpotrf(matrix.T, lower=1, clean=1)  # transposed, it is in LAPACK's order
    if failed:
        raise LinAlgError("The matrix is not positive definite.")
    return factor


def left_out(precision: Array, dual: Array, blocks: Sequence[Rows]) -> tuple[Array, Array]:
    """(error (n,) of each reading predicted without its block, log predictive density (B,) of each block).

    ``precision`` (n, n) is K⁻¹ and ``dual`` (n,) is K⁻¹y. ``blocks`` are the rows of each block; rows of no block keep
    the error NaN.
    """
    error = np.full(dual.size, np.nan)
    scores = np.empty(len(blocks))
    for b, rows in enumerate(blocks):
        factor = _factor(precision[np.ix_(rows, rows)])
        error[rows] = dpotrs(factor, dual[rows], lower=1)[0]
        square = float(dual[rows] @ error[rows])
        scores[b] = log_t_density(square, rows.size, float(np.log(np.diag(factor)).sum()))
    return error, scores


def log_t_density(square: float, size: int, log_root_precision: float) -> float:
    """log of the multivariate t density at a squared Mahalanobis distance, for ``size`` readings."""
    constant = gammaln((NU + size) / 2) - gammaln(NU / 2) - 0.5 * size * np.log(NU * np.pi)
    return float(constant + log_root_precision - 0.5 * (NU + size) * np.log1p(square / NU))
