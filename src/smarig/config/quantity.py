"""A physical quantity of a configuration file: value, unit and source, in the unit that its key requires."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import AfterValidator

from smarig.core import Number, TomlTable


class Quantity(TomlTable):
    """A physical quantity: value, unit and source."""

    value: Number  # the number
    unit: str  # the unit that the key requires
    source: str  # where the value comes from: a paper, a data sheet, a calibration

    def __float__(self) -> float:
        return self.value


@dataclass(frozen=True)
class InUnit:
    """Requires one unit."""

    unit: str

    def __call__(self, q: Quantity) -> Quantity:
        if q.unit != self.unit:
            raise ValueError(f"unit is '{q.unit}', expected '{self.unit}'")
        return q


@dataclass(frozen=True)
class PositiveIn(InUnit):
    """Requires a positive value in one unit."""

    def __call__(self, q: Quantity) -> Quantity:
        super().__call__(q)
        if q.value <= 0:
            raise ValueError(f"value {q.value:g} must be positive")
        return q


@dataclass(frozen=True)
class NotNegativeIn(InUnit):
    """Requires zero or a positive value in one unit."""

    def __call__(self, q: Quantity) -> Quantity:
        super().__call__(q)
        if q.value < 0:
            raise ValueError(f"value {q.value:g} must not be negative")
        return q


Millimetres = Annotated[Quantity, AfterValidator(PositiveIn("mm"))]
Ohms = Annotated[Quantity, AfterValidator(PositiveIn("ohm"))]
Kelvin = Annotated[Quantity, AfterValidator(PositiveIn("K"))]
Amperes = Annotated[Quantity, AfterValidator(PositiveIn("A"))]
Density = Annotated[Quantity, AfterValidator(PositiveIn("kg/m^3"))]
SpecificHeat = Annotated[Quantity, AfterValidator(PositiveIn("J/(kg K)"))]
