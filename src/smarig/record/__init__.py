"""A run is one SQLite file: written as it happens, readable at any time, everything else derived."""

from smarig.record.recorder import Recorder
from smarig.record.run import CONTINUED, FORC_PROTOCOL, Event, Run, Step, load_run

__all__ = ["CONTINUED", "FORC_PROTOCOL", "Event", "Recorder", "Run", "Step", "load_run"]
