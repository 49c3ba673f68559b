"""A value with its 95 % interval, from residuals that may be correlated in time.

Readings of a slow wire by a coarse sensor are not independent: a quantised reading stands still, then jumps.
Ordinary standard errors are then too small by √f, with f = 1 + 2 Σ ρ_k the integrated autocorrelation of the
residuals. n readings count as n/f.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from scipy.special import stdtrit  # not scipy.stats, which takes a second to import

from smarig.core import Array, spaced


@dataclass(frozen=True)
class Estimate:
    """A value with its 95 % interval and unit; ``source`` states its origin, ``n`` the number of readings."""

    value: float
    ci95: tuple[float, float]
    unit: str
    source: str
    n: int

    def to_json(self) -> dict[str, Any]:
        """As a JSON object."""
        return asdict(self) | {"ci95": list(self.ci95)}

    def __str__(self) -> str:
        low, high = self.ci95
        return f"{self.value:.4g}{spaced(self.unit)} (95 %: {low:.4g} to {high:.4g}, n = {self.n})"


def variance_inflation(residuals: Sequence[Array]) -> float:
    """f = 1 + 2 Σ ρ_k ≥ 1 over segments (n_j,) of equally spaced residuals, pooled.

    The sum runs while pairs ρ_{2m−1} + ρ_{2m} are positive (Geyer, Statist. Sci. 7:473, 1992) and lags are below a
    third of the longest segment.

    >>> variance_inflation([np.array([1.0, -1.0] * 50)])
    1.0
    """
    variance = sum(float(r @ r) for r in residuals)
    if variance == 0:
        return 1.0
    total = 0.0
    for lag in range(1, max(r.size for r in residuals) // 3, 2):
        pair = sum(_lagged(r, lag) + _lagged(r, lag + 1) for r in residuals) / variance
        if pair <= 0:
            break
        total += pair
    return 1.0 + 2.0 * total


def _lagged(r: Array, lag: int) -> float:
    return float(r[:-lag] @ r[lag:]) if lag < r.size else 0.0


@dataclass(frozen=True, eq=False)
class LinearFit:
    """Coefficients (p,), half-widths of their 95 % intervals (p,), residual rms, n and f."""

    x: Array
    half: Array
    rms: float
    n: int
    variance_inflation: float


def linear_fit(segments: Sequence[tuple[Array, Array]]) -> LinearFit | None:
    """Least squares of b (n_j,) on A (n_j, p) over segments; None if the data do not determine p numbers."""
    A = np.concatenate([a for a, _ in segments])
    b = np.concatenate([v for _, v in segments])
    n, p = A.shape
    if n < p + 2 or np.linalg.matrix_rank(A) < p:
        return None
    x = np.asarray(np.linalg.lstsq(A, b, rcond=None)[0], dtype=float)
    residuals = [v - a @ x for a, v in segments]
    f = variance_inflation(residuals)
    square = sum(float(r @ r) for r in residuals)
    spread = np.asarray(np.sqrt(square / (n - p) * f * np.diag(np.linalg.inv(A.T @ A))), dtype=float)
    return LinearFit(x, quantile(n / f - p) * spread, float(np.sqrt(square / n)), n, f)


def quantile(freedom: float) -> float:
    """Student's 97.5 % point for (effective) degrees of freedom, at least one."""
    return float(stdtrit(max(freedom, 1.0), 0.975))
