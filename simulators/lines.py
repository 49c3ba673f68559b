"""The text framing on the device's side: one line is a request, one line is the reply.

w 0100 0000 0001 0000 0001 0000 000F 4240 r 0000 000E *E192
"""

import re

from simulators.framing import ParsedRequest
from simulators.layout import BAD_CHECK, BAD_VALUE, NOT_READABLE, fits
from smarig.device import Exchange, Refusal, crc16

LONGEST = 1000  # characters of a request

_CHECKED = re.compile(rb"(?P<body>.*) \*(?P<check>[0-9A-Fa-f]{4})", re.DOTALL)
_NUMBER = rb"[0-9A-Fa-f]{1,4}"
_BODY = re.compile(rb"(?:w (?P<write>%b(?: %b)+))?(?P<both> (?=r))?(?:r (?P<read>%b %b))?" % ((_NUMBER,) * 4))


class TextFraming:
    """The text framing. There is one device per line, without an address."""

    name = "lines"

    def receiver(self) -> "LineReceiver":
        """A receiver that splits at the ends of lines."""
        return LineReceiver()

    def decode(self, request: bytes) -> ParsedRequest | None:
        r"""The exchange of a line without its ``\n``; None for an empty line."""
        line = request.removesuffix(b"\r")
        return ParsedRequest(_parse(line)) if line else None

    def encode(self, parsed: ParsedRequest, answer: list[int] | Refusal) -> bytes:
        """The reply: words in upper case, always with a check word."""
        del parsed
        if isinstance(answer, Refusal):
            body = f"! {answer.code:X}".encode()
        else:
            body = ("=" + "".join([f" {word:04X}" for word in answer])).encode()
        return body + f" *{crc16(body):04X}\n".encode()


def _parse(line: bytes) -> Exchange | Refusal:
    if len(line) > LONGEST:
        return Refusal(NOT_READABLE)
    checked = _CHECKED.fullmatch(line)
    if checked and crc16(checked["body"]) != int(checked["check"], 16):
        return Refusal(BAD_CHECK)
    body = _BODY.fullmatch(checked["body"] if checked else line)
    if not body or not (body["write"] or body["read"]) or _badly_spaced(body):
        return Refusal(NOT_READABLE)
    write_at, *words = _numbers(body["write"]) or [0]
    read_at, count = _numbers(body["read"]) or [0, 0]
    if words and not checked:
        return Refusal(BAD_CHECK)
    exchange = Exchange(read_at, count, write_at, tuple(words))
    if (body["read"] and not count) or not fits(exchange):
        return Refusal(BAD_VALUE)
    return exchange


def _badly_spaced(body: re.Match) -> bool:
    """Whether the one blank between the two parts is missing or misplaced."""
    return bool(body["both"]) != bool(body["write"] and body["read"])


def _numbers(text: bytes | None) -> list[int]:
    return [int(number, 16) for number in (text or b"").split()]


class LineReceiver:
    """Collects the characters of a line. Of an overlong line it keeps only enough to see that it is too
    long."""

    waits_for_silence = False

    def __init__(self) -> None:
        self._partial = b""

    def take(self, data: bytes) -> list[bytes]:
        """The complete lines without their ends."""
        *lines, partial = (self._partial + data).split(b"\n")
        self._partial = partial[: LONGEST + 2]  # one too many, and a carriage return
        return lines

    def silence(self) -> list[bytes]:
        """Nothing to do: a person may pause while typing."""
        return []
