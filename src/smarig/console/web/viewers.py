"""Viewers of runs that the console has started: each is ``smarig view`` in a process that ends with the console."""

import os
import re
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from smarig.console.command_process import process_command
from smarig.core import printable
from smarig.live import parent_death_signal

LONGEST_S = 30.0  # until the viewer has shown the run; it may take longer, but the page does not wait
_LASTS_S = 1.0  # a viewer that cannot open its window ends within this time
_STEP_S = 0.1
_ADDRESS = re.compile(r"http://127\.0\.0\.1:\d+/\S*")
_SHOWN = "Everything is shown"
_SCREENS = ("DISPLAY", "WAYLAND_DISPLAY")


@dataclass(frozen=True)
class ViewerState:
    """What a page shows of a viewer: its address if it is in a browser, or the sentence of its error."""

    address: str = ""
    error: str = ""


class Viewers:
    """At most one viewer of each run file."""

    def __init__(self) -> None:
        self._started: dict[Path, _Viewer] = {}

    def start(self, file: Path) -> None:
        """Start the viewer of a run, unless it is open. For the main thread only: the viewer ends with its thread."""
        viewer = self._started.get(file)
        if viewer is None or not viewer.is_open:
            self._started[file] = _Viewer(file)

    def wait(self, file: Path) -> None:
        """Wait until its viewer has shown the run or has ended, but not for ever."""
        if file in self._started:
            self._started[file].wait()

    def state(self, file: Path) -> ViewerState | None:
        """The state of the viewer of a run; None if none was started, or if a person has closed it."""
        viewer = self._started.get(file)
        return viewer.state if viewer else None

    def close(self) -> None:
        """End all viewers."""
        for viewer in self._started.values():
            viewer.end()


class _Viewer:
    """One process of ``smarig view``; what it prints goes to a file, which never blocks it."""

    def __init__(self, file: Path) -> None:
        self._output: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 - closed by end()
        command = ["smarig", "view", str(file), *([] if _has_screen() else ["--web"])]
        self._process = subprocess.Popen(
            [*parent_death_signal(), *process_command(command)],
            cwd=file.parent,
            stdin=subprocess.DEVNULL,
            stdout=self._output,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )

    @property
    def is_open(self) -> bool:
        return self._process.poll() is None

    @property
    def state(self) -> ViewerState | None:
        if self.is_open:
            found = _ADDRESS.search(self._text)
            return ViewerState(address=found[0] if found else "")
        lines = [line.removeprefix("smarig: ") for line in self._text.splitlines() if line.strip()]
        if self._process.returncode in (0, None) and _SHOWN in self._text:
            return None
        return ViewerState(error=printable(lines[-1] if lines else "The viewer ended without a message."))

    def wait(self) -> None:
        until_s = time.monotonic() + LONGEST_S
        while self.is_open and _SHOWN not in self._text and time.monotonic() < until_s:
            time.sleep(_STEP_S)
        until_s = time.monotonic() + _LASTS_S
        while self.is_open and time.monotonic() < until_s:
            time.sleep(_STEP_S)

    def end(self) -> None:
        """Ask it to end, which closes what it shows; end it if it does not."""
        self._process.terminate()
        try:
            self._process.wait(5)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._output.close()

    @property
    def _text(self) -> str:
        return os.pread(self._output.fileno(), 100_000, 0).decode("utf-8", "replace")


def _has_screen() -> bool:
    return not sys.platform.startswith("linux") or any(os.environ.get(name) for name in _SCREENS)
