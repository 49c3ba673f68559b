"""A run in a process of its own, in folders of its own, and waiting for what it does."""

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from smarig.running import RunInProgress, runs_in_progress

LONGEST_S = 90.0  # on a loaded machine
VALIDATION = ("run", "validation", "--rig", "one_wire_twin", "--speed", "20", "--set", "points=3")


def waited(found: Callable[[], Any], what: str) -> Any:
    """The first true value of ``found``."""
    end = time.monotonic() + LONGEST_S
    while time.monotonic() < end:
        if value := found():
            return value
        time.sleep(0.02)
    raise AssertionError(f"not within {LONGEST_S:g} s: {what}")


@contextmanager
def started_run(folder: Path, *arguments: str, **variables: str) -> Iterator[subprocess.Popen]:
    """``python -m smarig ARGUMENTS`` in a folder; killed at the end if it still runs."""
    process = subprocess.Popen(
        [sys.executable, "-m", "smarig", *(arguments or (*VALIDATION, "-o", "a.run.sqlite"))],
        cwd=folder,
        env={**os.environ, **variables},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


def found_run(process: subprocess.Popen) -> RunInProgress:
    """The announcement of a process that has its first samples."""

    def found() -> RunInProgress | None:
        assert process.poll() is None, process.communicate()
        own = [run for run in runs_in_progress() if run.info["pid"] == process.pid]
        return own[0] if own and own[0].samples()[1] else None

    return waited(found, "the announcement of the run")
