"""The seam between experiments and whatever carries them out: twin or bench, one shape.

Refuses to know protocols and files.
"""

from typing import NamedTuple, Protocol

from smarig.core import Sample


class Alarm(NamedTuple):
    """What a rig has to say beside its samples: severity (info, warning, error), kind, one sentence."""

    level: str
    kind: str
    text: str


class Rig(Protocol):
    """A rig: one verb moves it one tick, one makes it safe.

    ``step`` sends a current and returns the samples that have arrived since (one for a twin; several
    when a bench reads its ring in a block), in tick order; no more than ``at_most`` ticks pass meanwhile,
    unless time passes by itself. ``safe`` brings the current to zero, never raises, and may be called any
    number of times. Silence longer than the lease does the same.
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
        """Why a device may not know that it is to be off, a sentence; "" where it does."""
        ...

    def step(self, current_A: float, at_most: int = 1) -> tuple[Sample, ...]:
        """Apply a current from the next tick on; raises RigFault when tripped or lost."""
        ...

    def zero(self) -> None:
        """Zero the relative encoder where it stands."""
        ...

    def safe(self) -> None:
        """Current to zero. Never raises; idempotent."""
        ...

    def arm(self) -> None:
        """Clear a latched trip; the current stays at zero until the next step."""
        ...

    def alarms(self) -> list[Alarm]:
        """What happened since this was last asked."""
        ...

    def close(self) -> None:
        """Let go of the devices. Never raises."""
        ...
