"""f = x₅, thesis (5.5): all first-order curves have the same shape."""

import math
from collections.abc import Mapping
from itertools import product
from typing import Any, ClassVar, final

import numpy as np

from smarig.preisach.hysteresis.surface_form import Array, Parameters, SurfaceForm


@final
class ConstantForm(SurfaceForm):
    """f(α) = x₅."""

    powers: ClassVar[Mapping[str, int]] = {"x5": 1}
    colour = "#56B4E9"
    place = 0
    grows_from = None

    def value(self, x: Parameters, alpha: Array) -> Array:
        """x₅."""
        return np.full_like(alpha, x[0])

    def slope(self, x: Parameters, alpha: Array) -> Array:
        """0."""
        del x
        return np.zeros_like(alpha)

    def jacobian(self, x: Parameters, alpha: Array) -> Array:
        """(1), shape (k, 1)."""
        del x
        return np.ones_like(alpha)[:, None]

    @staticmethod
    def between(params: Any, alpha: float, beta: float) -> float:
        """F(α, β)."""
        f, half = params[3], 0.5 * params[2]
        rise = math.tanh(half * (alpha + f)) - math.tanh(half * (beta + f))
        return params[4] * (1.0 + math.tanh(0.5 * params[0] * (alpha + params[1]))) * rise

    def starts(self, lower: float, upper: float, fitted: Parameters) -> list[Parameters]:
        """Three slopes and four centres of each sigmoid, in all combinations."""
        del fitted
        span = upper - lower
        steep = [k / span for k in (5.0, 10.0, 20.0)]
        centres = [-(lower + k * span) for k in (0.15, 0.3, 0.5, 0.7)]
        return list(product(steep, centres, steep, centres))


constant = ConstantForm()
