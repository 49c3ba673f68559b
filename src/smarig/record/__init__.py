"""A run is one SQLite file: written as it happens, readable at any time, everything else derived."""

from smarig.record.recorder import Recorder
from smarig.record.run import CONTINUED, Event, Run, Step, load_run

__all__ = ["CONTINUED", "Event", "Recorder", "Run", "Step", "load_run"]
