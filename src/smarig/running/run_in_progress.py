"""Finds the runs in progress on this computer, follows them, and asks them to pause or stop.

A run lives as long as its process holds the lock of its file; the operating system releases it however the process
ends. Readers only test that lock, and write nothing but requests.
"""

import contextlib
import mmap
import os
import re
import signal
import stat
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from numpy.typing import NDArray

from smarig.core import SmarigError, UsageError, shared_lock
from smarig.running.running_folder import SUFFIX, check_own, running_folder
from smarig.running.shared_memory import REQUESTS, SIZE, SharedMemory

_NAME = re.compile(r"\d+-\w+" + re.escape(SUFFIX), re.ASCII)
_MOST = 1000  # files that are looked at
_LATEST_EPOCH = 4e9  # in the year 2096
_FACTS = {
    "pid": int,
    "start_epoch": float,
    "protocol": str,
    "rig": str,
    "wire": str,
    "source": str,
    "out": str,
}


@dataclass(frozen=True)
class RunInProgress:
    """A run of another process. ``key`` names it; ``info`` is its description: pid, start_epoch, command, protocol,
    rig, wire, source ("twin" or "bench"), two_wire, unit, period_s, steps, duration_s, out (the run file or folder),
    place, done_steps, done_s.

    Its methods raise UsageError once the run has ended.
    """

    key: str
    info: dict[str, Any]
    path: Path

    @property
    def alive(self) -> bool:
        """Whether its process lives."""
        with contextlib.suppress(OSError, UsageError), _opened(self.path) as file:
            return _is_held(file)
        return False

    def status(self) -> dict[str, Any]:
        """Its status: step_number, branch, target_K, elapsed_s, left_s, share, speed_factor, paused, stopping,
        severity, settling, last_event, error, ending. Empty in its first instant.
        """
        with self._memory() as memory:
            return memory.status()

    def samples(self, after: int = 0) -> tuple[NDArray[Any], int, int]:
        """(samples (n,) after a number, with the fields ``SAMPLE_FIELDS``; number of the newest; how many are lost).

        The last 4095 samples are kept; earlier ones are in the run file after a second at the latest.
        """
        with self._memory() as memory:
            return memory.samples(after)

    def ask(self, request: str, who: str) -> None:
        """Ask the run to "pause", "continue" or "stop"; ``who`` stands in its record. It obeys within 0.1 s."""
        if request not in REQUESTS:
            raise UsageError(f"A run can be asked to {', '.join(REQUESTS)}, not to '{request}'.")
        with self._memory() as memory:
            memory.ask(request, who)

    def terminate(self) -> None:
        """Send SIGTERM to its process, which ends the run safely even if it is computing. Nothing if it has ended."""
        with contextlib.suppress(OSError, UsageError), _opened(self.path) as file:
            if _is_held(file):
                os.kill(self.info["pid"], signal.SIGTERM)

    @contextlib.contextmanager
    def _memory(self) -> Iterator[SharedMemory]:
        with _opened(self.path) as file, _mapped(file) as memory:
            yield memory


def runs_in_progress() -> tuple[RunInProgress, ...]:
    """The runs of this user on this computer, oldest first. What is no announcement in their folder is left out."""
    found = [run for run, alive in _found() if alive]
    return tuple(sorted(found, key=lambda run: run.info["start_epoch"]))


def collect_ended() -> tuple[RunInProgress, ...]:
    """The runs whose processes ended without an end of the run (kill -9): each is told once, and its file removed."""
    return tuple(run for run, alive in _found() if not alive and _removed(run.path))


def _removed(path: Path) -> bool:
    """Whether this process removed it: of several that look at once, one tells."""
    try:
        path.unlink()
    except OSError:
        return False
    return True


def _found() -> Iterator[tuple[RunInProgress, bool]]:
    folder = running_folder()
    try:
        check_own(folder)
        paths = sorted(path for path in folder.iterdir() if _NAME.fullmatch(path.name))[:_MOST]
    except (OSError, SmarigError):
        return
    for path in paths:
        with contextlib.suppress(OSError, UsageError), _opened(path) as file, _mapped(file) as memory:
            info = memory.description()
            if _is_description(info):
                yield RunInProgress(path.stem, info, path), _is_held(file)


def _is_description(info: dict[str, Any]) -> bool:
    """Whether it has every fact, with a process that may be sent a signal and a time that can be shown."""
    plain = all(type(info.get(fact)) is kind for fact, kind in _FACTS.items())
    return plain and info["pid"] > 1 and 0 <= info["start_epoch"] < _LATEST_EPOCH


@contextlib.contextmanager
def _opened(path: Path) -> Iterator[IO[bytes]]:
    """The file of a run. Raises UsageError if it is gone or none."""
    try:
        handle = os.open(path, os.O_RDWR | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0))
    except FileNotFoundError:
        raise UsageError("This run has ended.") from None
    except OSError as error:
        raise UsageError(f"{path} cannot be opened: {error.strerror or error}.") from None
    with os.fdopen(handle, "r+b") as file:
        about = os.fstat(file.fileno())
        own = not hasattr(os, "getuid") or about.st_uid == os.getuid()
        if not (stat.S_ISREG(about.st_mode) and about.st_size == SIZE and own):
            raise UsageError(f"{path} does not announce a run.")
        yield file


@contextlib.contextmanager
def _mapped(file: IO[bytes]) -> Iterator[SharedMemory]:
    try:
        memory = SharedMemory(mmap.mmap(file.fileno(), SIZE))
    except (OSError, ValueError) as error:  # no memory, or cut in this moment
        raise UsageError(f"{file.name} cannot be read: {error}.") from None
    try:
        if not memory.valid:
            raise UsageError(f"{file.name} announces a run in another version of smarig.")
        yield memory
    finally:
        memory.close()


def _is_held(file: IO[bytes]) -> bool:
    """Whether the run holds its lock. Several readers may ask at once, so they share theirs."""
    return not shared_lock(file)
