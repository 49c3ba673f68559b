"""f = x₅e^(−x₆α) + x₇, thesis (5.5): the shift of the curves approaches a constant as their reversal input rises."""

import math
from collections.abc import Mapping
from itertools import product
from typing import Any, ClassVar, final

import numpy as np

from smarig.preisach.hysteresis.surface_form import Array, Parameters, SurfaceForm

_LARGEST_EXPONENT = 40.0


@final
class ExponentialForm(SurfaceForm):
    """f(α) = x₅e^(−x₆α) + x₇."""

    powers: ClassVar[Mapping[str, int]] = {"x5": 1, "x6": -1, "x7": 1}
    colour = "#E69F00"
    place = 1

    def value(self, x: Parameters, alpha: Array) -> Array:
        """x₅e^(−x₆α) + x₇."""
        return x[0] * np.exp(-x[1] * alpha) + x[2]

    def slope(self, x: Parameters, alpha: Array) -> Array:
        """−x₆x₅e^(−x₆α)."""
        return -x[1] * (x[0] * np.exp(-x[1] * alpha))

    def jacobian(self, x: Parameters, alpha: Array) -> Array:
        """(e^(−x₆α), −x₅αe^(−x₆α), 1), shape (k, 3)."""
        decay = np.exp(-x[1] * alpha)
        return np.column_stack([decay, -x[0] * alpha * decay, np.ones_like(alpha)])

    @staticmethod
    def between(params: Any, alpha: float, beta: float) -> float:
        """F(α, β)."""
        f, half = params[3] * math.exp(-params[4] * alpha) + params[5], 0.5 * params[2]
        rise = math.tanh(half * (alpha + f)) - math.tanh(half * (beta + f))
        return params[6] * (1.0 + math.tanh(0.5 * params[0] * (alpha + params[1]))) * rise

    def starts(self, lower: float, upper: float, fitted: Parameters) -> list[Parameters]:
        """f = constant + offset·e^(−x₆(α − u₋)), with several offsets at u₋ and several decays of either sign."""
        span = upper - lower
        guesses: list[Parameters] = []
        offsets, decays, levels = (-0.3, -0.1, 0.1, 0.3, 1.0), (-2.0, 1.0, 4.0, 12.0), (-0.05, 0.0, 0.05)
        for offset, decay, level in product(offsets, decays, levels):
            x6 = decay / span
            at_edge = lower if decay > 0 else upper  # input at which the exponential is largest
            x5 = offset * span * float(np.exp(x6 * at_edge))
            guesses.append((*fitted[:3], x5, x6, fitted[3] + level * span))
        return guesses

    def bounds(self, lower: float, upper: float) -> dict[str, tuple[float, float]]:
        """|x₆| small enough that e^(−x₆α) stays finite."""
        reach = _LARGEST_EXPONENT / max(abs(lower), abs(upper), upper - lower)
        return {"x6": (-reach, reach)}


exponential = ExponentialForm()
