"""Interfaces of the instruments that a bench requires: a current source and a position sensor."""

from typing import Any, NamedTuple, Protocol

from smarig.core import Quality

NO_MEASURED_CURRENT = (
    "Every limit of current and heat rests on the measured current, so a source without one is not used: put a shunt "
    "into the circuit, measure its voltage with the instrument or a meter, and return that over its resistance. The "
    "ordered current in its place would be compared with itself."
)


class CurrentReading(NamedTuple):
    """Measured values of a current source at one of its ticks.

    ``output_A`` is the current that the device was ordered to drive in that tick; None if it does not tell.
    """

    tick: int
    current_A: float
    voltage_V: float
    temperature_degC: float
    quality: Quality
    output_A: float | None = None


class PositionReading(NamedTuple):
    """Reading of an encoder at one of its ticks, counted from the last zero."""

    tick: int
    counts: int
    ambient_degC: float
    quality: Quality


class AbsoluteZero(NamedTuple):
    """Where a sensor whose zero survives a restart has its zero: its identity, and its own count there."""

    sensor: str
    counts: int


class CurrentSource(Protocol):
    """Drives a current and measures it.

    One that measures the wire temperature may limit it itself: ``holds_wire_limit`` says whether it can, and
    ``limit_wire_temperature(largest_degC)`` is called before each current that is set. ``lacks_wire_limit``: whether it
    is armed without that limit, because its thermometer gave its first reading later; it is then armed again.

    ``measured_A()`` of one that has it measures the current now, without renewing an order: at the end of a run, the
    bench confirms by it that the output has followed ``off``.
    """

    @property
    def has_lease(self) -> bool:
        """Whether it switches itself off when the host stops communicating."""
        ...

    @property
    def identity(self) -> str:
        """The device, with its make or version."""
        ...

    @property
    def tripped(self) -> str:
        """Why it has tripped, as a sentence; "" if it has not."""
        ...

    def arm(self) -> None:
        """Prepare it at zero current and clear a latched trip."""
        ...

    def set(self, current_A: float) -> int | None:
        """Apply a current from the next tick on. Returns the last tick before it, None if the device counts none."""
        ...

    def since(self, tick: int, at_most: int) -> list[CurrentReading]:
        """Readings from a tick on, in order, at most ``at_most``."""
        ...

    def tick(self) -> int:
        """The last tick of the device."""
        ...

    def off(self) -> str:
        """Set the current to zero. Never raises; returns "", or a sentence if the device did not confirm."""
        ...

    def close(self) -> None:
        """Close the line. Never raises."""
        ...


class PositionSensor(Protocol):
    """Reads a position by its own clock.

    One whose zero survives a restart has an attribute ``absolute_zero`` (AbsoluteZero); ``resume`` then relies on it.
    """

    @property
    def identity(self) -> str:
        """The device, with its make or version."""
        ...

    def since(self, tick: int, at_most: int) -> list[PositionReading]:
        """Readings from a tick on, in order, at most ``at_most``; readings that were overwritten are left out."""
        ...

    def tick(self) -> int:
        """The last tick of the device."""
        ...

    def zero(self) -> None:
        """Set the present position to 0 from the next tick on."""
        ...

    def close(self) -> None:
        """Close the line. Never raises."""
        ...


def missing_members(instrument: Any, role: type) -> list[str]:
    """Members of a role that an instrument lacks.

    >>> missing_members(object(), PositionSensor)
    ['close', 'identity', 'since', 'tick', 'zero']
    """
    wanted = {name for kind in role.__mro__ if kind is not object for name in vars(kind)}
    return sorted(name for name in wanted if not name.startswith("_") and not hasattr(instrument, name))
