"""The text framing on the host's side (see firmware_protocol/README.md)."""

import re

from smarig.device.encoding.crc import crc16
from smarig.device.encoding.exchange import Exchange, Refusal

_REPLY = re.compile(rb"(?:=(?P<words>(?: [0-9A-F]{4})*)|! (?P<code>[0-9A-F]{1,2})) \*(?P<crc>[0-9A-F]{4})")


def request(e: Exchange) -> bytes:
    """The line of an exchange, with its line end.

    >>> request(Exchange(read_at=0, count=12))
    b'r 0000 000C *281F\\n'
    """
    parts = []
    if e.words:
        parts.append("w " + " ".join(f"{word:04X}" for word in (e.write_at, *e.words)))
    if e.count:
        parts.append(f"r {e.read_at:04X} {e.count:04X}")
    body = " ".join(parts).encode()
    return body + f" *{crc16(body):04X}\n".encode()


def find(e: Exchange, data: bytes) -> list[int] | Refusal | None:
    """The last reply to an exchange in the received bytes: a whole line with a correct check word."""
    last = None
    for line in data.split(b"\n")[:-1]:
        for found in _REPLY.finditer(line):
            if found.end() != len(line.rstrip(b"\r")) or int(found["crc"], 16) != crc16(_body(found[0])):
                continue
            if found["code"] is not None:
                last = Refusal(int(found["code"], 16))
            elif found["words"].count(b" ") == e.count:
                last = [int(word, 16) for word in found["words"].split()]
    return last


def _body(line: bytes) -> bytes:
    return line[: line.rindex(b" *")]
