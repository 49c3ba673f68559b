"""The record of a run: one SQLite file, written during the run and readable at any time."""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.record import schema as schema
    from smarig.record.any_run import AnyRun as AnyRun
    from smarig.record.clock_watch import ClockWatch as ClockWatch
    from smarig.record.continuation import Continuation as Continuation
    from smarig.record.continued_run import continues_run as continues_run
    from smarig.record.counted_rows import counted as counted
    from smarig.record.counted_rows import suspect_rows as suspect_rows
    from smarig.record.counted_rows import void_rows as void_rows
    from smarig.record.guarded_database import SIDECARS as SIDECARS
    from smarig.record.guarded_database import check_sidecars as check_sidecars
    from smarig.record.guarded_database import restrict as restrict
    from smarig.record.import_finding import FindingKind as FindingKind
    from smarig.record.import_finding import ImportFinding as ImportFinding
    from smarig.record.import_finding import remarks as remarks
    from smarig.record.last_heat import LastHeat as LastHeat
    from smarig.record.metadata import is_timestamp as is_timestamp
    from smarig.record.new_run_file import write_run as write_run
    from smarig.record.recorder import Recorder as Recorder
    from smarig.record.recording_lock import check_not_recording as check_not_recording
    from smarig.record.recording_lock import is_recording as is_recording
    from smarig.record.recording_lock import recording as recording
    from smarig.record.run import ABSOLUTE_ZERO as ABSOLUTE_ZERO
    from smarig.record.run import CONTINUED as CONTINUED
    from smarig.record.run import FORC_PROTOCOL as FORC_PROTOCOL
    from smarig.record.run import OWN_ZERO as OWN_ZERO
    from smarig.record.run import Event as Event
    from smarig.record.run import Run as Run
    from smarig.record.run import Runs as Runs
    from smarig.record.run import Step as Step
    from smarig.record.run import load_run as load_run
    from smarig.record.run import loaded_runs as loaded_runs
    from smarig.record.run_check import RunCheck as RunCheck
    from smarig.record.run_check import check_run as check_run
    from smarig.record.run_info import EndInfo as EndInfo
    from smarig.record.run_info import ImportInfo as ImportInfo
    from smarig.record.run_info import RunInfo as RunInfo
    from smarig.record.run_info import SignalInfo as SignalInfo
    from smarig.record.run_of_arrays import run_of_arrays as run_of_arrays
    from smarig.record.salvage import Salvaged as Salvaged
    from smarig.record.salvage import salvage as salvage
    from smarig.record.salvage import write_salvaged as write_salvaged
    from smarig.record.same_readings import check_no_copies as check_no_copies
    from smarig.record.same_readings import same_readings as same_readings
    from smarig.record.sample_columns import LARGEST as LARGEST
    from smarig.record.schema import SAMPLE_COLUMNS as SAMPLE_COLUMNS
    from smarig.record.stopped_by import StoppedBy as StoppedBy
    from smarig.record.stored_run import StoredRun as StoredRun
    from smarig.record.stored_run import stored_run as stored_run
    from smarig.record.wire_history import COLD as COLD
    from smarig.record.wire_history import HOT as HOT
    from smarig.record.wire_history import Wear as Wear
    from smarig.record.wire_history import WireHistory as WireHistory
    from smarig.record.wire_history import load_wire_history as load_wire_history
    from smarig.record.wire_history import wire_histories as wire_histories
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
