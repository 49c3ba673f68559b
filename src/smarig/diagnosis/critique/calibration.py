"""The probability of a largest gain without an effect, calibrated on boxes that have none.

Null data have the noise of a refit, but not the misfit of its density. Compared with them alone, p ≤ 0.03 came up in
one of seven boxes without an effect. So of the null data only two quantiles are used, which make the excess

    e = (T − q50) / (q95 − q50),    T: largest standardised gain,  q50, q95: of the same in null data

and e is compared with those of boxes without an effect, which have such misfits: p is the share of boxes with an
excess as large (a conformal p-value; Vovk, Gammerman and Shafer 2005, §2.2).
"""

import numpy as np
from numpy.typing import NDArray

CALIBRATION_BOXES = 350  # seed 78 of benchmarks/boxes, 200 null data sets each
CALIBRATED_P = (1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1, 0.05, 0.03, 0.02, 0.01, 0.005)
EXCESS = (-2.05, -1.32, -0.94, -0.74, -0.49, -0.23, 0.02, 0.37, 0.87, 2.01, 3.84, 4.7, 5.11, 6.37, 7.12)
LEAST_P = CALIBRATED_P[-1]


def calibrated_p(largest: float, null_largest: NDArray[np.float64]) -> float:
    """The share of boxes without an effect whose excess is as large; ``null_largest`` (k,) are those of null data."""
    median, spread = _median_and_spread(null_largest)
    return float(np.exp(np.interp((largest - median) / spread, EXCESS, np.log(CALIBRATED_P))))


def p_text(p: float) -> str:
    """A calibrated p with its sign.

    >>> p_text(0.123), p_text(0.005)
    ('= 0.12', '≤ 0.005')
    """
    return f"≤ {LEAST_P:g}" if p <= 1.001 * LEAST_P else f"= {p:.2g}"


def calibrated_threshold(alpha: float, null_largest: NDArray[np.float64]) -> float:
    """The largest standardised gain that a share ``alpha`` of boxes without an effect exceed."""
    median, spread = _median_and_spread(null_largest)
    return median + spread * float(np.interp(-np.log(alpha), -np.log(CALIBRATED_P), EXCESS))


def _median_and_spread(null_largest: NDArray[np.float64]) -> tuple[float, float]:
    median, high = np.quantile(null_largest, [0.5, 0.95])
    return float(median), float(high - median)
