"""A hysteresis seen in the mirror (u, y) → (−u, −y): what FOD is for rising, FOA is for falling.

Magnetic first-order reversal curves rise from a reversal point below positive saturation: they are
FOD curves of the mirrored hysteresis. Reflection keeps the measure: F(α, β) = F̃(−β, −α).
"""

from dataclasses import dataclass
from functools import singledispatch
from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smarig.core import UsageError
from smarig.preisach.everett import Differentiable, Everett, from_diagonal


@dataclass(frozen=True, eq=False)
class Mirrored:
    """The hysteresis whose mirror image is ``image``."""

    image: Everett

    @property
    def lower(self) -> float:
        """Negative saturation: the image's positive one, reflected."""
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

    def swept(self, alpha: ArrayLike, beta: ArrayLike) -> NDArray[np.float64]:
        """F(α, β), arrays."""
        return self.image.swept(-np.asarray(beta, dtype=float), -np.asarray(alpha, dtype=float))

    @property
    def steps(self) -> NDArray[np.float64]:
        """Where F jumps, if it does: the image's thresholds, reflected."""
        return -np.asarray(getattr(self.image, "steps", ()))[::-1]

    @property
    def kinks(self) -> NDArray[np.float64]:
        """Where slopes jump: the image's kinks, reflected."""
        return -np.asarray(getattr(self.image, "kinks", ()))[::-1]

    def strip_alpha(self, alpha: ArrayLike, beta: ArrayLike) -> NDArray[np.float64]:
        """∂F/∂α: what a fall sweeps in the mirror. Only where the image has slopes."""
        return self._slopes.strip_beta(-np.asarray(beta, dtype=float), -np.asarray(alpha, dtype=float))

    def strip_beta(self, alpha: ArrayLike, beta: ArrayLike) -> NDArray[np.float64]:
        """∂y/∂β: what a rise sweeps in the mirror. Only where the image has slopes."""
        return self._slopes.strip_alpha(-np.asarray(beta, dtype=float), -np.asarray(alpha, dtype=float))

    @property
    def _slopes(self) -> Differentiable:
        if not hasattr(self.image, "strip_alpha"):
            raise UsageError(f"{type(self.image).__name__} has no slopes, nor has its mirror image.")
        return cast(Differentiable, self.image)

    def from_diagonal(self, centre: float, u: NDArray[np.float64]) -> NDArray[np.float64]:
        """Output change (signed) from B_ℓ to each input: the mirror's from B_−ℓ, reflected."""
        return -from_diagonal(self.image, -centre, -u)

    def rise_from_diagonal(self, centre: float, u: float) -> float:
        """A rise here is a fall in the mirror."""
        return self.image.fall_from_diagonal(-centre, -u)

    def fall_from_diagonal(self, centre: float, u: float) -> float:
        """A fall here is a rise in the mirror."""
        return self.image.rise_from_diagonal(-centre, -u)


@singledispatch
def mirror_image(hysteresis: Everett) -> Everett:
    """The hysteresis in the mirror; what a ``Mirrored`` mirrors, that it is not mirrored twice."""
    return Mirrored(hysteresis)


@mirror_image.register
def _image(hysteresis: Mirrored) -> Everett:
    return hysteresis.image


@singledispatch
def unmirrored(hysteresis: Everett) -> Everett:
    """What stands in the mirror, however often mirrored; else the hysteresis itself."""
    return hysteresis


@unmirrored.register
def _innermost(hysteresis: Mirrored) -> Everett:
    return unmirrored(hysteresis.image)
