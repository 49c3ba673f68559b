"""A current output that is queried, as the current source of a bench."""

import math
from typing import Literal

from smarig.core import Quality, UsageError, one_line
from smarig.device.encoding.link_faults import Garbled
from smarig.device.polled.line_counts import garbled_remedy, reconnections_of, repeats_of
from smarig.device.polled.readings import electrical_from
from smarig.device.roles.polled import CurrentOutput
from smarig.device.roles.ticked import CurrentReading

_Waiting = Literal["", "armed", "off"]  # for its first order since it was armed, or switched off


class PolledSource:
    """It counts no ticks: each query is one measurement, which belongs to the last tick that the bench asks for.

    Nobody renews a lease between opening and the first tick, nor between two runs. The output is therefore armed again
    with the first order.
    """

    def __init__(self, output: CurrentOutput) -> None:
        self.output = output
        self._repeats = repeats_of(output)
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
        """Zero current, trips cleared, watchdog and limits written. The first tick does so once more."""
        self.output.arm()
        self._waits: _Waiting = "armed"

    def set(self, current_A: float) -> None:
        """Drive a current."""
        if not math.isfinite(current_A):
            raise UsageError(f"A current of {current_A:g} A cannot be driven.")
        if self._waits:
            self._arm_again()
        if not self.tripped:
            self.output.set_current(current_A)

    @property
    def reconnections(self) -> int:
        """How often its line was lost and opened again, if it counts that."""
        return reconnections_of(self.output)

    def since(self, tick: int, at_most: int) -> list[CurrentReading]:
        """One measurement for all these ticks; all but the last are marked as stale."""
        if self._waits == "armed":
            self._arm_again()
        now = electrical_from(self.output)
        if self._waits == "off" and self.tripped:  # nothing flowed: its lease expired between two runs
            self._arm_again()
            now = electrical_from(self.output)
        self._waits = ""
        last = Quality.TRIPPED if self.tripped else Quality.GOOD
        last |= Quality.RETRIED if repeats_of(self.output) != self._repeats else Quality.GOOD
        self._repeats = repeats_of(self.output)
        marks = [Quality.STALE] * (at_most - 1) + [last]
        return [
            CurrentReading(tick + k, now.current_A, now.voltage_V, now.temperature_degC, mark)
            for k, mark in enumerate(marks)
        ]

    def measured_A(self) -> float:
        """The current that is measured now. It neither arms the output nor counts as its first tick."""
        return electrical_from(self.output).current_A

    def _arm_again(self) -> None:
        had_lease, self._waits = self.has_lease, ""
        self.output.arm()
        if had_lease and not self.has_lease:  # the limits in force are those of a rig with one
            self.off()
            raise Garbled(
                f"The lease of {self.identity} could not be armed again. {garbled_remedy(self.output)}"
            )

    def tick(self) -> int:
        """Always 0: it counts none."""
        return 0

    def off(self) -> str:
        """Zero current."""
        if not self.tripped:
            self._waits = "off"
        why = self.output.off()
        return one_line(why) if isinstance(why, str) else why  # a bench refuses what is no text

    def close(self) -> None:
        """Close the line."""
        self.output.close()
