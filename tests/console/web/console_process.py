"""A ``smarig console`` process for tests, with locks, wire histories and announcements of its own."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path


class ConsoleProcess:
    """``with ConsoleProcess(folder) as console``: ``address`` carries the token."""

    def __init__(self, folder: Path, *arguments: str) -> None:
        self.folder = folder / "runs"
        own = {f"SMARIG_{name}_DIR": str(folder / name.lower()) for name in ("LOCK", "HISTORY", "RUNNING")}
        command = [
            sys.executable,
            "-m",
            "smarig",
            "console",
            "--folder",
            str(self.folder),
            "--no-browser",
            "--json",
        ]
        self._process = subprocess.Popen(
            [*command, *arguments],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            text=True,
            env=os.environ | own,
        )

    def __enter__(self) -> "ConsoleProcess":
        assert self._process.stdout is not None
        self.address = json.loads(self._process.stdout.readline())["address"]
        return self

    def __exit__(self, *error: object) -> None:
        self._process.terminate()
        self._process.communicate(timeout=60)
        for pid in _processes_of(self.folder):  # its worker and a run, which a console leaves alone
            os.kill(pid, signal.SIGTERM)

    @property
    def pid(self) -> int:
        """The number of the process."""
        return self._process.pid


def _processes_of(folder: Path) -> list[int]:
    """The processes whose command names a folder, which is that of one test only."""
    found = []
    for place in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            words = place.read_bytes().split(b"\0")
        except OSError:  # it has ended
            continue
        if any(word.startswith(os.fsencode(folder)) for word in words):
            found.append(int(place.parent.name))
    return found
