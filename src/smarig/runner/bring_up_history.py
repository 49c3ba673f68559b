"""A bring-up in the history of its wire: it heats the wire as a run does, and leaves it as hot.

It begins with the heat that the last run has left, and adds its cycles, hours and largest input to the figures. The
number of runs stays.
"""

from smarig.config import RigFile
from smarig.core import Sample, SmarigError, in_time
from smarig.plant import Actuator
from smarig.protocols import Setup
from smarig.record import WireHistory, load_wire_history
from smarig.rig import Bench, Guard, TwinSettings
from smarig.runner.run_metadata import outlives_session, twin_source
from smarig.runner.wire_heat import elapsed_s, heat_at_the_end, heat_left, not_written, wear_from


class BringUpHistory:
    """Follows the wire through a bring-up of a bench (``WireWatch``); ``save`` ends it."""

    def __init__(self, bench: Bench, file: RigFile, actuator: Actuator) -> None:
        self._bench, self._file, self._actuator = bench, file, actuator
        self._twin = twin_source(file, TwinSettings()) == "twin"
        self._guard: Guard | None = None
        self._last: Sample | None = None
        self._setup = Setup(actuator, file.limits, file.period_s)
        self._wear = wear_from(self._setup, 0.0)

    def begin(self, guard: Guard) -> None:
        """Start the prediction with the heat that the wire may still have."""
        self._guard = guard
        try:
            history = self._history()
        except SmarigError:  # a damaged history: ``save`` reports it
            return
        if history is not None and history.heat is not None:
            device, tick = self._bench.sensor.identity, self._bench.tick
            since_s = elapsed_s(history.heat, device, tick, self._file.period_s, twin=self._twin)
            guard.start_hot(heat_left(history.heat, self._actuator, since_s, has_lease=self._bench.has_lease))
            self._wear = wear_from(self._setup, guard.input_K)

    def add(self, sample: Sample, input_K: float) -> None:
        """Add a tick at a predicted input."""
        self._wear.add(sample.tick, input_K)
        self._last = sample

    def save(self) -> str:
        """Add the bring-up to the history, after the current was switched off; a sentence if that fails, else ""."""
        if self._guard is None or self._last is None:
            return ""
        unconfirmed = self._last if self._bench.shutdown_unconfirmed else None
        try:
            history = self._history()
            if history is not None:
                heat = heat_at_the_end(
                    self._guard, self._bench.sensor.identity, unconfirmed, self._file.lease_s
                )
                found = history.after(self._wear, new_run=False, heat=heat)
                in_time(found.save, f"The history of wire '{self._file.wire}'")
        except SmarigError as error:
            return not_written(error)
        return ""

    def _history(self) -> WireHistory | None:
        """The history of the wire; None if its devices end with the check."""
        if not outlives_session(self._file):
            return None
        wire = self._file.wire
        return in_time(lambda: load_wire_history(wire, twin=self._twin), f"The history of wire '{wire}'")
