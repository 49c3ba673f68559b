"""A Gaussian problem whose covariance is a sum of given matrices: sizes by evidence, then blocks left out.

    y ~ N(0, A + Σ_k s_k K_k + σ² I),    s by L-BFGS on log s with the analytic gradient

A is what is known beforehand to be wide: 10·11ᵀ for an unknown constant.

A weak prior keeps the log of a size near ``USUAL``, so that one that the data do not ask for is small, not random.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError
from scipy.optimize import minimize

from smarig.core import Array
from smarig.diagnosis.comparison.block_predictions import inverse, left_out

LEVEL = 10.0  # variance of the unknown constant
USUAL, SPREAD = -6.0, 15.0  # log of a size, of outputs with a range of one
LEAST_NOISE = 1e-3  # of the range
BOUNDS = (-16.0, 4.0)


@dataclass(frozen=True, eq=False)
class GaussianFit:
    """Sizes (k + 1,), the last that of the noise; K⁻¹ and K⁻¹y; error (n,) and score (B,) of blocks left out."""

    sizes: Array
    precision: Array
    dual: Array
    error: Array
    scores: Array

    @property
    def noise(self) -> float:
        """Standard deviation of a reading."""
        return float(np.sqrt(self.sizes[-1]))

    @property
    def rms(self) -> float:
        """Of the left-out errors."""
        return float(np.sqrt(np.nanmean(self.error**2)))


def fit_gaussian(
    y: Array,
    parts: Sequence[Array],
    blocks: Sequence[NDArray[np.int64]],
    start: Array,
    iterations: int,
    always: Array | float = LEVEL,
) -> GaussianFit:
    """The fit of outputs (n,) with covariances (n, n); ``start`` (k + 1,) are sizes, ``iterations`` 0 keeps them.

    ``always`` (n, n) is the covariance A of every fit.
    """
    stack = np.array(parts).reshape(len(parts), -1)
    low = np.full(start.size, BOUNDS[0])
    low[-1] = 2 * np.log(LEAST_NOISE)
    x = np.clip(np.log(np.maximum(start, 1e-12)), low, BOUNDS[1])
    if iterations:
        found = minimize(
            _misfit,
            x,
            (y, stack, always),
            jac=True,
            method="L-BFGS-B",
            bounds=[(b, BOUNDS[1]) for b in low],
            options={"maxiter": iterations},
        )
        x = found.x
    sizes = np.exp(x)
    _, precision = _inverted(y.size, stack, sizes, always)
    dual = precision @ y
    error, scores = left_out(precision, dual, blocks)
    return GaussianFit(sizes, precision, dual, error, scores)


def _inverted(n: int, stack: Array, sizes: Array, always: Array | float) -> tuple[float, Array]:
    """(log det K / 2, K⁻¹)."""
    k = (sizes[:-1] @ stack).reshape(n, n)
    k += always
    k[np.arange(n), np.arange(n)] += sizes[-1]
    precision, log_root = inverse(k)
    return -log_root, precision


def _misfit(x: Array, y: Array, stack: Array, always: Array | float = LEVEL) -> tuple[float, Array]:
    sizes = np.exp(x)
    try:
        half_log_det, precision = _inverted(y.size, stack, sizes, always)
    except LinAlgError:
        return 1e10, np.zeros(x.size)
    dual = precision @ y
    precision -= np.outer(dual, dual)
    gradient = 0.5 * sizes * np.r_[stack @ precision.ravel(), np.trace(precision)]
    away = (x - USUAL) / SPREAD
    value = 0.5 * float(y @ dual) + half_log_det + float(away @ away) / 2
    return value, gradient + away / SPREAD
