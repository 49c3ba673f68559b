"""Linear position controllers that are dissipative to the supply rate of thesis §9.2, in closed form.

The thesis defines w_c(u, y) = −a²⟨y, y⟩ + (b² − c²)⟨u, u⟩ − ⟨u̇, y⟩ with the controller's own input u and output y. It
matches the plant's ⟨u, ẏ⟩ when the loop adds: u_c = y_p − r, y_c = u_p. Then ⟨u_p, ẏ_p⟩ = ⟨y_c, u̇_c⟩ cancels the last
term, and a plant with the rate ⟨u, ẏ⟩ − b²⟨y, y⟩ leaves −a²⟨u_p, u_p⟩ − c²⟨y_p, y_p⟩ of the two. A controller K of the
usual form, u_p = K(r − y_p), is −K here: −⟨u̇, −Ku⟩ has the density Re (jω)^* K = ω Im K, and

    w_c ↔ Π(ω) = −a²|K(jω)|² + (b² − c²) + ω Im K(jω) ≥ 0 for all ω                              (*)

|D|²Π is a polynomial in ω². Its sign is decided at its turning points, not by sampling. For b = c, (*) is exact from
rest up to every T. With a = 0 and K(0) ≥ 0 it means that K(s)/s is positive real. With a > 0 it requires K(0) = 0, and
the time after T only reduces the supply. For b ≠ c it is necessary. At ω = 0 it reads |K(0)| ≤ √(b² − c²)/a;
docs/explanation/control_findings.md gives the consequence for a hysteresis, for which b = 0 if any. The condition
does not prove stability.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import ArrayLike, NDArray

from smarig.control import not_negative
from smarig.core import Array, UsageError

_ORDER = 2
_ROUNDING = 1e-12


@dataclass(frozen=True)
class SupplyRate:
    """The constants of w_c, which contains their squares. Raises UsageError unless they are finite and not negative."""

    a: float = 0.0
    b: float = 0.0
    c: float = 0.0

    def __post_init__(self) -> None:
        for name in ("a", "b", "c"):
            not_negative(name, getattr(self, name))


@dataclass(frozen=True)
class PositionController:
    """K(s) = numerator/denominator, coefficients of 1, s, s²; from position error to input.

    >>> lead = PositionController.of([10.0, 20.0], [1.0, 0.5])          # 10 (1 + 2s)/(1 + s/2)
    >>> lead.matches(SupplyRate()), lead.matches(SupplyRate(a=0.1))
    (True, False)
    """

    numerator: tuple[float, ...]
    denominator: tuple[float, ...]

    @classmethod
    def of(cls, numerator: Sequence[float], denominator: Sequence[float] = (1.0,)) -> "PositionController":
        """A checked controller: finite, at most of second order, proper except for a PD."""
        n, d = tuple(map(float, numerator)), tuple(map(float, denominator))
        if not (n and d and np.isfinite([*n, *d]).all() and d[-1] != 0 and len(d) <= _ORDER + 1):
            raise UsageError(
                "A position controller needs finite coefficients and may be at most of second order."
            )
        if len(np.trim_zeros(n, "b")) > len(d) + 1:
            raise UsageError("A position controller may differentiate its error at most once.")
        return cls(n, d)

    @classmethod
    def parse(cls, text: str) -> "PositionController":
        """From text "numerator/denominator", coefficients of 1, s, s² with commas. Raises UsageError for other text.

        >>> PositionController.parse("10,20/1,0.5").denominator
        (1.0, 0.5)
        """
        numerator, _, denominator = text.partition("/")
        try:
            n, d = ([float(c) for c in part.split(",")] for part in (numerator, denominator or "1"))
        except ValueError:
            raise UsageError(
                f"'{text}' is not a K(s). Give numerator/denominator as coefficients of 1, s, s², as in 10,20/1,0.5."
            ) from None
        return cls.of(n, d)

    def to_json(self) -> dict[str, Any]:
        """Coefficients, whether it matches a = b = c = 0, and the largest a it matches (None: any)."""
        largest = self.largest_a()
        return {
            "numerator": list(self.numerator),
            "denominator": list(self.denominator),
            "matches": self.matches(SupplyRate()),
            "largest_a": largest if np.isfinite(largest) else None,
        }

    @property
    def text(self) -> str:
        """The result of §9.2, in a sentence."""
        name = "K(s) = ({})/({})".format(
            *(", ".join(f"{c:g}" for c in part) for part in (self.numerator, self.denominator))
        )
        if not self.matches(SupplyRate()):
            return f"Position controller {name}: not in the class of §9.2."
        return (
            f"Position controller {name}: in the marginal class of §9.2 (a = b = c = 0); largest a "
            f"{self.largest_a():.3g}."
        )

    @property
    def static_gain(self) -> float:
        """K(0); infinite with an integral."""
        return self.numerator[0] / self.denominator[0] if self.denominator[0] else np.inf

    @property
    def stable(self) -> bool:
        """Whether all poles are in the left half-plane."""
        return bool(np.all(np.real(Polynomial(self.denominator).roots()) < 0))

    def at(self, omega: ArrayLike) -> NDArray[np.complex128]:
        """K(jω)."""
        s = 1j * np.asarray(omega, dtype=float)
        return Polynomial(self.numerator)(s) / Polynomial(self.denominator)(s)

    def density(self, omega: ArrayLike, supply: SupplyRate) -> Array:
        """Π(ω) of (*)."""
        k, w = self.at(omega), np.asarray(omega, dtype=float)
        return -(supply.a**2) * np.abs(k) ** 2 + supply.b**2 - supply.c**2 + w * np.imag(k)

    def matches(self, supply: SupplyRate) -> bool:
        """Whether Π ≥ 0 for all ω, the controller is stable, and K(0) ≥ 0."""
        return self.stable and self.static_gain >= 0 and _never_negative(self._cleared_density(supply))

    def largest_a(self, b: float = 0.0, c: float = 0.0) -> float:
        """The largest a that ``matches`` with b and c, by bisection; 0 if none does."""
        if not self.matches(SupplyRate(0.0, b, c)):
            return 0.0
        low, high = 0.0, 1.0
        while self.matches(SupplyRate(high, b, c)):
            low, high = high, 2 * high
            if high > 1e12:
                return np.inf
        for _ in range(80):
            middle = (low + high) / 2
            low, high = (middle, high) if self.matches(SupplyRate(middle, b, c)) else (low, middle)
        return low

    def _cleared_density(self, supply: SupplyRate) -> Polynomial:
        """|D(jω)|² Π as a polynomial in ω²."""
        (nr, ni), (dr, di) = _real_and_imaginary(self.numerator), _real_and_imaginary(self.denominator)
        omega = Polynomial([0.0, 1.0])
        cleared = (
            -(supply.a**2) * (nr**2 + ni**2)
            + (supply.b**2 - supply.c**2) * (dr**2 + di**2)
            + omega * (ni * dr - nr * di)
        )
        return Polynomial(cleared.coef[::2])


def _real_and_imaginary(coefficients: Sequence[float]) -> tuple[Polynomial, Polynomial]:
    """Real and imaginary part of a polynomial at jω, in ω."""
    real = [c * (1, 0, -1, 0)[k % 4] for k, c in enumerate(coefficients)]
    imaginary = [c * (0, 1, 0, -1)[k % 4] for k, c in enumerate(coefficients)]
    return Polynomial(real), Polynomial(imaginary)


def _never_negative(p: Polynomial) -> bool:
    """p(x) ≥ 0 for all x ≥ 0, checked at 0, at its turning points and at infinity."""
    largest = np.abs(p.coef).max()
    if largest == 0:
        return True
    p = p.trim(_ROUNDING * largest)
    turns = p.deriv().roots() if p.degree() > 0 else np.zeros(0)
    x, off = np.real(turns), np.abs(np.imag(turns))
    at = [0.0, *x[(off <= 1e-9 * (1 + np.abs(x))) & (x > 0)]]
    sizes = Polynomial(np.abs(p.coef))
    return bool(p.coef[-1] > 0 and all(p(x) >= -_ROUNDING * sizes(x) for x in at))
