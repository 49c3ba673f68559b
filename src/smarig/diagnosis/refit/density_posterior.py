"""The density that readings speak for: the posterior mean of ``density_prior``, as a hysteresis.

Computed when it is asked for; most who refit ask for the covariance alone. Knows no noise but through C.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve

from smarig.diagnosis.refit.density_prior import DensityPrior
from smarig.preisach import FodTable

Array = NDArray[np.float64]
MAX_CORRECTIONS = 10  # times at most that what non-negative masses lost is given to others
TOLERANCE_STROKES = 1e-5  # strokes


@dataclass(frozen=True, eq=False)
class DensityPosterior:
    """A prior, the ``variances`` of its parts with their sum ``covariance`` (n, n), and ``dual_weights`` (n,) = C⁻¹y.

    ``factor`` is C's; ``output_slope`` (n,) the slope of scaled readings to the output in strokes, ``free`` (n, n) the
    covariance of zeros, ``zero_scale`` (n,) output units per scaled reading where a reading tells the zero y₋, else 0;
    ``stroke`` and ``y_lower`` those of the hysteresis that the prior is about.
    """

    prior: DensityPrior
    variances: Array
    covariance: Array
    output_slope: Array
    factor: Array
    free: Array
    dual_weights: Array
    zero_scale: Array
    stroke: float
    y_lower: float
    unit: str

    def table(self, *, signed: bool = False) -> FodTable:
        """The hysteresis, in ``unit``; ``signed``: masses may be negative where they were not."""
        masses, shift = self._masses(signed)
        has_zero = self.zero_scale > 0
        zero = self.y_lower + float(np.mean(self.zero_scale[has_zero] * shift[has_zero]))
        return self.prior.triangle.table(self.stroke * masses, zero, self.unit)

    def _masses(self, signed: bool) -> tuple[Array, Array]:
        """Masses (cells,) in strokes and zeros (n,), scaled.

        Where a mass would be negative it is none, unless it may be, and others must make up for it: the outputs stay
        the posterior's.
        """
        dual_weights, shift = self.output_slope * self.dual_weights, self.free @ self.dual_weights
        masses = self.prior.posterior_masses(self.variances, dual_weights, signed=signed)
        if signed:
            return masses, shift
        wanted = self.output_slope * (self.covariance @ dual_weights) + shift
        for _ in range(MAX_CORRECTIONS):
            remainder = wanted - self.output_slope * self.prior.outputs(masses - self.prior.mass) - shift
            if np.sqrt(np.mean(remainder**2) / np.mean(self.output_slope**2)) < TOLERANCE_STROKES:
                break
            correction = cho_solve((self.factor, True), remainder, check_finite=False)
            masses = self.prior.posterior_masses(self.variances, self.output_slope * correction, masses)
            shift = shift + self.free @ correction
        return masses, shift
