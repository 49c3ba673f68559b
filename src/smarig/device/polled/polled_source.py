"""A current output that is queried, as the current source of a bench."""

import math

from smarig.core import Quality, UsageError
from smarig.device.roles.polled import CurrentOutput
from smarig.device.roles.ticked import CurrentReading


class PolledSource:
    """It counts no ticks: each query is one measurement, which belongs to the last tick that the bench asks for."""

    def __init__(self, output: CurrentOutput) -> None:
        self.output = output
        self.arm()

    @property
    def identity(self) -> str:
        """The instrument."""
        return self.output.identity

    @property
    def has_lease(self) -> bool:
        """Whether its watchdog is armed and was read back."""
        return self.output.has_lease

    @property
    def tripped(self) -> str:
        """Why it has switched itself off; "" if it has not."""
        return self.output.tripped

    def arm(self) -> None:
        """Zero current, trips cleared, watchdog and limits written."""
        self.output.arm()

    def set(self, current_A: float) -> None:
        """Drive a current."""
        if not math.isfinite(current_A):
            raise UsageError(f"A current of {current_A:g} A cannot be driven.")
        if not self.tripped:
            self.output.set_current(current_A)

    @property
    def reconnections(self) -> int:
        """How often its line was lost and opened again, if it counts that."""
        return int(getattr(self.output, "reconnections", 0))

    def since(self, tick: int, at_most: int) -> list[CurrentReading]:
        """One measurement for all these ticks; all but the last are marked as stale."""
        now = self.output.measure()
        last = Quality.TRIPPED if self.tripped else Quality.GOOD
        marks = [Quality.STALE] * (at_most - 1) + [last]
        return [
            CurrentReading(tick + k, now.current_A, now.voltage_V, now.temperature_degC, mark)
            for k, mark in enumerate(marks)
        ]

    def tick(self) -> int:
        """Always 0: it counts none."""
        return 0

    def off(self) -> str:
        """Zero current."""
        return self.output.off()

    def close(self) -> None:
        """Close the line."""
        self.output.close()
