"""The process of simulated devices: its start and end, and its last words if it ends before it has started."""

import contextlib
import json
import os
import selectors
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
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
    named_lines = 0
    try:
        found = _ready(process, while_waiting)
        if found is None:
            named_lines = 1
            raise _not_started(process, _lines(messages))
        yield found
    finally:
        _stop_process(process, keep_until_lease=keep_until_lease)
        lines = _lines(messages)
        for line in lines[: len(lines) - named_lines]:
            sys.stderr.write(f"{printable(line)}\n")


def _ready(process: subprocess.Popen, while_waiting: Callable[[], None]) -> dict[str, Any] | None:
    """The line of JSON in which the devices report where they are; None if there is none."""
    line = _first_line(process, while_waiting)
    return json.loads(line) if line else None


def _not_started(process: subprocess.Popen, messages: Sequence[str]) -> RigFault | ConfigError:
    """Why there are no devices, in their last words."""
    try:
        status = process.wait(1)
    except subprocess.TimeoutExpired:
        return RigFault(f"The simulated devices did not start within {START_TIMEOUT_S:g} s.")
    last = (
        printable(messages[-1].removeprefix("Error: "), 1000).rstrip(".")
        if messages
        else "they left no message"
    )
    if status == ConfigError.exit_status:
        return ConfigError(f"The simulated devices were not started: {last}.")
    return RigFault(f"The simulated devices ended with status {status}: {last}.")


def _first_line(process: subprocess.Popen, while_waiting: Callable[[], None]) -> str:
    """The first line of their standard output; "" if they ended before, or took too long."""
    assert process.stdout is not None  # noqa: S101 - a pipe was requested
    until_s = time.monotonic() + START_TIMEOUT_S
    with selectors.DefaultSelector() as selector:
        selector.register(process.stdout, selectors.EVENT_READ)
        while time.monotonic() < until_s:
            ended = process.poll() is not None  # asked for first: what it wrote before is there
            if selector.select(_STEP_S):
                return process.stdout.readline()
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
