"""The interface that twin and bench share."""

from typing import NamedTuple, Protocol

from smarig.core import Sample


class Alarm(NamedTuple):
    """A message of a rig besides its samples: level (info, warning, error), kind, one sentence."""

    level: str
    kind: str
    text: str
    doubtful_from: int | None = None
    """The tick since which the readings contradict each other, if it is known."""


class Rig(Protocol):
    """A rig executes commands tick by tick.

    ``step`` sends a current and returns the samples that have arrived since, in tick order (one from a twin, several
    if a bench reads its ring in a block). At most ``at_most`` ticks pass meanwhile, unless time passes by itself.
    ``safe`` sets the current to zero, never raises, and may be called repeatedly. A time without commands longer than
    the lease has the same effect.
    """

    @property
    def period_s(self) -> float:
        """Length of a tick."""
        ...

    @property
    def tick(self) -> int:
        """The tick of the last sample."""
        ...

    @property
    def position_per_count(self) -> float:
        """mm or degrees of one count."""
        ...

    @property
    def shutdown_unconfirmed(self) -> str:
        """Why a device may still be on, as a sentence; "" if it confirmed that it is off."""
        ...

    def step(self, current_A: float, at_most: int = 1) -> tuple[Sample, ...]:
        """Apply a current from the next tick on. Raises RigFault if the rig has tripped or is lost."""
        ...

    def zero(self) -> None:
        """Zero the incremental encoder at its present position."""
        ...

    def safe(self) -> None:
        """Set the current to zero. Never raises; idempotent."""
        ...

    def arm(self) -> None:
        """Clear a latched trip; the current stays at zero until the next step."""
        ...

    def alarms(self) -> list[Alarm]:
        """Alarms since the last call."""
        ...

    def close(self) -> None:
        """Close the devices. Never raises."""
        ...
