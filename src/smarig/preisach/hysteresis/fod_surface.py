"""The thesis's analytic first-order-descending surface (5.5) with every derivative in closed form.

    y(α, β) = y₋ + (y₊ − y₋) · s(α, β) / s(u₊, u₊)
    s(α, β) = σ(x₂(α + x₃)) · [σ(x₄(β + f(α))) − σ(x₄(u₋ + f(α)))],     σ(z) = 1/(1 + e⁻ᶻ)

which is (5.5) with its exponentials combined into sigmoids. f is that of a form in ``forms/``.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from smarig.core import Array, UsageError
from smarig.preisach.everett import DiagonalIntegrals
from smarig.preisach.hysteresis.surface_form import SurfaceForm, surface_form
from smarig.preisach.kernel import INPUTS_AS_KEYS, KeyedEverett, input_as_keys, inputs_as_keys


def sigmoid(z: ArrayLike) -> Array:
    """σ(z) = 1/(1 + e⁻ᶻ), without overflow for any z."""
    return 0.5 * (1.0 + np.tanh(0.5 * np.asarray(z, dtype=float)))


@dataclass(frozen=True)
class FodSurface(DiagonalIntegrals):
    """Analytic FOD surface y(α, β), thesis (5.5).

    ``form`` names the form of f; ``x`` are x₂, x₃, x₄ and the form's own parameters. ``lower`` and ``upper`` are the
    smallest and largest identification input; ``y_lower`` and ``y_upper`` the outputs at negative and positive
    saturation. Inputs α ≥ β are in kelvin above ambient, outputs in ``unit``. All methods broadcast.

    >>> from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
    >>> one_e = thesis_surface("one_e")
    >>> float(one_e.y(174.1, 174.1)), float(one_e.y(90.0, 0.0))
    (12.54, 0.0)
    """

    form: str
    x: tuple[float, ...]
    lower: float
    upper: float
    y_lower: float
    y_upper: float
    unit: str = ""

    def __post_init__(self) -> None:
        names = self.surface_form.parameters
        if len(self.x) != len(names):
            raise UsageError(f"A {self.form} surface has parameters {', '.join(names)}; got {len(self.x)}.")
        numbers = (*self.x, self.lower, self.upper, self.y_lower, self.y_upper)
        try:
            finite = bool(np.isfinite(numbers).all())
        except TypeError:  # text or None
            finite = False
        if not finite:
            raise UsageError(f"A {self.form} surface has a parameter that is not a finite number: {numbers}.")
        if not self.upper > self.lower:
            raise UsageError(f"Surface range is empty: lower {self.lower} ≥ upper {self.upper}.")

    @property
    def kinks(self) -> Array:
        """Inputs at which derivatives jump: none."""
        return np.empty(0)

    # --- parts of the formula ---------------------------------------------------------------------

    @property
    def surface_form(self) -> SurfaceForm:
        """The form of f. UsageError if no form has that name."""
        return surface_form(self.form)

    def shift(self, alpha: ArrayLike) -> tuple[Array, Array]:
        """f(α) and f′(α)."""
        return self._shift(alpha), self.surface_form.slope(self.x[3:], np.asarray(alpha, dtype=float))

    def _shift(self, alpha: ArrayLike) -> Array:
        return self.surface_form.value(self.x[3:], np.asarray(alpha, dtype=float))

    @property
    def amplitude(self) -> float:
        """c = (y₊ − y₋)/s(u₊, u₊). UsageError if s(u₊, u₊) = 0, because then nothing can be scaled to y₊ − y₋."""
        height = float(self.shape(self.upper, self.upper))
        if height == 0:  # checked only on use, because a fit may pass through such parameters
            raise UsageError(
                f"A {self.form} surface with x = {self.x} has no amplitude: its shape s(u₊, u₊) is zero, so (5.5) "
                "is not defined."
            )
        return (self.y_upper - self.y_lower) / height

    def shape(self, alpha: Array | float, beta: Array | float) -> Array:
        """s(α, β), dimensionless."""
        x2, x3, x4 = self.x[:3]
        f = self._shift(alpha)
        return sigmoid(x2 * (alpha + x3)) * (sigmoid(x4 * (beta + f)) - sigmoid(x4 * (self.lower + f)))

    # --- values and derivatives ---------------------------------------------------------------------

    def y(self, alpha: Array | float, beta: Array | float) -> Array:
        """y(α, β): output after negative saturation → α → β."""
        return self.y_lower + self.amplitude * self.shape(alpha, beta)

    def strip_beta(self, alpha: Array | float, beta: Array | float) -> Array:
        """∂y/∂β: output per kelvin of a falling input."""
        x2, x3, x4 = self.x[:3]
        f = self._shift(alpha)
        s = sigmoid(x4 * (beta + f))
        return self.amplitude * sigmoid(x2 * (alpha + x3)) * x4 * s * (1 - s)

    def slope_alpha(self, alpha: Array | float, beta: Array | float) -> Array:
        """∂y/∂α: output per kelvin of the earlier peak."""
        x2, x3, x4 = self.x[:3]
        f, df = self.shift(alpha)
        a = sigmoid(x2 * (alpha + x3))
        s, s0 = sigmoid(x4 * (beta + f)), sigmoid(x4 * (self.lower + f))
        return self.amplitude * a * (x2 * (1 - a) * (s - s0) + x4 * df * (s * (1 - s) - s0 * (1 - s0)))

    def strip_alpha(self, alpha: Array | float, beta: Array | float) -> Array:
        """∂F/∂α with F = y(α, α) − y(α, β): output per kelvin of an input that rises from β."""
        on_diagonal = self.slope_alpha(alpha, alpha) + self.strip_beta(alpha, alpha)
        return on_diagonal - self.slope_alpha(alpha, beta)

    def density(self, alpha: Array | float, beta: Array | float) -> Array:
        """μ(α, β) = ½ ∂²y/∂α∂β (3.5), output per K². The thesis prints it without the ½ (theory.md §8.3)."""
        x2, x3, x4 = self.x[:3]
        f, df = self.shift(alpha)
        a, s = sigmoid(x2 * (alpha + x3)), sigmoid(x4 * (beta + f))
        bell = x4 * s * (1 - s)
        return 0.5 * self.amplitude * a * bell * (x2 * (1 - a) + x4 * df * (1 - 2 * s))

    def reversible(self, beta: Array | float) -> Array:
        """g(β) = ∂y/∂β(β, β): density of the degenerate relays on α = β, output per kelvin."""
        return self.strip_beta(beta, beta)

    # --- interface to the operator --------------------------------------------------------------------

    @cached_property
    def keyed(self) -> KeyedEverett:
        """For the loop: inputs are their own keys, and F is in closed form."""
        params = (*map(float, self.x), 0.25 * self.amplitude)
        return KeyedEverett(self.surface_form.between, params, input_as_keys, inputs_as_keys, INPUTS_AS_KEYS)

    def everett(self, alpha: float, beta: float) -> float:
        """F(α, β) = y(α, α) − y(α, β), scalar.

        >>> from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
        >>> s = thesis_surface("two_c")
        >>> abs(s.everett(90.0, -20.0) - float(s.y(90.0, 90.0) - s.y(90.0, -20.0))) < 1e-13
        True
        """
        k = self.keyed
        return k.between(k.params, alpha, beta)

    def swept(self, alpha: ArrayLike, beta: ArrayLike) -> Array:
        """F(α, β) for arrays, by the same products as ``everett``."""
        a, b = np.asarray(alpha, dtype=float), np.asarray(beta, dtype=float)
        x2, x3, half = self.x[0], self.x[1], 0.5 * self.x[2]
        f = self._shift(a)
        rise = np.tanh(half * (a + f)) - np.tanh(half * (b + f))
        return 0.25 * self.amplitude * (1.0 + np.tanh(0.5 * x2 * (a + x3))) * rise
