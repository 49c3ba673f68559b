"""The layout of the memory that a running run shares with other processes: one mapped file of fixed size.

    0      magic, version, number of records
    16     number of samples written so far
    24     the last request to pause or continue: a number of its own, its code, who made it
    256    number of status texts so far
    272    the last request to stop, as above: nothing that is asked later takes its place
    512    description of the run: length, checksum, JSON (written once)
    8704   two slots for its status: length, checksum, JSON (written in turn)
    25088  a ring of samples; each record begins and ends with its number

Nothing is locked. A text is believed if its checksum is right, and a record if both numbers are that of the sample and
the run had not begun to write over it when it was copied; so a reader sees what was written or knows that it did not.
Only requests are written by readers. The numbers of the head are set through a view of whole words, in one move: struct
first clears what it writes, and a reader in that moment would see 0.
"""

import json
import mmap
import secrets
import struct
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import UsageError

MAGIC, VERSION, RECORDS = b"smarigRP", 2, 4096
SAMPLE_FIELDS = (
    "t_s",
    "step",
    "current_command_A",
    "current_A",
    "voltage_V",
    "input_K",
    "counts",
    "position",
    "temperature_degC",
    "ambient_degC",
    "quality",
)
SAMPLES = np.dtype([(name, np.float64) for name in SAMPLE_FIELDS])
RECORD = struct.Struct(f"@Q{len(SAMPLE_FIELDS)}dQ")
REQUESTS = ("pause", "continue", "stop")
_HEAD, _LENGTHS = struct.Struct("@8sII"), struct.Struct("@II")
_NEWEST, _REQUESTS, _STATUSES, _STOP = 16 // 8, 24 // 8, 256 // 8, 272 // 8  # words
_DESCRIPTION, _STATUS = 512, 8704  # bytes
_TEXT = 8192
_RING = _STATUS + 2 * _TEXT
SIZE = _RING + RECORDS * RECORD.size
_WHO = 200  # bytes
_RECORDS = np.dtype([("first", np.uint64), ("sample", SAMPLES), ("last", np.uint64)])


class SharedMemory:
    """The mapped file, for its writer (``prepare``, ``add``, ``write_status``, ``requests``) and its readers."""

    def __init__(self, memory: mmap.mmap) -> None:
        self._memory = memory
        self._numbers = memoryview(memory)[:_DESCRIPTION].cast("Q")
        self._add = RECORD.pack_into
        self.written = 0
        self._statuses = 0

    def close(self) -> None:
        """Unmap the file."""
        self._numbers.release()
        self._memory.close()

    # --- the run ------------------------------------------------------------------------------------

    def prepare(self, description: dict[str, Any]) -> None:
        """Write the head and the description."""
        self._write_text(_DESCRIPTION, description)
        _HEAD.pack_into(self._memory, 0, MAGIC, VERSION, RECORDS)

    def add(self, *values: float) -> None:
        """Add a sample, with the values of ``SAMPLE_FIELDS``."""
        number = self.written + 1
        self._add(self._memory, _RING + (number % RECORDS) * RECORD.size, number, *values, number)
        self._numbers[_NEWEST] = number
        self.written = number

    def write_status(self, status: dict[str, Any]) -> None:
        """Replace the status."""
        self._statuses += 1
        self._write_text(_STATUS + (self._statuses % 2) * _TEXT, status)
        self._numbers[_STATUSES] = self._statuses

    def requests(self) -> tuple[tuple[int, str, str], ...]:
        """The last request to pause or continue, and the last to stop: (its number, the request or "", who made it).

        A number other than before means a new request.
        """
        return self._request(_REQUESTS), self._request(_STOP)

    def _request(self, at: int) -> tuple[int, str, str]:
        number = self._numbers[at]
        code, length, start = self._memory[at * 8 + 8], self._memory[at * 8 + 9], at * 8 + 10
        who = self._memory[start : start + min(length, _WHO)].decode("utf-8", "replace")
        return number, REQUESTS[code] if code < len(REQUESTS) else "", who

    # --- others -------------------------------------------------------------------------------------

    @property
    def valid(self) -> bool:
        """Whether this is the memory of a run, in the layout of this version."""
        return _HEAD.unpack_from(self._memory, 0) == (MAGIC, VERSION, RECORDS)

    @property
    def newest(self) -> int:
        """The number of samples written so far."""
        return self._numbers[_NEWEST]

    def description(self) -> dict[str, Any]:
        """The description; empty if it is damaged."""
        return self._read_text(_DESCRIPTION)

    def status(self) -> dict[str, Any]:
        """The last status; empty before the first."""
        for _ in range(3):  # the writer may be at it
            statuses = self._numbers[_STATUSES]
            found = self._read_text(_STATUS + (statuses % 2) * _TEXT) if statuses else {}
            if found or not statuses:
                return found
        return {}

    def samples(self, after: int) -> tuple[NDArray[Any], int, int]:
        """(samples after number ``after`` that are still there, number of the newest, how many were overwritten)."""
        newest = self.newest
        numbers = np.arange(max(after, newest - RECORDS + 1, 0) + 1, newest + 1, dtype=np.uint64)
        ring = np.frombuffer(self._memory[_RING:SIZE], _RECORDS)
        found = ring[numbers % RECORDS]
        whole = (found["first"] == numbers) & (found["last"] == numbers)
        whole &= numbers + RECORDS > self.newest + 1  # the next one may have been half written into its place
        return found["sample"][whole], newest, max(newest - after, 0) - int(whole.sum())

    def ask(self, request: str, who: str) -> None:
        """Write a request. Its number is random: two who ask at once do not take the same one."""
        at = _STOP if request == "stop" else _REQUESTS
        text = who.encode("utf-8", "replace")[:_WHO].decode("utf-8", "ignore").encode()
        self._memory[at * 8 + 10 : at * 8 + 10 + len(text)] = text
        self._memory[at * 8 + 8], self._memory[at * 8 + 9] = REQUESTS.index(request), len(text)
        self._numbers[at] = secrets.randbits(63) + 1

    def _write_text(self, at: int, content: dict[str, Any]) -> None:
        text = json.dumps(content, allow_nan=False, ensure_ascii=False).encode("utf-8", "surrogatepass")
        if len(text) > _TEXT - _LENGTHS.size:
            raise UsageError(
                f"Its description has {len(text)} bytes, at most {_TEXT - _LENGTHS.size} are possible."
            )
        _LENGTHS.pack_into(self._memory, at, len(text), zlib.crc32(text))
        start = at + _LENGTHS.size
        self._memory[start : start + len(text)] = text

    def _read_text(self, at: int) -> dict[str, Any]:
        length, checksum = _LENGTHS.unpack_from(self._memory, at)
        text = self._memory[at + _LENGTHS.size : at + _LENGTHS.size + min(length, _TEXT)]
        if len(text) != length or zlib.crc32(text) != checksum:
            return {}
        try:
            found = json.loads(text)
        except (ValueError, RecursionError):
            return {}
        return found if isinstance(found, dict) else {}
