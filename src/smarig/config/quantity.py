"""A physical quantity of a configuration file: value, unit and source, in the unit that its key requires."""

import math
from collections.abc import Iterator
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

    @property
    def of_template(self) -> bool:
        """Whether it is still that of ``smarig new actuator``, and so of another wire."""
        return self.source.startswith("replace:")


@dataclass(frozen=True)
class InUnit:
    """Requires one unit, and a value that some wire or mechanism could have."""

    unit: str
    least: float = -math.inf
    most: float = math.inf

    def __call__(self, q: Quantity) -> Quantity:
        if q.unit != self.unit:
            raise ValueError(f"unit is '{q.unit}', expected '{self.unit}'")
        return q

    def _plausible(self, q: Quantity) -> Quantity:
        if not self.least <= q.value <= self.most:
            raise ValueError(f"value {q.value:g} must lie between {self.least:g} and {self.most:g}")
        return q


@dataclass(frozen=True)
class PositiveIn(InUnit):
    """Requires a positive value in one unit."""

    def __call__(self, q: Quantity) -> Quantity:
        super().__call__(q)
        if q.value <= 0:
            raise ValueError(f"value {q.value:g} must be positive")
        return self._plausible(q)


@dataclass(frozen=True)
class NotNegativeIn(InUnit):
    """Requires zero or a positive value in one unit."""

    def __call__(self, q: Quantity) -> Quantity:
        super().__call__(q)
        if q.value < 0:
            raise ValueError(f"value {q.value:g} must not be negative")
        return self._plausible(q)


@dataclass(frozen=True)
class WithinIn(InUnit):
    """Requires a value of either sign within bounds in one unit."""

    def __call__(self, q: Quantity) -> Quantity:
        return self._plausible(super().__call__(q))


Millimetres = Annotated[Quantity, AfterValidator(PositiveIn("mm", 1e-4, 1e6))]
PulleyRadius = Annotated[Quantity, AfterValidator(PositiveIn("mm", 1e-2, 1e3))]
Ohms = Annotated[Quantity, AfterValidator(PositiveIn("ohm", 1e-4, 1e6))]
Kelvin = Annotated[Quantity, AfterValidator(PositiveIn("K", 1.0, 5000.0))]
Amperes = Annotated[Quantity, AfterValidator(PositiveIn("A", 1e-6, 1e4))]
Density = Annotated[Quantity, AfterValidator(PositiveIn("kg/m^3", 1.0, 1e5))]
SpecificHeat = Annotated[Quantity, AfterValidator(PositiveIn("J/(kg K)", 1.0, 1e6))]


def template_values(table: TomlTable, within: str = "") -> Iterator[str]:
    """The keys of the quantities of a file that nobody has replaced, such as "wire.diameter"."""
    for name, value in table:
        if isinstance(value, Quantity):
            if value.of_template:
                yield f"{within}{name}"
        elif isinstance(value, TomlTable):
            yield from template_values(value, f"{within}{name}.")
