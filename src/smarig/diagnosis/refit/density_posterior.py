"""The posterior mean of ``density_prior`` given the readings, as a hysteresis.

It is computed on demand, because most refits need the covariance only.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_solve

from smarig.core import Array
from smarig.diagnosis.refit.density_prior import DensityPrior
from smarig.preisach import FodTable

MAX_CORRECTIONS = 10  # most rounds that redistribute what clipped masses lose
TOLERANCE_STROKES = 1e-5  # strokes


@dataclass(frozen=True, eq=False)
class DensityPosterior:
    """A prior, the ``variances`` of its parts, and ``dual_weights`` (n,) = C⁻¹y.

    ``outputs`` (n,), in strokes, are the mean deviations from those of the prior.

    ``factor`` is the Cholesky factor of C. ``output_slope`` (n,) is the slope of scaled readings to the output in
    strokes. ``free`` (n, n) is the covariance of zeros. ``zero_scale`` (n,) is in output units per scaled reading
    if a reading shows the zero y₋, else 0. ``stroke`` and ``y_lower`` belong to the hysteresis of the prior.
    """

    prior: DensityPrior
    variances: Array
    output_slope: Array
    factor: Array
    free: Array
    dual_weights: Array
    outputs: Array
    zero_scale: Array
    stroke: float
    y_lower: float
    unit: str

    def table(self) -> FodTable:
        """The hysteresis, in ``unit``."""
        masses, shift = self._masses()
        has_zero = self.zero_scale > 0
        zero = self.y_lower + float(np.mean(self.zero_scale[has_zero] * shift[has_zero]))
        return self.prior.triangle.table(self.stroke * masses, zero, self.unit)

    def _masses(self) -> tuple[Array, Array]:
        """Masses (cells,) in strokes and zeros (n,), scaled.

        Negative masses are set to zero; the others compensate, so that the outputs remain those of the posterior.
        """
        dual_weights, shift = self.output_slope * self.dual_weights, self.free @ self.dual_weights
        masses = self.prior.posterior_masses(self.variances, dual_weights)
        wanted = self.output_slope * self.outputs + shift
        for _ in range(MAX_CORRECTIONS):
            remainder = wanted - self.output_slope * self.prior.outputs(masses - self.prior.mass) - shift
            if np.sqrt(np.mean(remainder**2) / np.mean(self.output_slope**2)) < TOLERANCE_STROKES:
                break
            correction = cho_solve((self.factor, True), remainder, check_finite=False)
            masses = self.prior.posterior_masses(self.variances, self.output_slope * correction, masses)
            shift = shift + self.free @ correction
        return masses, shift
