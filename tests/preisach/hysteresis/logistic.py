"""An own surface form in one file: f = x₅σ(x₆(α + x₇)) + x₈; the curves shift by a step about −x₇."""

import math
from itertools import product
from typing import Any, final

import numpy as np

from smarig.preisach.hysteresis.surface_form import Array, Parameters, SurfaceForm

_STEEPEST = 100.0  # x₆ times the range


def _sigmoid(z: Array) -> Array:
    return 0.5 * (1.0 + np.tanh(0.5 * z))


@final
class LogisticForm(SurfaceForm):
    """f(α) = x₅σ(x₆(α + x₇)) + x₈."""

    powers = {"x5": 1, "x6": -1, "x7": 1, "x8": 1}  # noqa: RUF012
    colour = "#F0E442"
    place = 0

    def value(self, x: Parameters, alpha: Array) -> Array:
        """x₅σ(x₆(α + x₇)) + x₈."""
        return x[0] * _sigmoid(x[1] * (alpha + x[2])) + x[3]

    def slope(self, x: Parameters, alpha: Array) -> Array:
        """x₅x₆σ(1 − σ)."""
        s = _sigmoid(x[1] * (alpha + x[2]))
        return x[0] * x[1] * s * (1 - s)

    def jacobian(self, x: Parameters, alpha: Array) -> Array:
        """∂f/∂x, shape (k, 4)."""
        s = _sigmoid(x[1] * (alpha + x[2]))
        bell = x[0] * s * (1 - s)
        return np.column_stack([s, bell * (alpha + x[2]), bell * x[1], np.ones_like(alpha)])

    @staticmethod
    def between(params: Any, alpha: float, beta: float) -> float:
        """F(α, β)."""
        s = 0.5 * (1.0 + math.tanh(0.5 * params[4] * (alpha + params[5])))
        f, half = params[3] * s + params[6], 0.5 * params[2]
        rise = math.tanh(half * (alpha + f)) - math.tanh(half * (beta + f))
        return params[7] * (1.0 + math.tanh(0.5 * params[0] * (alpha + params[1]))) * rise

    def slope_turns(self, x: Parameters) -> tuple[float, ...]:
        """The middle of the step."""
        return (-x[2],)

    def starts(self, lower: float, upper: float, fitted: Parameters) -> list[Parameters]:
        """Steps of several heights, widths and places about the fitted constant."""
        span = upper - lower
        heights, widths, places = (-0.3, -0.1, 0.1, 0.3), (5.0, 15.0), (0.25, 0.5, 0.75)
        return [
            (*fitted[:3], height * span, k / span, -(lower + place * span), fitted[3] - height * span / 2)
            for height, k, place in product(heights, widths, places)
        ]

    def bounds(self, lower: float, upper: float) -> dict[str, tuple[float, float]]:
        """A step that rises with x₅ and lies near the range."""
        span = upper - lower
        return {"x6": (0.0, _STEEPEST / span), "x7": (-(upper + span), -(lower - span))}


logistic = LogisticForm()
