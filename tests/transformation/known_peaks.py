"""Peaks of heat flow in closed form, with the temperatures where their tangents meet their baselines."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import erf

Array = NDArray[np.float64]


@dataclass(frozen=True)
class KnownPeak:
    """A peak of two half Gaussians at ``middle`` (°C), upwards, on a baseline with a slope and a step that follows the
    part of the area gone by.
    """

    middle: float = 62.0
    before: float = 5.0
    after: float = 5.0
    height: float = 0.3
    slope: float = 0.0
    step: float = 0.0
    level: float = 0.04

    def heat_flow(self, u: Array) -> Array:
        """The curve (n,) without noise."""
        return self._over_first(u) + self.level + self.slope * u

    def _over_first(self, u: Array) -> Array:
        width = np.where(u < self.middle, self.before, self.after)
        z = (u - self.middle) / width
        part = np.where(
            u < self.middle, self.before * (1 + erf(z / 2**0.5)), self.before + self.after * erf(z / 2**0.5)
        )
        return self.height * np.exp(-(z**2) / 2) + self.step * part / (self.before + self.after)

    @property
    def area(self) -> float:
        """Area over the baseline, in the unit of heat flow times K."""
        return self.height * (self.before + self.after) * float(np.sqrt(np.pi / 2))

    @property
    def feet(self) -> tuple[float, float]:
        """Where the steepest tangents meet the baselines, on a grid of 1/1000 K; without a step, middle ∓ 2 widths."""
        u = np.arange(self.middle - 6 * self.before, self.middle + 6 * self.after, 1e-3)
        found = []
        for y, steepest in ((self._over_first(u), np.argmax), (self._over_first(u) - self.step, np.argmin)):
            slope = np.gradient(y, u)
            k = int(steepest(slope))
            found.append(float(u[k] - y[k] / slope[k]))
        return found[0], found[1]
