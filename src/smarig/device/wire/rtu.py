"""Modbus RTU frames as a client sends and finds them. Bytes in, words out; moves no bytes itself.

A reply is looked for at every offset with its one expected length and a right check word, so that noise before
it does no harm: receivers that drop a noisy buffer whole never recover on a noisy line.
"""

import struct

from smarig.device.wire.crc import crc16
from smarig.device.wire.exchange import Exchange, Refusal

READ, WRITE, BOTH = 3, 16, 23
REFUSAL_BYTES = 5  # a refusal


def function(e: Exchange) -> int:
    """The Modbus function that carries an exchange."""
    return (BOTH if e.count else WRITE) if e.words else READ


def pdu(e: Exchange) -> bytes:
    """Function and data, without address and check word."""
    written = struct.pack(f">HHB{len(e.words)}H", e.write_at, len(e.words), 2 * len(e.words), *e.words)
    read = struct.pack(">HH", e.read_at, e.count)
    parts = {READ: read, WRITE: written, BOTH: read + written}
    return bytes([function(e)]) + parts[function(e)]


def request(address: int, e: Exchange) -> bytes:
    """The frame of an exchange."""
    body = bytes([address]) + pdu(e)
    return body + struct.pack("<H", crc16(body))


def reply_length(e: Exchange) -> int:
    """Bytes of the reply that grants it."""
    return 8 if function(e) == WRITE else 5 + 2 * e.count


def find(address: int, e: Exchange, data: bytes) -> list[int] | Refusal | None:
    """The reply to an exchange anywhere in what was heard; None where there is none (yet)."""
    length, code = reply_length(e), function(e)
    for at in range(len(data) - REFUSAL_BYTES + 1):
        if data[at] != address:
            continue
        if data[at + 1] == code | 0x80 and _crc_ok(data[at : at + REFUSAL_BYTES]):
            return Refusal(data[at + 2])
        frame = data[at : at + length]
        if data[at + 1] == code and len(frame) == length and _crc_ok(frame) and _echoes_request(e, frame):
            return list(struct.unpack(f">{e.count}H", frame[3:-2])) if code != WRITE else []
    return None


def _echoes_request(e: Exchange, frame: bytes) -> bool:
    if function(e) == WRITE:
        return frame[2:6] == struct.pack(">HH", e.write_at, len(e.words))
    return frame[2] == 2 * e.count


def _crc_ok(frame: bytes) -> bool:
    return struct.unpack("<H", frame[-2:])[0] == crc16(frame[:-2])
