"""Real runs in processes of their own, and the folder in which they announce themselves."""

import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from smarig.running import RunInProgress, runs_in_progress

PATIENCE_S = 120.0  # far more than a slow machine needs; a test that passes does not wait


def wait_for(found: Callable[[], Any], process: subprocess.Popen | None = None) -> Any:
    """What ``found`` returns, once it is true. Fails if the process ends first."""
    end_s = time.monotonic() + PATIENCE_S
    while time.monotonic() < end_s:
        if got := found():
            return got
        assert process is None or process.poll() is None, "the run ended early"
        time.sleep(0.02)
    raise AssertionError("nothing came")


@contextmanager
def started(
    out: Path, *options: str, protocol: str = "validation", words: Sequence[str] = ()
) -> Iterator[subprocess.Popen]:
    """A run on the twin, started as a user starts it; its messages are in ``out`` with the suffix .err.

    ``words``: another command than that of the protocol.
    """
    what = words or ("run", protocol)
    command = [sys.executable, "-m", "smarig", *what, "--rig", "one_wire_twin", "-o", str(out)]
    with (
        out.with_suffix(".err").open("w") as messages,
        subprocess.Popen([*command, *options], stdout=subprocess.DEVNULL, stderr=messages) as process,
    ):
        try:
            yield process
        finally:
            process.kill()


def announced_run(process: subprocess.Popen) -> RunInProgress:
    """The run of a process, when it has taken a sample."""

    def found() -> RunInProgress | None:
        return next(
            (r for r in runs_in_progress() if r.info["pid"] == process.pid and r.samples().newest), None
        )

    return wait_for(found, process)


def files(folder: Path) -> list[str]:
    """The names in a folder."""
    return sorted(path.name for path in folder.iterdir())
