"""The layout of the memory that a run shares with other processes: one file of fixed size.

    0      state (eight letters), version, number of records
    64     number of the newest sample
    128    number of the newest status
    256    two requests: one to stop, one to pause or continue; each with a mark, who asks, and a checksum; the kind of
           the one who asks is the byte before the checksum
    1024   description of the run: length, checksum, JSON; written once
    33792  two statuses, written in turn: length, checksum, JSON
    66560  a ring of samples; each record begins and ends with its number

Numbers are written as whole words of the machine, so a reader never sees half of one. A text counts if its checksum is
right, a record if its numbers are.
"""

import json
import struct
import zlib
from typing import Any

import numpy as np

from smarig.core import Requester

VERSION, RECORDS = 1, 4096
RUNNING, ENDED = b"smarigRP", b"smarigEN"  # the states; anything else is no announcement, or not one yet
HEAD, WORD, TEXT_HEAD = struct.Struct("<8sII"), struct.Struct("Q"), struct.Struct("<II")
NEWEST_AT, STATUS_NUMBER_AT, REQUESTS_AT, DESCRIPTION_AT, STATUS_AT = 64, 128, 256, 1024, 33792
DESCRIPTION_SIZE, STATUS_SIZE = STATUS_AT - DESCRIPTION_AT, 16384
RING_AT = STATUS_AT + 2 * STATUS_SIZE

_FIELDS = [
    ("number", "u8"),
    ("t_s", "f8"),
    ("step", "i8"),
    ("current_command_A", "f8"),
    ("current_A", "f8"),
    ("voltage_V", "f8"),
    ("input_K", "f8"),
    ("counts", "i8"),
    ("position", "f8"),
    ("temperature_degC", "f8"),
    ("ambient_degC", "f8"),
    ("quality", "i8"),
]
SAMPLES = np.dtype(_FIELDS)  # ``step`` is -1 between steps
STORED = np.dtype([*_FIELDS, ("number_again", "u8")])
RECORD = struct.Struct("QdqddddqdddqQ")  # the same for the writer, which has no time for numpy
SIZE = RING_AT + RECORDS * RECORD.size

REQUESTS = ("stop", "pause", "continue")
REQUEST = struct.Struct("<8sBB")  # mark, number of the request, length of who asks
REQUEST_SIZE, WHO_SIZE = 256, 200
_CHECKSUM_SIZE = 4
_REQUESTERS = (
    Requester.PROGRAM,
    Requester.CONSOLE,
    Requester.USER,
    Requester.SIGNAL,
)  # by the byte that is stored


def record_at(number: int) -> int:
    """Where the sample of a number is kept."""
    return RING_AT + (number % RECORDS) * RECORD.size


def packed_text(content: dict[str, Any], size: int) -> bytes:
    """The content as it is stored in ``size`` bytes. Raises ValueError if it does not fit."""
    text = json.dumps(content, allow_nan=False).encode()
    if len(text) > size - TEXT_HEAD.size:
        raise ValueError(f"{len(text)} bytes do not fit into {size}")
    return TEXT_HEAD.pack(len(text), zlib.crc32(text)) + text


def unpacked_text(stored: bytes) -> dict[str, Any]:
    """The content that was stored; empty if there is none, or only a part of it."""
    length, checksum = TEXT_HEAD.unpack_from(stored)
    text = stored[TEXT_HEAD.size : TEXT_HEAD.size + length]
    if len(text) != length or zlib.crc32(text) != checksum:
        return {}
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):
        return {}
    return found if isinstance(found, dict) else {}


def request_at(request: str) -> int:
    """Where a request is written. A stop has a place of its own, so that no later request hides it."""
    return REQUESTS_AT + (0 if request == "stop" else REQUEST_SIZE)


def packed_request(mark: bytes, request: str, who: str, by: Requester = Requester.PROGRAM) -> bytes:
    """A request; ``mark`` (8 bytes) tells it from the last one."""
    name = who.encode("utf-8", "replace")[:WHO_SIZE]
    start = REQUEST.pack(mark, REQUESTS.index(request), len(name)) + name
    body = start.ljust(REQUEST_SIZE - _CHECKSUM_SIZE - 1, b"\0") + bytes([_REQUESTERS.index(by)])
    return body + zlib.crc32(body).to_bytes(_CHECKSUM_SIZE, "little")


def unpacked_request(stored: bytes) -> tuple[bytes, str, str, Requester]:
    """(mark, request, who asks, of which kind); the request is "" if there is none, or only a part of it."""
    body, checksum = stored[:-_CHECKSUM_SIZE], int.from_bytes(stored[-_CHECKSUM_SIZE:], "little")
    mark, number, length = REQUEST.unpack_from(body)
    if zlib.crc32(body) != checksum or number >= len(REQUESTS):
        return b"", "", "", Requester.PROGRAM
    who = body[REQUEST.size : REQUEST.size + min(length, WHO_SIZE)].decode("utf-8", "replace")
    by = _REQUESTERS[body[-1]] if body[-1] < len(_REQUESTERS) else Requester.PROGRAM
    return mark, REQUESTS[number], who, by
