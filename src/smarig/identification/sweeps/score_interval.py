"""The interval of an unknown of sweeps: the sweep is the unit that counts, since residuals along it are correlated.

With g the slope of the residuals r by the unknown x,

    Var x = Σ_sweeps (Σ g r)² / (Σ g²)²        (Liang & Zeger, Biometrika 73:13, 1986),

with Student's t of the number of sweeps. The interval is never narrower than that of independent blocks, whose variance
is the mean square of the residuals and not that of the encoder's noise.
"""

import math

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.identification.interval_estimate import quantile


def half_width(slope: Array, residual: Array, sweep: NDArray[np.int64]) -> float:
    """Half-width of the 95 % interval of the unknown; inf if the residuals do not depend on it."""
    curvature = float(slope @ slope)
    if curvature == 0:
        return math.inf
    clusters = np.bincount(sweep, slope * residual)
    moved = np.bincount(sweep, slope**2)
    # sweeps that hardly depend on it do not count as repetitions
    effective = curvature**2 / max(float(moved @ moved), 1e-300)
    score = float(clusters @ clusters) * effective / max(effective - 1, 1.0)
    independent = float(np.mean(residual**2)) * curvature
    return quantile(effective - 1) * math.sqrt(max(score, independent)) / curvature
