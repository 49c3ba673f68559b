"""The seam between experiments and whatever carries them out: twin or bench, one shape.

Refuses to know protocols and files.
"""

from typing import Protocol

from smarig.sample import Sample


class Rig(Protocol):
    """A rig: one verb moves it one tick, one makes it safe.

    ``step`` sends a current and returns the samples that have arrived since (one for a twin; several
    when a bench reads its ring in a block), in tick order. ``safe`` brings the current to zero, never
    raises, and may be called any number of times. Silence longer than the lease does the same.
    """

    @property
    def period_s(self) -> float:
        """Length of a tick."""
        ...

    def step(self, current_A: float) -> tuple[Sample, ...]:
        """Apply a current from the next tick on; raises RigFault when tripped or lost."""
        ...

    def zero(self) -> None:
        """Zero the relative encoder where it stands."""
        ...

    def safe(self) -> None:
        """Current to zero. Never raises; idempotent."""
        ...
