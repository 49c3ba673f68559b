"""f = x₅α² + x₆α + x₇, thesis (5.5): the shift of the curves is a parabola in their reversal input."""

import math
from collections.abc import Mapping
from itertools import product
from typing import Any, ClassVar, final

import numpy as np

from smarig.preisach.hysteresis.surface_form import Array, Parameters, SurfaceForm


@final
class ParabolicForm(SurfaceForm):
    """f(α) = x₅α² + x₆α + x₇."""

    powers: ClassVar[Mapping[str, int]] = {"x5": -1, "x6": 0, "x7": 1}
    colour = "#CC79A7"
    place = 0

    def value(self, x: Parameters, alpha: Array) -> Array:
        """(x₅α + x₆)α + x₇."""
        return (x[0] * alpha + x[1]) * alpha + x[2]

    def slope(self, x: Parameters, alpha: Array) -> Array:
        """2x₅α + x₆."""
        return 2 * x[0] * alpha + x[1]

    def jacobian(self, x: Parameters, alpha: Array) -> Array:
        """(α², α, 1), shape (k, 3)."""
        del x
        return np.column_stack([alpha * alpha, alpha, np.ones_like(alpha)])

    @staticmethod
    def between(params: Any, alpha: float, beta: float) -> float:
        """F(α, β)."""
        f, half = (params[3] * alpha + params[4]) * alpha + params[5], 0.5 * params[2]
        rise = math.tanh(half * (alpha + f)) - math.tanh(half * (beta + f))
        return params[6] * (1.0 + math.tanh(0.5 * params[0] * (alpha + params[1]))) * rise

    def value_turns(self, x: Parameters) -> tuple[float, ...]:
        """The vertex −x₆/(2x₅). A straight line has it at infinity."""
        return (-x[1] / (2 * x[0]) if x[0] != 0.0 else math.inf,)

    def starts(self, lower: float, upper: float, fitted: Parameters) -> list[Parameters]:
        """f through given values at u₋, in the middle and at u₊, as offsets from the fitted constant."""
        span = upper - lower
        nodes = np.array([lower, lower + span / 2, upper])
        offsets = [k * span for k in (-0.1, 0.0, 0.1, 0.3)]
        guesses: list[Parameters] = [(*fitted[:3], 0.0, 0.0, fitted[3])]
        for left, bend, right in product(offsets, (-0.1 * span, 0.0), offsets):
            x5, x6, x7 = np.polyfit(nodes, fitted[3] + np.array([left, bend, right]), 2)
            guesses.append((*fitted[:3], float(x5), float(x6), float(x7)))
        return guesses


parabolic = ParabolicForm()
