"""A form of the analytic surface of your own, thesis (5.5): the shift f(α) of the first-order curves.

    f = x₅α + x₆

In this example the shift is a straight line in the reversal input α. Replace it with your law; it must be smooth.

Identify with it:  smarig identify RUN… --surface my_surface_form -o wire.model.json
Use the model:     smarig --plugin my_surface_form verify wire.model.json RUN
"""

import math
from collections.abc import Mapping
from typing import Any, ClassVar, final

import numpy as np

from smarig.preisach import Parameters, SurfaceForm


@final
class _LinearShift(SurfaceForm):
    """f(α) = x₅α + x₆. ``x`` holds x₅ and x₆; α is in kelvin above ambient."""

    powers: ClassVar[Mapping[str, int]] = {"x5": 0, "x6": 1}  # parameter: power of the input's unit
    colour = "#E69F00"  # on pages
    place = 1  # order among forms with the same number of parameters

    def value(self, x: Parameters, alpha: np.ndarray) -> np.ndarray:
        """f(α)."""
        return x[0] * alpha + x[1]

    def slope(self, x: Parameters, alpha: np.ndarray) -> np.ndarray:
        """f′(α)."""
        return np.full_like(alpha, x[0])

    def jacobian(self, x: Parameters, alpha: np.ndarray) -> np.ndarray:
        """∂f/∂x, shape (k, 2)."""
        del x
        return np.column_stack([alpha, np.ones_like(alpha)])

    @staticmethod
    def between(params: Any, alpha: float, beta: float) -> float:
        """F(α, β) for numbers. ``params``: x₂, x₃, x₄, x₅, x₆, and a quarter of the amplitude.

        Only f is specific to the form. The function is compiled by numba, so it calls nothing but math.
        """
        f, half = params[3] * alpha + params[4], 0.5 * params[2]
        rise = math.tanh(half * (alpha + f)) - math.tanh(half * (beta + f))
        return params[5] * (1.0 + math.tanh(0.5 * params[0] * (alpha + params[1]))) * rise

    def starts(self, lower: float, upper: float, fitted: Parameters) -> list[Parameters]:
        """Starting values of x₂ … x₆ for data over [u₋, u₊]. ``fitted``: all x of the form ``constant``."""
        middle = 0.5 * (lower + upper)
        return [(*fitted[:3], slope, fitted[3] - slope * middle) for slope in (-0.3, 0.0, 0.3)]


my_surface_form = _LinearShift()  # the variable has the name of the file
