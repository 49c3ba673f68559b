"""Interfaces of instruments that measure when they are queried and count no ticks: supplies, analogue inputs, meters.

A driver returns such an instrument as it is: the bench samples it by the clock of the host. Quantities are in SI units
with prefixes as the names say; a reading that does not exist is NaN. If the instrument has an attribute ``line`` (a
TextLine or VisaLine), samples whose query was repeated are marked, and a line that was opened again is reported.
"""

from typing import NamedTuple, Protocol

from smarig.core import NAN


class Electrical(NamedTuple):
    """One measurement of a source: current, voltage across the wire, and a wire temperature if it has one.

    The current must be measured: every limit rests on it, and a source that returns NaN is not used.
    """

    current_A: float
    voltage_V: float
    temperature_degC: float = NAN


class PolledInstrument(Protocol):
    """What every instrument has."""

    @property
    def identity(self) -> str:
        """Make, model and serial number, in one line."""
        ...

    def close(self) -> None:
        """Close the line. Never raises."""
        ...


class PolledOutput(PolledInstrument, Protocol):
    """What current and voltage outputs share."""

    @property
    def has_lease(self) -> bool:
        """Whether its watchdog is armed, read back, and sets the output to zero when the host stops communicating."""
        ...

    @property
    def tripped(self) -> str:
        """Why it has switched itself off, as a sentence; "" if it has not."""
        ...

    def arm(self) -> None:
        """Output off, a latched trip cleared, limits and watchdog written and read back."""
        ...

    def measure(self) -> Electrical:
        """Measure now."""
        ...

    def off(self) -> str:
        """Output to zero. Never raises; returns "", or a sentence if the instrument did not confirm."""
        ...


class CurrentOutput(PolledOutput, Protocol):
    """A current source, or a voltage or PWM source with a current loop of its own."""

    def set_current(self, current_A: float) -> None:
        """Drive a current, and read the setting back. Raises LinkFault if it is not accepted, UsageError for NaN."""
        ...


class VoltageOutput(PolledOutput, Protocol):
    """A voltage source or PWM stage without a current loop; ``CurrentLoop`` makes a current output of it."""

    def set_voltage(self, voltage_V: float) -> None:
        """Apply a voltage, and read the setting back. Raises LinkFault if it is not accepted, UsageError for NaN."""
        ...


class PositionInput(PolledInstrument, Protocol):
    """A position in counts or in a unit: encoder counter, laser, LVDT, potentiometer, magnetic angle sensor.

    One whose zero survives a restart says so by an attribute ``absolute = True``; ``resume`` then relies on it.
    """

    @property
    def unit(self) -> str:
        """ "count", "mm" or "deg"."""
        ...

    def position(self) -> float:
        """The position now, in ``unit``; NaN if the sensor sees nothing or is out of range."""
        ...


class TemperatureInput(PolledInstrument, Protocol):
    """A thermometer: of the wire or of the room, as the rig file says."""

    def temperature_degC(self) -> float:
        """The temperature now; NaN without a reading."""
        ...


class ForceInput(PolledInstrument, Protocol):
    """A load cell in line with the wire."""

    def force_N(self) -> float:
        """The force now, positive when the wire is pulled; NaN without a reading."""
        ...
