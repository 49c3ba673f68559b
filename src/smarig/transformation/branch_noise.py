"""The noise of the readings of one part of a branch, and draws of it.

The noise is what a cubic through the part leaves over. Readings that are correlated along the curve count as fewer
(``variance_inflation``). Each draw takes its own standard deviation, so that the draws have the tails of Student's t
where few readings determine it.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.identification import variance_inflation

Integers = NDArray[np.int64]


@dataclass(frozen=True)
class ReadingNoise:
    """Standard deviation with its degrees of freedom; ``inflation`` is the factor on the variance for correlation."""

    sd: float
    degrees: float
    inflation: float = 1.0

    def draws(self, count: int, rows: Integers, size: int, dice: np.random.Generator) -> Array:
        """Draws (count, size) of the noise of all readings; zero outside ``rows``."""
        noise = np.zeros((count, size))
        if self.sd > 0 and rows.size:
            sds = self.sd * np.sqrt(self.inflation * self.degrees / dice.chisquare(self.degrees, count))
            noise[:, rows] = sds[:, None] * dice.standard_normal((count, rows.size))
        return noise


def reading_noise(x: Array, z: Array) -> ReadingNoise:
    """The noise of z (n,) about a cubic in x; about a line for fewer than 8 readings."""
    degree = 3 if z.size >= 8 else 1
    scaled = (x - x.mean()) / (float(np.abs(x - x.mean()).max()) or 1.0)
    design = np.vander(scaled, degree + 1)
    residual = z - design @ (np.linalg.pinv(design) @ z)
    degrees = max(z.size - degree - 1, 1)
    sd = float(np.sqrt(residual @ residual / degrees))
    inflation = variance_inflation([residual]) if _is_correlated(residual) else 1.0
    return ReadingNoise(sd, degrees, min(inflation, z.size / 4))


def _is_correlated(residual: Array) -> bool:
    """Whether neighbours are correlated beyond chance (two standard errors)."""
    square = float(residual @ residual)
    return square > 0 and float(residual[1:] @ residual[:-1]) / square > 2 / np.sqrt(residual.size)


def pooled(noises: list[ReadingNoise]) -> ReadingNoise | None:
    """The noise of both plateaus together."""
    if not noises:
        return None
    degrees = sum(n.degrees for n in noises)
    return ReadingNoise(float(np.sqrt(sum(n.degrees * n.sd**2 for n in noises) / degrees)), degrees)


def at_least(found: ReadingNoise, least: ReadingNoise | None) -> ReadingNoise:
    """The noise of a part, with the help of that of both plateaus where few readings determine it."""
    if least is None or found.degrees >= 8:
        return found
    both = pooled([found, ReadingNoise(least.sd, min(least.degrees, 8.0))])
    return both or found
