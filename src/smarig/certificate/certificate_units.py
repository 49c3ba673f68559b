"""Units of certified quantities, derived from those of output and input."""

from dataclasses import dataclass

from smarig.preisach import Everett

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Units:
    """Units of output and input; "" for an unknown unit and for all that depend on it.

    >>> units = Units("mm", "K")
    >>> units.energy, units.gain, units.rate, units.density
    ('mm·K', 'K·s/mm', 'mm/s', 'mm/K²')
    """

    output: str = ""
    input: str = ""

    @classmethod
    def of(cls, hysteresis: Everett) -> "Units":
        """The units of a hysteresis; the input is in kelvin if the output has a unit."""
        unit = getattr(hysteresis, "unit", "")
        return cls(unit, "K") if unit else cls()

    @property
    def energy(self) -> str:
        """Unit of ∫ u dy."""
        return f"{self.output}·{self.input}" if self._both_known else ""

    @property
    def gain(self) -> str:
        """Unit of δ and γ: input per output velocity."""
        return f"{self.input}·s/{self.output}" if self._both_known else ""

    @property
    def rate(self) -> str:
        """Unit of ṙ and ė."""
        return f"{self.output}/s" if self.output else ""

    @property
    def density(self) -> str:
        """Unit of μ."""
        return f"{self.output}/{self.input}²" if self._both_known else ""

    @property
    def slope(self) -> str:
        """Unit of g."""
        return f"{self.output}/{self.input}" if self._both_known else ""

    @property
    def _both_known(self) -> bool:
        return bool(self.output and self.input)


UNKNOWN = Units()


def with_unit(value: float, unit: str = "", digits: int = 4) -> str:
    """A number with its unit, if known.

    >>> with_unit(-0.25, "mm·K"), with_unit(1e6), with_unit(2.0)
    ('−0.25 mm·K', '10⁶', '2')
    """
    return f"{_written(value, digits)} {unit}".rstrip()


def _written(value: float, digits: int) -> str:
    """A number with a true minus sign and a written power of ten."""
    mantissa, _, exponent = f"{value:.{digits}g}".partition("e")
    power = f"10{str(int(exponent)).translate(_RAISED)}" if exponent else ""
    times = " × " if power and mantissa not in ("1", "-1") else ""
    return f"{mantissa if times or not power else mantissa[:-1]}{times}{power}".replace("-", "−")
