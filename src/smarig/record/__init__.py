"""A run is one SQLite file: written as it happens, readable at any time, everything else derived."""

from smarig.record.recorder import Recorder
from smarig.record.run import CONTINUED, FORC_PROTOCOL, Event, Run, Step, load_run
from smarig.record.run_info import EndInfo, ImportInfo, RunInfo, SignalInfo

__all__ = [
    "CONTINUED",
    "FORC_PROTOCOL",
    "EndInfo",
    "Event",
    "ImportInfo",
    "Recorder",
    "Run",
    "RunInfo",
    "SignalInfo",
    "Step",
    "load_run",
]
