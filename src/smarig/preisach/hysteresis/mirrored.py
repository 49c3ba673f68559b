"""The mirror image of a hysteresis, (u, y) → (−u, −y). It turns first-order ascending curves into descending ones.

Magnetic first-order reversal curves rise from a reversal point below positive saturation. They are FOD curves of the
mirrored hysteresis. Reflection preserves the measure: F(α, β) = F̃(−β, −α).
"""

from dataclasses import dataclass
from functools import singledispatch
from typing import cast

import numpy as np
from numpy.typing import ArrayLike

from smarig.core import Array, UsageError
from smarig.preisach.everett import Differentiable, Everett, from_diagonal


@dataclass(frozen=True, eq=False)
class Mirrored:
    """The hysteresis whose mirror image is ``image``."""

    image: Everett

    @property
    def lower(self) -> float:
        """Negative saturation: the reflected positive saturation of the image."""
        return -self.image.upper

    @property
    def upper(self) -> float:
        """Positive saturation."""
        return -self.image.lower

    @property
    def y_lower(self) -> float:
        """Output at negative saturation."""
        return -(self.image.y_lower + self.image.everett(self.image.upper, self.image.lower))

    def everett(self, alpha: float, beta: float) -> float:
        """F(α, β) = F̃(−β, −α)."""
        return self.image.everett(-beta, -alpha)

    def swept(self, alpha: ArrayLike, beta: ArrayLike) -> Array:
        """F(α, β) for arrays."""
        return self.image.swept(-np.asarray(beta, dtype=float), -np.asarray(alpha, dtype=float))

    @property
    def steps(self) -> Array:
        """Inputs at which F jumps, if any: the reflected thresholds of the image."""
        return -np.asarray(getattr(self.image, "steps", ()))[::-1]

    @property
    def kinks(self) -> Array:
        """Inputs at which slopes jump: the reflected kinks of the image."""
        return -np.asarray(getattr(self.image, "kinks", ()))[::-1]

    def strip_alpha(self, alpha: ArrayLike, beta: ArrayLike) -> Array:
        """∂F/∂α: the strip that a fall of the image sweeps. Available only if the image has slopes."""
        return self._slopes.strip_beta(-np.asarray(beta, dtype=float), -np.asarray(alpha, dtype=float))

    def strip_beta(self, alpha: ArrayLike, beta: ArrayLike) -> Array:
        """∂y/∂β: the strip that a rise of the image sweeps. Available only if the image has slopes."""
        return self._slopes.strip_alpha(-np.asarray(beta, dtype=float), -np.asarray(alpha, dtype=float))

    @property
    def _slopes(self) -> Differentiable:
        if not hasattr(self.image, "strip_alpha"):
            raise UsageError(f"{type(self.image).__name__} has no slopes, so its mirror image has none.")
        return cast(Differentiable, self.image)

    def from_diagonal(self, centre: float, u: Array) -> Array:
        """Signed output change from B_ℓ to each input: the reflected change of the image from B_−ℓ."""
        return -from_diagonal(self.image, -centre, -u)

    def rise_from_diagonal(self, centre: float, u: float) -> float:
        """Output change of a rise, which is a fall of the image."""
        return self.image.fall_from_diagonal(-centre, -u)

    def fall_from_diagonal(self, centre: float, u: float) -> float:
        """Output change of a fall, which is a rise of the image."""
        return self.image.rise_from_diagonal(-centre, -u)


@singledispatch
def mirror_image(hysteresis: Everett) -> Everett:
    """The mirror image of a hysteresis. The mirror image of a ``Mirrored`` is its image."""
    return Mirrored(hysteresis)


@mirror_image.register
def _image(hysteresis: Mirrored) -> Everett:
    return hysteresis.image


@singledispatch
def unmirrored(hysteresis: Everett) -> Everett:
    """The hysteresis without any mirroring."""
    return hysteresis


@unmirrored.register
def _innermost(hysteresis: Mirrored) -> Everett:
    return unmirrored(hysteresis.image)
