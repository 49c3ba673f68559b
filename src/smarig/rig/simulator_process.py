"""The process of simulated devices: its start and end, and its last words if it ends before it has started."""

import contextlib
import json
import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from queue import Empty, Queue
from typing import Any

from smarig.core import ConfigError, RigFault, printable, shipped

START_TIMEOUT_S = 60.0  # for simulated devices to start
STOP_TIMEOUT_S = 10.0  # for simulated devices to end
_STEP_S = 0.1  # until the end of the process, or a stop of the run, is noticed


@contextmanager
def running_devices(
    command: Sequence[str], messages: Path, while_waiting: Callable[[], None], *, keep_until_lease: bool
) -> Iterator[dict[str, Any]]:
    """The addresses of devices while the process of a module with these arguments runs.

    ``messages``: a new file for its standard error. ``while_waiting`` may raise, so that a stop does not wait for
    the start. ``keep_until_lease``: the process keeps a trace, so it ends when the lease has switched off the current.
    """
    search = [str(shipped("simulators").parent), os.environ.get("PYTHONPATH", "")]
    with messages.open("xb") as stderr:
        process = subprocess.Popen(
            [sys.executable, "-P", "-m", *command],  # no file of this folder is a module
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=stderr,
            text=True,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, search))},
            start_new_session=os.name != "nt",  # Ctrl-C is handled by this process
        )
    shown = 0
    try:
        found = _ready(process, while_waiting)
        if "error" in found:
            shown = 1  # its last line says the same
            raise ConfigError(f"The simulated devices were not started: {printable(found['error'], 1000)}")
        yield found
    except _NotReady:
        lines, shown = _lines(messages), 1
        raise _not_started(process, lines[-1] if lines else "they left no message") from None
    finally:
        _stop_process(process, keep_until_lease=keep_until_lease)
        lines = _lines(messages)
        for line in lines[: len(lines) - shown]:
            sys.stderr.write(f"{printable(line)}\n")


class _NotReady(Exception):
    """The devices ended, or took too long, before they said where they are."""


def _ready(process: subprocess.Popen, while_waiting: Callable[[], None]) -> dict[str, Any]:
    """The line of JSON in which the devices report where they are, or the error for which there are none."""
    line = _first_line(process, while_waiting)
    if not line:
        raise _NotReady
    return json.loads(line)


def _not_started(process: subprocess.Popen, last: str) -> RigFault:
    """Why there are no devices, in their last words."""
    try:
        status = process.wait(1)
    except subprocess.TimeoutExpired:
        return RigFault(f"The simulated devices did not start within {START_TIMEOUT_S:g} s.")
    return RigFault(f"The simulated devices ended with status {status}: {printable(last, 1000).rstrip('.')}.")


def _first_line(process: subprocess.Popen, while_waiting: Callable[[], None]) -> str:
    """The first line of their standard output; "" if they ended before, or took too long."""
    assert process.stdout is not None  # noqa: S101 - a pipe was requested
    output: Queue[str] = Queue()
    read = process.stdout.readline
    threading.Thread(target=lambda: output.put(read()), name="simulated devices", daemon=True).start()
    until_s = time.monotonic() + START_TIMEOUT_S
    while time.monotonic() < until_s:
        ended = process.poll() is not None  # asked for first: what it wrote before is there
        try:
            return output.get(timeout=_STEP_S)
        except Empty:
            if ended:  # another process may hold its output open
                return ""
        while_waiting()
    return ""


def _lines(messages: Path) -> list[str]:
    try:
        text = messages.read_text(encoding="utf-8", errors="replace")
    except OSError:  # removed with the folder of temporary files
        return []
    return [line.rstrip() for line in text.splitlines() if line.strip()]


def _stop_process(process: subprocess.Popen, *, keep_until_lease: bool) -> None:
    """Close their input. Devices that keep a trace keep running until the lease has switched off the current."""
    if not keep_until_lease:
        with contextlib.suppress(OSError):
            process.terminate()
    for pipe in (process.stdin, process.stdout):
        if pipe is not None:
            with contextlib.suppress(OSError):
                pipe.close()
    try:
        process.wait(STOP_TIMEOUT_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
