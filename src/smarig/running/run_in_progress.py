"""A run of another process: its description, status and samples, and requests to it.

The process holds a lock of the operating system on its file as long as it lives, so no process number is guessed at.
Readers read the file and never map it: a file that is cut while it is read gives an error, not a signal. Windows, which
lets nobody cut a mapped file, promises equal contents to mappings only.
"""

import contextlib
import mmap
import os
import signal
import stat
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from smarig.core import Requester, UsageError, shared_lock, try_lock
from smarig.running import memory_layout as layout

_TRIES = 5  # at a status that is being written


class NewSamples(NamedTuple):
    """Samples (structured, fields of ``SAMPLES``), the number of the newest one, and how many of the wanted ones were
    overwritten before they were read."""

    samples: NDArray[Any]
    newest: int
    lost: int


@dataclass(frozen=True)
class RunInProgress:
    """A run of another process. ``key`` names it and is never used again; ``info`` is its description.

    ``info`` has pid, start_epoch, command, protocol, rig, wire, source ("twin" or "bench"), two_wire, unit, period_s,
    steps, duration_s, out (absolute path of the run file or folder), place ("run 2 of 7" or ""), done_steps, done_s
    (what a resumed run had finished before), limits (of the rig file, in force), kind ("run", or "check" for the
    bring-up of a rig, whose out is "") and folder (absolute, the one that it belongs to). ``status``, ``samples`` and
    ``ask`` raise UsageError when the run has ended.
    """

    key: str
    info: dict[str, Any]
    path: Path

    @property
    def is_check(self) -> bool:
        """Whether it is the bring-up of a rig, which takes no samples and can only be stopped."""
        return self.info.get("kind") == "check"

    @property
    def alive(self) -> bool:
        """Whether its process still carries out this run."""
        with contextlib.suppress(OSError, UsageError), opened(self.path) as file:
            return file.state == layout.RUNNING and file.is_held()
        return False

    def status(self) -> dict[str, Any]:
        """Its status, at most 0.1 s old: step_number, branch, target_K, elapsed_s (since the start, or since it was
        resumed), left_s, share, speed_factor, resumed, paused, stopping, severity, settling (share, spread_counts,
        band_counts, min_time_left_s, timeout_s; or None),
        last_event and error (t_s, level, kind, text, severity; or None) and ending (kind, word, text; or None).

        Empty in its first 0.1 s. An infinite number is None.
        """
        with self._opened() as file:
            return file.status()

    def samples(self, after: int = 0) -> NewSamples:
        """The samples after the one of a number, as far as they are kept: 4096. Samples are numbered from 1.

        ``found, newest, lost = run.samples(newest)`` at least every minute misses none at 50 samples per second.
        """
        with self._opened() as file:
            return file.samples(max(after, 0))

    def ask(self, request: str, who: str, by: Requester = Requester.PROGRAM) -> None:
        """Ask the run to "pause", "continue" or "stop". It obeys within 0.1 s, at its next tick; ``who`` is recorded in
        the cause of its end, and ``by`` as the kind of the one who asked.

        A stop is never lost. Of two requests to pause or continue within 0.1 s only the later one counts.
        """
        if request not in layout.REQUESTS:
            raise UsageError(f"A run can be asked to pause, continue or stop, not to '{request}'.")
        if self.is_check and request != "stop":
            raise UsageError(f"A check of a rig can be asked to stop, not to {request}.")
        with self._opened() as file:
            if not file.is_held():
                raise UsageError(_ENDED)
            file.write(layout.request_at(request), layout.packed_request(os.urandom(8), request, who, by))

    def terminate(self) -> None:
        """Send SIGTERM to its process, which then ends the run safely even while a protocol computes.

        Nothing is sent when the run has ended. On Windows, where this would end the process at once, the run is asked
        to stop.
        """
        if os.name == "nt":
            with contextlib.suppress(UsageError):
                self.ask("stop", "another process")
            return
        with contextlib.suppress(OSError, UsageError), opened(self.path) as file:
            if file.state == layout.RUNNING and file.is_held():
                os.kill(self.info["pid"], signal.SIGTERM)

    @contextlib.contextmanager
    def _opened(self) -> Iterator["AnnouncedFile"]:
        try:
            with opened(self.path) as file:
                if file.state != layout.RUNNING:
                    raise UsageError(_ENDED)
                yield file
        except OSError:
            raise UsageError(_ENDED) from None


_ENDED = "This run has ended."


class AnnouncedFile:
    """The file of a run, opened by another process."""

    def __init__(self, file: IO[bytes]) -> None:
        self._file = file
        self._map = mmap.mmap(file.fileno(), layout.SIZE) if not hasattr(os, "pread") else None

    def close(self) -> None:
        """End the mapping, if there is one."""
        if self._map is not None:
            self._map.close()

    def read(self, at: int, size: int) -> bytes:
        """Raises UsageError if the file was cut."""
        handle = self._file.fileno()
        found = self._map[at : at + size] if self._map is not None else os.pread(handle, size, at)
        if len(found) != size:
            raise UsageError(_ENDED)
        return found

    def write(self, at: int, content: bytes) -> None:
        """Write at once, so that two who ask do not mix."""
        if self._map is not None:
            self._map[at : at + len(content)] = content
        else:
            os.pwrite(self._file.fileno(), content, at)

    def is_held(self) -> bool:
        """Whether the process of the run lives. Readers share their lock, so they do not deceive each other."""
        return not shared_lock(self._file)

    def lock_alone(self) -> bool:
        """Lock the file of a dead process against others who find it, until it is closed. Whether that succeeded."""
        return try_lock(self._file)

    @property
    def state(self) -> bytes:
        """The state of the run; b"" for a file that is no announcement, or one of another version."""
        state, version, records = layout.HEAD.unpack(self.read(0, layout.HEAD.size))
        return state if (version, records) == (layout.VERSION, layout.RECORDS) else b""

    def description(self) -> dict[str, Any]:
        """The description of the run; empty if it is damaged."""
        return layout.unpacked_text(self.read(layout.DESCRIPTION_AT, layout.DESCRIPTION_SIZE))

    def status(self) -> dict[str, Any]:
        """The last status; empty before the first."""
        for _ in range(_TRIES):
            number = self._word(layout.STATUS_NUMBER_AT)
            at = layout.STATUS_AT + (number % 2) * layout.STATUS_SIZE
            if found := layout.unpacked_text(self.read(at, layout.STATUS_SIZE)):
                return found
        return {}

    def samples(self, after: int) -> NewSamples:
        """The samples after a number."""
        newest = max(self._word(layout.NEWEST_AT), after)
        first = max(after, newest - layout.RECORDS) + 1
        numbers = np.arange(first, newest + 1, dtype=np.uint64)
        found, again = self._records(first, newest), self._records(first, newest)
        # The writer writes the number first. If it is the same after the record was read, the record was whole.
        whole = (
            (found["number"] == numbers) & (found["number_again"] == numbers) & (again["number"] == numbers)
        )
        kept = found[whole][list(layout.SAMPLES.names or ())].astype(layout.SAMPLES)
        return NewSamples(kept, newest, newest - after - len(kept))

    def _records(self, first: int, last: int) -> NDArray[Any]:
        """The records of samples ``first`` to ``last``, at most one round of the ring."""
        start, count = first % layout.RECORDS, last - first + 1
        before_end = min(count, layout.RECORDS - start)
        parts = [self.read(layout.record_at(first), before_end * layout.RECORD.size)]
        if count > before_end:
            parts.append(self.read(layout.RING_AT, (count - before_end) * layout.RECORD.size))
        return np.frombuffer(b"".join(parts), dtype=layout.STORED)

    def _word(self, at: int) -> int:
        return layout.WORD.unpack(self.read(at, layout.WORD.size))[0]


@contextlib.contextmanager
def opened(path: Path) -> Iterator[AnnouncedFile]:
    """The file of a run. Raises OSError, or UsageError if it is another user's or of another size."""
    flags = (getattr(os, name, 0) for name in ("O_NOFOLLOW", "O_NONBLOCK", "O_BINARY", "O_CLOEXEC"))
    handle = os.open(path, os.O_RDWR | sum(flags))
    with os.fdopen(handle, "r+b", buffering=0) as raw:
        found = os.fstat(handle)
        own = not hasattr(os, "getuid") or found.st_uid == os.getuid()
        if not (own and stat.S_ISREG(found.st_mode) and found.st_size == layout.SIZE):
            raise UsageError(f"{path} does not announce a run.")
        file = AnnouncedFile(raw)
        try:
            yield file
        finally:
            file.close()
