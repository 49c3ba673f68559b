"""What a bench needs of instruments: something that drives a current, something that reads a position."""

from typing import Any, NamedTuple, Protocol

from smarig.core import Quality


class CurrentReading(NamedTuple):
    """What a current source measured in one of its ticks."""

    tick: int
    current_A: float
    voltage_V: float
    temperature_degC: float
    quality: Quality


class PositionReading(NamedTuple):
    """What an encoder read in one of its ticks, counted from the last zero."""

    tick: int
    counts: int
    ambient_degC: float
    quality: Quality


class CurrentSource(Protocol):
    """Drives a current, and says what became of it."""

    @property
    def has_lease(self) -> bool:
        """Whether it switches itself off when the host falls silent."""
        ...

    @property
    def identity(self) -> str:
        """Which device it is, of which make or version."""
        ...

    @property
    def tripped(self) -> str:
        """Why it has switched itself off, a sentence; "" where it has not."""
        ...

    def arm(self) -> None:
        """Get ready at zero current; a latched trip is cleared."""
        ...

    def set(self, current_A: float) -> int | None:
        """A current from the next tick on; the last tick before it, None where it counts none."""
        ...

    def since(self, tick: int, at_most: int) -> list[CurrentReading]:
        """Readings from a tick on, as many as there are, in order."""
        ...

    def tick(self) -> int:
        """The last tick it has."""
        ...

    def off(self) -> str:
        """Current to zero. Never raises; "", or a sentence where the device could not be told."""
        ...

    def close(self) -> None:
        """Let go of the line. Never raises."""
        ...


class PositionSensor(Protocol):
    """Reads a position by its own clock."""

    @property
    def identity(self) -> str:
        """Which device it is, of which make or version."""
        ...

    def since(self, tick: int, at_most: int) -> list[PositionReading]:
        """Readings from a tick on, as many as there are, in order; what it no longer has is left out."""
        ...

    def tick(self) -> int:
        """The last tick it has."""
        ...

    def zero(self) -> None:
        """Where it stands is 0 from the next tick on."""
        ...

    def close(self) -> None:
        """Let go of the line. Never raises."""
        ...


def missing_members(instrument: Any, role: type) -> list[str]:
    """What a bench will ask of a role, and an instrument does not have.

    >>> missing_members(object(), PositionSensor)
    ['close', 'identity', 'since', 'tick', 'zero']
    """
    wanted = (name for name in vars(role) if not name.startswith("_"))
    return sorted(name for name in wanted if not hasattr(instrument, name))
