"""Intervals of the parameters from residuals that hang together along a record.

Residuals are noise of single readings and errors that last: r_i = s_i z_i with the local size s_i and

    cov(z_i, z_j) = (1 − a) δ_ij + a ρ^|i−j|   within a record, 0 between records

a and ρ maximise the restricted likelihood, which counts the parameters that were fitted (Patterson and Thompson,
Biometrika 58, 1971, 545). With Γ, the covariance of all residuals, and the Jacobian J of least squares,

    cov = A⁻¹ Jᵀ Γ J A⁻¹,   A = JᵀJ

Parameters at an end of their range count as known. Where the ratio E_M/E_A is assumed, its spread is added.
"""

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve, toeplitz
from scipy.optimize import minimize

from smarig.core import Array
from smarig.identification.interval_estimate import quantile
from smarig.identification.material.material_fit import MaterialFit
from smarig.identification.material.material_records import MaterialRecord
from smarig.identification.material.parameters import RATIO_SD

_LOCAL = 0.2  # of a branch: residuals so near give the local size
_STARTS = ((0.0, 2.0), (2.0, 4.0))  # logits of a and ρ
_LARGEST_LOGIT = 7.0
_MOST = 250  # readings of a record, for the correlation
_RANK = 1e-13  # of the largest eigenvalue: smaller ones are rounding
_STEP = 1e-4  # of a standard deviation, for derivatives


def covariance(records: Sequence[MaterialRecord], fit: MaterialFit) -> Array:
    """Covariance (p + 1, p + 1) of ``fit.inner``; 0 for parameters at an end of their range."""
    moving = np.array(
        [n not in fit.at_bound for n in fit.choice.free] + [True] * fit.choice.n_zeros + [False]
    )
    J, r = fit.jacobian[:, moving], fit.residuals
    size = np.linalg.norm(J, axis=0)
    size[size == 0] = 1.0
    J = J / size
    inverse = np.linalg.pinv(J.T @ J, rcond=_RANK, hermitian=True)
    absorbed = np.einsum("ij,jk,ik->i", J, inverse, J)  # the part of each error that the fit follows
    full = r / np.maximum(1.0 - absorbed, 0.5)
    local = np.concatenate([_local_size(full[s]) for s in _branch_rows(records)])
    spans = list(_record_rows(records))
    variance, lasting, correlation = _correlation(J / local[:, None], r / local, spans)
    middle = np.zeros((J.shape[1],) * 2)
    for s in spans:
        scaled = J[s] * local[s][:, None]
        middle += variance * scaled.T @ _matrix(scaled.shape[0], lasting, correlation) @ scaled
    found = np.zeros((moving.size, moving.size))
    found[np.ix_(moving, moving)] = inverse @ middle @ inverse / np.outer(size, size)
    if fit.choice.assumes_ratio:
        follow = np.zeros(moving.size)  # how the parameters follow log E_M/E_A
        follow[moving] = -inverse @ (J.T @ fit.jacobian[:, -1]) / size
        follow[-1] = 1.0
        found += RATIO_SD**2 * np.outer(follow, follow)
    return found


def half_width(function: Callable[[Array], float], fit: MaterialFit, covariance: Array) -> float:
    """Half of the 95 % interval of a function of the parameters as they were fitted, by its gradient."""
    sd = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    gradient = np.zeros(sd.size)
    for k in np.flatnonzero(sd > 0):
        step = np.zeros(sd.size)
        step[k] = _STEP * sd[k]
        gradient[k] = (function(fit.inner + step) - function(fit.inner - step)) / (2 * step[k])
    n, p = fit.jacobian.shape
    return quantile(n - p) * float(np.sqrt(max(gradient @ covariance @ gradient, 0.0)))


def _record_rows(records: Sequence[MaterialRecord]) -> Iterator[slice]:
    """The rows of each record, of all in a row."""
    first = 0
    for record in records:
        yield slice(first, first + record.strain.size)
        first += record.strain.size


def _branch_rows(records: Sequence[MaterialRecord]) -> Iterator[slice]:
    """The rows of each branch, of all records in a row."""
    for rows, record in zip(_record_rows(records), records):
        for b in record.branches:
            yield slice(rows.start + b.first, rows.start + b.stop)


def _local_size(r: Array) -> Array:
    """Half of the square is that of the readings nearby, half that of the branch."""
    reach = max(1, int(_LOCAL * r.size / 2))
    sums = np.concatenate([[0.0], np.cumsum(r * r)])
    k = np.arange(r.size)
    low, high = np.maximum(k - reach, 0), np.minimum(k + reach + 1, r.size)
    near = (sums[high] - sums[low]) / (high - low)
    return np.sqrt(0.5 * near + 0.5 * np.mean(r * r) + 1e-24)


def _matrix(n: int, lasting: float, correlation: float) -> Array:
    """The correlation matrix of a branch of n readings."""
    row = lasting * correlation ** np.arange(n)
    row[0] = 1.0
    return toeplitz(row)


def _correlation(J: Array, r: Array, spans: Sequence[slice]) -> tuple[float, float, float]:
    """The variance, a and ρ of the largest restricted likelihood, from every so manyth reading of long records."""
    every = max(1, -(-max(s.stop - s.start for s in spans) // _MOST))
    rows = [np.arange(s.start, s.stop, every) for s in spans]

    def cost(logits: Array) -> float:
        lasting, correlation = _logistic(logits)
        log_size, normal, left = _sums(J, r, rows, lasting, correlation**every)
        eigenvalues = np.linalg.eigvalsh(normal)
        log_normal = float(np.log(np.maximum(eigenvalues, _RANK * eigenvalues[-1])).sum())
        return log_size + log_normal + freedom * float(np.log(left))

    freedom = max(sum(map(len, rows)) - J.shape[1], 1)
    options = {"maxfev": 60, "xatol": 0.05, "fatol": 0.05}
    tries = [minimize(cost, start, method="Nelder-Mead", options=options) for start in _STARTS]
    lasting, correlation = _logistic(min(tries, key=lambda t: t.fun).x)
    return _sums(J, r, rows, lasting, correlation**every)[2] / freedom, lasting, correlation


def _logistic(logits: Array) -> tuple[float, float]:
    first, second = (1.0 / (1.0 + np.exp(-np.clip(logits, -_LARGEST_LOGIT, _LARGEST_LOGIT)))).tolist()
    return first, second


def _sums(
    J: Array, r: Array, blocks: Sequence[NDArray[np.int64]], lasting: float, correlation: float
) -> tuple[float, Array, float]:
    """log |R|, JᵀR⁻¹J and the square of the residuals that no change of the parameters explains."""
    log_size, normal, mixed, square = 0.0, np.zeros((J.shape[1],) * 2), np.zeros(J.shape[1]), 0.0
    factors: dict[int, tuple[Array, bool]] = {}
    for rows in blocks:
        n = rows.size
        if n not in factors:
            factors[n] = cho_factor(_matrix(n, lasting, correlation), lower=True, check_finite=False)
        factor = factors[n]
        solved = cho_solve(factor, np.column_stack([J[rows], r[rows]]), check_finite=False)
        log_size += 2.0 * float(np.log(np.diag(factor[0])).sum())
        normal += J[rows].T @ solved[:, :-1]
        mixed += J[rows].T @ solved[:, -1]
        square += float(r[rows] @ solved[:, -1])
    left = square - float(mixed @ np.linalg.lstsq(normal, mixed, rcond=_RANK)[0])
    return log_size, normal, max(left, 1e-300)
