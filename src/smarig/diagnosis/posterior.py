"""The density that readings speak for: the posterior mean of ``free_density``, as a hysteresis.

Computed when it is asked for; most who refit ask for the covariance alone. Knows no noise but through C.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve

from smarig.diagnosis.free_density import FreeDensity
from smarig.preisach.fod_table import FodTable

Array = NDArray[np.float64]
AGAIN = 10  # times at most that what non-negative masses lost is given to others
LOST = 1e-5  # strokes


@dataclass(frozen=True, eq=False)
class Posterior:
    """A prior, the ``variances`` of its parts with their sum ``covariance`` (n, n), and ``pull`` (n,) = C⁻¹y.

    ``factor`` is C's; ``reach`` (n,) the slope of scaled readings to the output in strokes, ``free`` (n, n) the
    covariance of zeros, ``zero_of`` (n,) output units per scaled reading where a reading tells the zero y₋, else 0;
    ``stroke`` and ``y_lower`` those of the hysteresis that the prior is about.
    """

    prior: FreeDensity
    variances: Array
    covariance: Array
    reach: Array
    factor: Array
    free: Array
    pull: Array
    zero_of: Array
    stroke: float
    y_lower: float
    unit: str

    def table(self, *, signed: bool = False) -> FodTable:
        """The hysteresis, in ``unit``; ``signed``: masses may be negative where they were not."""
        masses, shift = self._masses(signed)
        tells = self.zero_of > 0
        zero = self.y_lower + float(np.mean(self.zero_of[tells] * shift[tells]))
        return self.prior.triangle.table(self.stroke * masses, zero, self.unit)

    def _masses(self, signed: bool) -> tuple[Array, Array]:
        """Masses (cells,) in strokes and zeros (n,), scaled.

        Where a mass would be negative it is none, unless it may be, and others must make up for it: the outputs stay
        the posterior's.
        """
        pull, shift = self.reach * self.pull, self.free @ self.pull
        masses = self.prior.renewed(self.variances, pull, signed=signed)
        if signed:
            return masses, shift
        wanted = self.reach * (self.covariance @ pull) + shift
        for _ in range(AGAIN):
            lost = wanted - self.reach * self.prior.outputs(masses - self.prior.mass) - shift
            if np.sqrt(np.mean(lost**2) / np.mean(self.reach**2)) < LOST:
                break
            more = cho_solve((self.factor, True), lost, check_finite=False)
            masses = self.prior.renewed(self.variances, self.reach * more, masses)
            shift = shift + self.free @ more
        return masses, shift
