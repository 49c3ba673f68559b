"""Bring-up checks that a console has started: each is ``smarig check`` in a process of its own, and can be stopped."""

import json
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Collection
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any

from smarig.console.command_process import process_command
from smarig.core import UsageError, printable

LONGEST_S = 900.0  # a long lease is waited for
_WAIT_S = 10.0  # for a check that is stopped to switch off
_LOOK = "Make sure that no current flows: a rig without a lease stays on."


@dataclass
class RigCheck:
    """One check. ``checks`` holds the lines of its list, ``sentence`` why it failed; ``passed`` is None meanwhile."""

    began: float = field(default_factory=time.time)
    checks: list[dict[str, Any]] = field(default_factory=list)
    sentence: str = ""
    passed: bool | None = None


class RigChecks:
    """The last check of each rig."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._checks: dict[str, RigCheck] = {}
        self._processes: dict[str, subprocess.Popen[bytes]] = {}
        self._lock = threading.Lock()

    def start(self, rig: str) -> None:
        """Bring a rig up. Raises UsageError while that is being done."""
        path = str(self._folder / rig) if rig.endswith(".toml") else rig
        with self._lock:
            if rig in self._processes:
                raise UsageError(f"{rig} is being checked already.")
            out, err = tempfile.TemporaryFile(), tempfile.TemporaryFile()  # noqa: SIM115 - closed by _wait()
            try:
                process = subprocess.Popen(
                    process_command(["smarig", "check", path, "--yes", "--json"]),
                    cwd=self._folder,
                    stdin=subprocess.DEVNULL,
                    stdout=out,  # files: a pipe would stay open for whatever a driver has started
                    stderr=err,
                    start_new_session=True,  # Ctrl-C ends the console, not what drives current
                )
            except OSError as error:
                raise UsageError(f"The check could not be started: {error.strerror or error}.") from None
            self._processes[rig], self._checks[rig] = process, RigCheck()
        threading.Thread(
            target=self._wait, args=(rig, process, out, err), name=f"check {rig}", daemon=True
        ).start()

    def of(self, rig: str) -> RigCheck | None:
        """The last check of a rig."""
        return self._checks.get(rig)

    def terminate(self, *, but: Collection[int] = ()) -> list[str]:
        """Ask every check to switch off and end, and kill one that does not react; the names of their rigs.

        ``but``: processes whose names are known already. A check is not announced in its first moments.
        """
        with self._lock:
            running = dict(self._processes)
        for process in running.values():
            threading.Thread(target=_end, args=(process,), name="end of a check", daemon=True).start()
        return [rig for rig, process in running.items() if process.pid not in but]

    def close(self) -> None:
        """End every check, its current at zero."""
        with self._lock:
            running = dict(self._processes)
        for process in running.values():
            process.terminate()
        until_s = time.monotonic() + _WAIT_S
        for rig, process in running.items():
            try:
                process.wait(max(until_s - time.monotonic(), 0.0))
            except subprocess.TimeoutExpired:
                process.kill()
                sys.stderr.write(f"smarig: The check of {rig} did not end and was killed. {_LOOK}\n")

    def _wait(self, rig: str, process: subprocess.Popen[bytes], out: IO[bytes], err: IO[bytes]) -> None:
        try:
            process.wait(LONGEST_S)
        except subprocess.TimeoutExpired:
            _end(process)
        with self._lock, out, err:
            found = self._checks[rig]
            found.checks = _checks(_text(out))
            found.sentence = "" if process.returncode == 0 else _sentence(_text(err), process.returncode)
            found.passed = process.returncode == 0
            del self._processes[rig]


def _end(process: subprocess.Popen[bytes]) -> None:
    """Ask a process to end; one that does not react is killed, which its check then says."""
    process.terminate()
    try:
        process.wait(_WAIT_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def _text(file: IO[bytes]) -> str:
    file.seek(0)
    return file.read().decode("utf-8", "replace")


def _checks(out: str) -> list[dict[str, Any]]:
    """The list of checks that the command printed; empty if it came to none."""
    try:
        found = json.loads(out.splitlines()[0])["checks"]
    except (ValueError, IndexError, KeyError, TypeError):
        return []
    return [check for check in found if isinstance(check, dict)]


def _sentence(err: str, status: int) -> str:
    if status < 0:
        return f"The process of the check was killed. {_LOOK}"
    lines = [line for line in err.splitlines() if line.startswith("smarig: ")]
    text = lines[-1].removeprefix("smarig: ") if lines else "The check ended without a result."
    return printable(text)
