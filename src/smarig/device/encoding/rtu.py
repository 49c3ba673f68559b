"""Modbus RTU frames on the host's side: encodes requests and finds replies in received bytes.

A reply is searched at every offset by its expected length and a correct check word, so noise before it does no harm.
Receivers that discard a noisy buffer as a whole never recover on a noisy line.
"""

import struct

from smarig.device.encoding.crc import crc16
from smarig.device.encoding.exchange import Exchange, Refusal

READ, WRITE, BOTH = 3, 16, 23
REFUSAL_BYTES = 5


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
    """Bytes of the reply that grants an exchange."""
    return 8 if function(e) == WRITE else 5 + 2 * e.count


def find(address: int, e: Exchange, data: bytes) -> list[int] | Refusal | None:
    """The last reply to an exchange in the received bytes; None if there is none yet. Earlier ones were late."""
    found, at = None, 0
    while at <= len(data) - REFUSAL_BYTES:
        reply, size = _reply(address, e, data[at:])
        found, at = (found, at + 1) if reply is None else (reply, at + size)
    return found


def _reply(address: int, e: Exchange, data: bytes) -> tuple[list[int] | Refusal | None, int]:
    """The reply that starts with the first byte, and its size."""
    length, code = reply_length(e), function(e)
    if data[0] != address:
        return None, 0
    if data[1] == code | 0x80 and _crc_ok(data[:REFUSAL_BYTES]):
        return Refusal(data[2]), REFUSAL_BYTES
    frame = data[:length]
    if data[1] == code and len(frame) == length and _crc_ok(frame) and _echoes_request(e, frame):
        return (list(struct.unpack(f">{e.count}H", frame[3:-2])) if code != WRITE else []), length
    return None, 0


def _echoes_request(e: Exchange, frame: bytes) -> bool:
    if function(e) == WRITE:
        return frame[2:6] == struct.pack(">HH", e.write_at, len(e.words))
    return frame[2] == 2 * e.count


def _crc_ok(frame: bytes) -> bool:
    return struct.unpack("<H", frame[-2:])[0] == crc16(frame[:-2])
