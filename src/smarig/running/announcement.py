"""The announcement of a run by its own process: others find it, follow its samples, and ask it to pause or stop.

The tick only copies its sample into shared memory. A thread writes the status and looks for requests ten times a
second. Nothing is locked that a reader could hold, and no socket is served, whose readers may stall. A run that cannot
be announced runs all the same, and says so.
"""

import contextlib
import mmap
import os
import struct
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any

from smarig.core import (
    Hold,
    Requester,
    Sample,
    SmarigError,
    StepResult,
    Waveform,
    entered_in_time,
    error_text,
    in_time,
    own_command,
    printable,
    try_lock,
)
from smarig.runner import CallbackListener, Listener, RunControl
from smarig.running import memory_layout as layout
from smarig.running.find_runs import collect_ended
from smarig.running.run_status import PanelRunInfo, RunStatus
from smarig.running.running_folder import SUFFIX, made_running_folder
from smarig.running.status_text import description_of, status_of

INTERVAL_S = 0.1
_FOLDER = "The folder of the runs in progress"
_FORGOTTEN_S = 86400.0  # after which the file of a killed run is removed, though nobody has asked for it
_ANNOUNCEMENT_FAILED = (OSError, SmarigError, ValueError, TypeError, struct.error)


@contextlib.contextmanager
def announced(run_info: PanelRunInfo, control: RunControl, status: RunStatus) -> Iterator[Listener]:
    """Announce a run or the check of a rig while the context lasts, and yield the listener that receives its samples.

    ``status`` is read from a thread; the display of the run keeps it up to date. ``control`` is what requests act on.
    If the run cannot be announced, its record says so, and the listener does nothing.
    """
    with contextlib.ExitStack() as stack:
        try:
            with control.undisturbed():
                in_time(lambda: collect_ended(older_than_s=_FORGOTTEN_S), _FOLDER)
                announcement = _announcement(run_info, control, status)
                listener: Listener = stack.enter_context(entered_in_time(announcement, _FOLDER))
        except _ANNOUNCEMENT_FAILED as error:
            _report(control, f"Other processes cannot see this {run_info.kind}", error)
            listener = CallbackListener()
        yield listener


class Announcement:
    """A listener that copies samples into shared memory, with a thread that writes the status and obeys requests."""

    def __init__(self, memory: mmap.mmap, status: RunStatus, control: RunControl) -> None:
        self._memory: mmap.mmap | None = memory
        self._status, self._control = status, control
        self._number = self._status_number = 0
        self._obeyed: dict[str, bytes] = {"stop": b"", "pause": b""}  # the marks of requests
        self._finished = threading.Event()
        self._thread = threading.Thread(target=self._attend, args=(memory,), name="announcement", daemon=True)

    def __enter__(self) -> "Announcement":
        self._thread.start()
        return self

    def __exit__(self, *_error: object) -> None:
        self._memory = None
        self._finished.set()
        self._thread.join()

    def sample(self, s: Sample, step: int | None, input_value: float) -> None:
        """Copy the sample."""
        if self._memory is None:
            return
        self._number = number = self._number + 1
        _, t_s, command_A, current_A, voltage_V, temperature_degC, counts, position, ambient_degC, quality = s
        try:
            _pack_record(
                self._memory,
                _RING_AT + (number % _RECORDS) * _RECORD_SIZE,
                number,
                t_s,
                -1 if step is None else step,
                command_A,
                current_A,
                voltage_V,
                input_value,
                counts,
                position,
                temperature_degC,
                ambient_degC,
                quality,
                number,
            )
            _pack_word(self._memory, _NEWEST_AT, number)
        except _ANNOUNCEMENT_FAILED as error:
            self._memory = None
            _report(self._control, "Other processes do not see further samples of this run", error)

    def begin(self, step: int, command: Hold | Waveform, window: Any) -> None:
        """Do nothing: the status knows."""

    def step(self, result: StepResult, *, branch: str, target: float | None) -> None:
        """Do nothing: the status knows."""

    def event(self, t_s: float, kind: str, text: str, *, level: str = "info", **data: Any) -> None:
        """Do nothing: the status knows."""

    def _attend(self, memory: mmap.mmap) -> None:
        while not self._finished.wait(INTERVAL_S):
            for name in self._obeyed:
                self._look_for(name, memory)
            self._write_status(memory)
        self._write_status(memory)

    def _look_for(self, name: str, memory: mmap.mmap) -> None:
        at = layout.request_at(name)
        mark, request, who, by = layout.unpacked_request(memory[at : at + layout.REQUEST_SIZE])
        if request and mark != self._obeyed[name]:
            self._obeyed[name] = mark
            self._obey(request, printable(who), by)

    def _obey(self, request: str, who: str, by: Requester) -> None:
        if request == "stop":
            self._control.stop(f"stopped by the operator ({who})", by)
            return
        self._control.paused = request == "pause"
        self._control.report("request", f"{who} asked this run to {request}.", level="info")

    def _write_status(self, memory: mmap.mmap) -> None:
        try:
            text = layout.packed_text(status_of(self._status), layout.STATUS_SIZE)
        except Exception:  # read while the run changes it; requests must be obeyed whatever the status is
            return
        number = self._status_number + 1
        at = layout.STATUS_AT + (number % 2) * layout.STATUS_SIZE
        memory[at : at + len(text)] = text
        _pack_word(memory, layout.STATUS_NUMBER_AT, number)
        self._status_number = number


# Names of this module, because the tick looks them up.
_pack_record, _pack_word = layout.RECORD.pack_into, layout.WORD.pack_into
_RING_AT, _NEWEST_AT, _RECORDS = layout.RING_AT, layout.NEWEST_AT, layout.RECORDS
_RECORD_SIZE = layout.RECORD.size


@contextlib.contextmanager
def _announcement(run_info: PanelRunInfo, control: RunControl, status: RunStatus) -> Iterator[Announcement]:
    """The file is whole and locked before it has the state of a running run, and has another one before it is removed,
    so that others never take it for that of a killed run.
    """
    facts = description_of(run_info, pid=os.getpid(), start_epoch=time.time(), command=own_command())
    description = layout.packed_text(facts, layout.DESCRIPTION_SIZE)
    handle, name = tempfile.mkstemp(prefix=f"{os.getpid()}-", suffix=SUFFIX, dir=made_running_folder())
    with contextlib.ExitStack() as stack:
        stack.callback(_remove, Path(name))
        file = stack.enter_context(os.fdopen(handle, "r+b", buffering=0))
        if not try_lock(file):
            raise OSError(f"{name} cannot be locked")
        _reserve(file)
        memory = stack.enter_context(mmap.mmap(file.fileno(), layout.SIZE))
        memory[layout.DESCRIPTION_AT : layout.DESCRIPTION_AT + len(description)] = description
        stack.callback(_set_state, memory, layout.ENDED)
        _set_state(memory, layout.RUNNING)
        yield stack.enter_context(Announcement(memory, status, control))


def _set_state(memory: mmap.mmap, state: bytes) -> None:
    layout.HEAD.pack_into(memory, 0, state, layout.VERSION, layout.RECORDS)


def _reserve(file: IO[bytes]) -> None:
    """Give the file its size and its space: a write to mapped memory for which there is no space ends the process."""
    if hasattr(os, "posix_fallocate"):
        os.posix_fallocate(file.fileno(), 0, layout.SIZE)
        return
    file.seek(0)
    if file.write(bytes(layout.SIZE)) != layout.SIZE:
        raise OSError("no space left")


def _remove(path: Path) -> None:
    with contextlib.suppress(OSError):  # Windows keeps a file that somebody has open; a finder removes it
        path.unlink()


def _report(control: RunControl, what: str, error: BaseException) -> None:
    reason = str(error) if isinstance(error, SmarigError) else error_text(error) + "."
    control.report("not_announced", f"{what}. {reason}", level="warning")
