"""The announcement of a run by its own process: other processes can find it, follow its samples, and ask it to stop.

The tick only copies its sample into shared memory. A thread writes the status and looks for requests ten times a
second. A run that cannot be announced runs all the same, and says so.
"""

import contextlib
import mmap
import os
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any

from smarig.core import Hold, Sample, SmarigError, StepResult, Waveform, error_text, printable, try_lock
from smarig.runner import RunControl, SettleWindow
from smarig.running.run_in_progress import collect_ended
from smarig.running.run_status import PanelRunInfo, RunStatus
from smarig.running.running_folder import SUFFIX, made_running_folder
from smarig.running.shared_memory import SIZE, SharedMemory
from smarig.running.status_text import description_of, status_of

INTERVAL_S = 0.1


@contextlib.contextmanager
def announced(run_info: PanelRunInfo, control: RunControl) -> Iterator["Announcement | None"]:
    """Yield the listener that announces a run, or None if it cannot be announced; the record says why."""
    with contextlib.ExitStack() as stack:
        try:
            collect_ended()
            announcement = stack.enter_context(_announcement(run_info, control))
        except (OSError, ValueError, TypeError, SmarigError) as error:
            text = f"Other processes cannot see this run: {error_text(error)}"
            control.report("not_announced", text, level="warning")
            announcement = None
        yield announcement


class Announcement:
    """A listener that copies samples into shared memory, and a thread that tells the status and obeys requests."""

    def __init__(self, memory: SharedMemory, status: RunStatus, control: RunControl) -> None:
        self._memory, self._status, self._control = memory, status, control
        self._seen = memory.requests()
        self._finished = threading.Event()
        self._thread = threading.Thread(target=self._attend, name="announcement", daemon=True)

    def __enter__(self) -> "Announcement":
        self._memory.write_status(status_of(self._status))
        self._thread.start()
        return self

    def __exit__(self, *_error: object) -> None:
        self._finished.set()
        self._thread.join()

    def sample(self, s: Sample, step: int | None, input_value: float) -> None:
        """Copy the sample."""
        self._status.sample(s, step, input_value)
        self._memory.add(
            s.t_s,
            -1 if step is None else step,
            s.current_command_A,
            s.current_A,
            s.voltage_V,
            input_value,
            s.counts,
            s.position,
            s.temperature_degC,
            s.ambient_degC,
            s.quality,
        )

    def begin(self, step: int, command: Hold | Waveform, window: SettleWindow) -> None:
        """Note the step for the status."""
        self._status.begin(step, command, window)

    def step(self, result: StepResult, *, branch: str, target: float | None) -> None:
        """Note the step for the status."""
        self._status.step(result, branch=branch, target=target)

    def event(self, t_s: float, kind: str, text: str, *, level: str = "info", **data: Any) -> None:
        """Note the event for the status."""
        self._status.event(t_s, kind, text, level=level, **data)

    def _attend(self) -> None:
        while not self._finished.wait(INTERVAL_S):
            requests = self._memory.requests()
            for (number, request, who), (seen, _, _) in zip(requests, self._seen):
                if number != seen:
                    self._obey(request, printable(who))
            self._seen = requests
            with contextlib.suppress(Exception):  # a figure that cannot be told now must not end obedience
                self._memory.write_status(status_of(self._status))

    def _obey(self, request: str, who: str) -> None:
        if request == "stop":
            self._control.stop(f"stopped by the operator ({who})")
        elif request in ("pause", "continue"):
            self._control.report("request", f"Asked to {request} by {who}.", level="info")
            self._control.paused = request == "pause"


@contextlib.contextmanager
def _announcement(run_info: PanelRunInfo, control: RunControl) -> Iterator[Announcement]:
    """The file appears under its name when it is whole and locked; it is removed at the end."""
    folder = made_running_folder()
    handle, name = tempfile.mkstemp(prefix=f"{os.getpid()}-", suffix=".new", dir=folder)
    path = Path(name)
    with os.fdopen(handle, "r+b") as file, contextlib.ExitStack() as stack:
        stack.callback(_remove, path)
        _reserve(file)
        memory = SharedMemory(mmap.mmap(file.fileno(), SIZE))
        stack.callback(memory.close)
        try_lock(file)
        memory.prepare(description_of(run_info, pid=os.getpid(), start_epoch=time.time(), command=sys.argv))
        public = path.with_suffix(SUFFIX)
        path.rename(public)
        stack.callback(_remove, public)
        status = RunStatus(run_info, control)
        yield stack.enter_context(Announcement(memory, status, control))


def _reserve(file: IO[bytes]) -> None:
    """Give the file its size and its blocks: a hole that a full disk cannot fill would end the process when written."""
    if hasattr(os, "posix_fallocate"):
        os.posix_fallocate(file.fileno(), 0, SIZE)
    else:
        file.write(bytes(SIZE))
        file.flush()


def _remove(path: Path) -> None:
    with contextlib.suppress(OSError):
        path.unlink()
