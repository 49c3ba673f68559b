"""Modbus on the server's side: requests of functions 3, 16 and 23 and their replies, in RTU frames or over
TCP.

Incomplete requests and requests to other addresses are not answered.
"""

import struct

from simulators.framing import ParsedRequest
from simulators.layout import BAD_VALUE, NO_FUNCTION, fits
from smarig.device import Exchange, Refusal, crc16

READ, WRITE, BOTH = 3, 16, 23
LONGEST_PDU = 253
LONGEST_FRAME = 256

# Bytes of a request up to and including the count of data bytes, from the function on. READ has no such
# count.
_HEAD = {READ: 5, WRITE: 6, BOTH: 10}


def pdu_length(pdu: bytes) -> int | None:
    """The length of a request according to its header; None if it is not known (yet)."""
    head = _HEAD.get(pdu[0]) if pdu else None
    if head is None or len(pdu) < head:
        return None
    return head if pdu[0] == READ else head + pdu[head - 1]


def requested(pdu: bytes) -> Exchange | Refusal:
    """The exchange of a request, from the function on."""
    if pdu[0] not in _HEAD:
        return Refusal(NO_FUNCTION)
    if pdu_length(pdu) != len(pdu):
        return Refusal(BAD_VALUE)
    read_at = count = write_at = written = 0
    if pdu[0] != WRITE:
        read_at, count = struct.unpack_from(">HH", pdu, 1)
    if pdu[0] != READ:
        write_at, written, size = struct.unpack_from(">HHB", pdu, _HEAD[pdu[0]] - 5)
        if size != 2 * written:
            return Refusal(BAD_VALUE)
    exchange = Exchange(
        read_at, count, write_at, struct.unpack(f">{written}H", pdu[len(pdu) - 2 * written :])
    )
    missing = (pdu[0] != WRITE and not count) or (pdu[0] != READ and not written)
    return Refusal(BAD_VALUE) if missing or not fits(exchange) else exchange


def reply(request: bytes, answer: list[int] | Refusal) -> bytes:
    """The reply to a request, both from the function on."""
    if isinstance(answer, Refusal):
        return bytes([request[0] | 0x80, answer.code])
    if request[0] == WRITE:
        return request[:5]
    return struct.pack(f">BB{len(answer)}H", request[0], 2 * len(answer), *answer)


class Rtu:
    """Frames of one address with a check word."""

    name = "modbus_rtu"

    def __init__(self, address: int) -> None:
        self.address = address

    def receiver(self) -> "RtuReceiver":
        """A receiver that splits at the length in a frame, or at silence."""
        return RtuReceiver()

    def decode(self, request: bytes) -> ParsedRequest | None:
        """The exchange of a complete frame for this address; None for any other."""
        if not 4 <= len(request) <= LONGEST_FRAME or request[0] != self.address or not _whole(request):
            return None
        pdu = request[1:-2]
        return ParsedRequest(requested(pdu), pdu)

    def encode(self, parsed: ParsedRequest, answer: list[int] | Refusal) -> bytes:
        """A frame from this address."""
        frame = bytes([self.address]) + reply(parsed.envelope, answer)
        return frame + struct.pack("<H", crc16(frame))


def _whole(frame: bytes) -> bool:
    return crc16(frame[:-2]) == frame[-2] | frame[-1] << 8


class RtuReceiver:
    """Splits frames by their length if the check word agrees; otherwise silence ends them."""

    def __init__(self) -> None:
        self._partial = b""

    @property
    def waits_for_silence(self) -> bool:
        """Whether a frame has started."""
        return bool(self._partial)

    def take(self, data: bytes) -> list[bytes]:
        """The frames that are complete."""
        self._partial += data
        frames = []
        while frame := self._first():
            frames.append(frame)
            self._partial = self._partial[len(frame) :]
        self._partial = self._partial[: LONGEST_FRAME + 1]
        return frames

    def silence(self) -> list[bytes]:
        """The received bytes as one frame, valid or not."""
        frame, self._partial = self._partial, b""
        return [frame] if frame else []

    def _first(self) -> bytes:
        length = pdu_length(self._partial[1:])
        frame = self._partial[: length + 3] if length else b""
        return frame if length and len(frame) == length + 3 and _whole(frame) else b""


class Tcp:
    """Requests with MBAP headers: transaction, protocol 0, length, unit."""

    name = "modbus_tcp"

    def __init__(self, address: int) -> None:
        self.address = address

    def receiver(self) -> "MbapReceiver":
        """A receiver that splits at the length in the header."""
        return MbapReceiver()

    def decode(self, request: bytes) -> ParsedRequest | None:
        """The exchange of a request to this unit. The header is needed for the reply."""
        if len(request) < 8 or request[6] != self.address or _mbap_length(request) != len(request):
            return None
        return ParsedRequest(requested(request[7:]), request)

    def encode(self, parsed: ParsedRequest, answer: list[int] | Refusal) -> bytes:
        """The reply with the transaction of the request."""
        pdu = reply(parsed.envelope[7:], answer)
        return parsed.envelope[:4] + struct.pack(">HB", len(pdu) + 1, self.address) + pdu


def _mbap_length(header: bytes) -> int | None:
    """Length of a complete request; None if the header is not valid."""
    protocol, length = struct.unpack_from(">HH", header, 2)
    return 6 + length if protocol == 0 and 2 <= length <= LONGEST_PDU + 1 else None


class MbapReceiver:
    """A stream of headers and requests. After an invalid header the next request cannot be located."""

    waits_for_silence = False

    def __init__(self) -> None:
        self._partial = b""

    def take(self, data: bytes) -> list[bytes]:
        """The complete requests. Everything after an invalid header is dropped."""
        self._partial += data
        requests = []
        while len(self._partial) >= 6:
            length = _mbap_length(self._partial)
            if length is None:
                self._partial = b""
                break
            if len(self._partial) < length:
                break
            requests.append(self._partial[:length])
            self._partial = self._partial[length:]
        return requests

    def silence(self) -> list[bytes]:
        """Nothing to do: TCP loses nothing, so the rest will arrive."""
        return []
