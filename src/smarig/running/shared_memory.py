"""The layout of the memory that a running run shares with other processes: one mapped file of fixed size.

    0      magic, version, number of records
    16     number of samples written so far
    24     number of requests so far, the last request, who made it
    256    number of status texts so far
    512    description of the run: length, checksum, JSON (written once)
    8704   two slots for its status: length, checksum, JSON (written in turn)
    25088  a ring of samples; each record begins and ends with its number

Nothing is locked. A text is believed if its checksum is right, and a record if both numbers are that of the sample, so
a reader sees what was written or knows that it did not. Only requests are written by readers.
"""

import json
import mmap
import struct
import zlib
from typing import Any

MAGIC, VERSION, RECORDS = b"smarigRP", 1, 4096
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
RECORD = struct.Struct(f"<Q{len(SAMPLE_FIELDS)}dQ")
REQUESTS = ("pause", "continue", "stop")
_HEAD, _COUNT, _LENGTHS = struct.Struct("<8sII"), struct.Struct("<Q"), struct.Struct("<II")
_NEWEST, _REQUESTS, _STATUSES, _DESCRIPTION, _STATUS = 16, 24, 256, 512, 8704
_TEXT = 8192
_RING = _STATUS + 2 * _TEXT
SIZE = _RING + RECORDS * RECORD.size
_WHO = 200


class SharedMemory:
    """The mapped file, for its writer (``prepare``, ``describe``, ``add``, ``write_status``, ``requests``) and its readers."""

    def __init__(self, memory: mmap.mmap) -> None:
        self._memory = memory
        self._add = RECORD.pack_into
        self._count = _COUNT.pack_into
        self.written = 0
        self._statuses = 0

    def close(self) -> None:
        """Unmap the file."""
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
        self._count(self._memory, _NEWEST, number)
        self.written = number

    def write_status(self, status: dict[str, Any]) -> None:
        """Replace the status."""
        self._statuses += 1
        self._write_text(_STATUS + (self._statuses % 2) * _TEXT, status)
        _COUNT.pack_into(self._memory, _STATUSES, self._statuses)

    def request(self) -> tuple[int, str, str]:
        """(number of requests so far, the last request or "", who made it)."""
        number, code, length = struct.unpack_from("<QBB", self._memory, _REQUESTS)
        start = _REQUESTS + 10
        who = bytes(self._memory[start : start + min(length, _WHO)]).decode("utf-8", "replace")
        return number, REQUESTS[code] if code < len(REQUESTS) else "", who

    # --- others -------------------------------------------------------------------------------------

    @property
    def valid(self) -> bool:
        """Whether this is the memory of a run, in the layout of this version."""
        return _HEAD.unpack_from(self._memory, 0) == (MAGIC, VERSION, RECORDS)

    @property
    def newest(self) -> int:
        """The number of samples written so far."""
        return _COUNT.unpack_from(self._memory, _NEWEST)[0]

    def description(self) -> dict[str, Any]:
        """The description; empty if it is damaged."""
        return self._read_text(_DESCRIPTION)

    def status(self) -> dict[str, Any]:
        """The last status; empty before the first."""
        for _ in range(3):  # the writer may be at it
            statuses = _COUNT.unpack_from(self._memory, _STATUSES)[0]
            found = self._read_text(_STATUS + (statuses % 2) * _TEXT) if statuses else {}
            if found or not statuses:
                return found
        return {}

    def samples(self, after: int) -> tuple[list[tuple[float, ...]], int, int]:
        """(samples after number ``after`` that are still there, number of the newest, how many were overwritten)."""
        newest = self.newest
        first = max(after, newest - RECORDS + 1, 0) + 1
        found = []
        for number in range(first, newest + 1):
            record = RECORD.unpack_from(self._memory, _RING + (number % RECORDS) * RECORD.size)
            if record[0] == record[-1] == number:
                found.append(record[1:-1])
        return found, newest, max(newest - after, 0) - len(found)

    def ask(self, request: str, who: str) -> None:
        """Write a request."""
        number = self.request()[0]
        text = who.encode("utf-8", "replace")[:_WHO]
        start = _REQUESTS + 10
        self._memory[start : start + len(text)] = text
        struct.pack_into("<BB", self._memory, _REQUESTS + 8, REQUESTS.index(request), len(text))
        _COUNT.pack_into(self._memory, _REQUESTS, number + 1)

    def _write_text(self, at: int, content: dict[str, Any]) -> None:
        text = json.dumps(content, allow_nan=False).encode()
        if len(text) > _TEXT - _LENGTHS.size:
            text = b"{}"
        _LENGTHS.pack_into(self._memory, at, len(text), zlib.crc32(text))
        start = at + _LENGTHS.size
        self._memory[start : start + len(text)] = text

    def _read_text(self, at: int) -> dict[str, Any]:
        length, checksum = _LENGTHS.unpack_from(self._memory, at)
        text = bytes(self._memory[at + _LENGTHS.size : at + _LENGTHS.size + min(length, _TEXT)])
        if len(text) != length or zlib.crc32(text) != checksum:
            return {}
        try:
            found = json.loads(text)
        except ValueError:
            return {}
        return found if isinstance(found, dict) else {}
