"""What every framing offers: exchanges from the bytes of one request, and the bytes of its reply.

Knows devices by ``accept`` alone, so that any of them answers in any framing.
"""

from typing import NamedTuple, Protocol

from smarig.device import Exchange, Refusal


class ParsedRequest(NamedTuple):
    """One request that is for this device: what it asks, and what its framing needs to answer it."""

    requested: Exchange | Refusal
    envelope: bytes = b""


class ExchangeHandler(Protocol):
    """A device's state machine."""

    def accept(self, exchange: Exchange) -> list[int] | Refusal:
        """Carry out and answer, or refuse."""
        ...


class Receiver(Protocol):
    """Cuts what comes over a line into requests."""

    def take(self, data: bytes) -> list[bytes]:
        """Bytes as they come; the requests that are whole now."""
        ...

    def silence(self) -> list[bytes]:
        """The line is quiet: what is left is as long as it will get."""
        ...

    @property
    def waits_for_silence(self) -> bool:
        """Whether ``silence`` would end a request."""
        ...


class ServerFraming(Protocol):
    """One way of writing exchanges as bytes."""

    name: str

    def receiver(self) -> Receiver:
        """A fresh one, for a fresh line."""
        ...

    def decode(self, request: bytes) -> ParsedRequest | None:
        """What one request asks; None where it is not to be answered."""
        ...

    def encode(self, parsed: ParsedRequest, answer: list[int] | Refusal) -> bytes:
        """The reply."""
        ...


def answer(device: ExchangeHandler, framing: ServerFraming, request: bytes) -> bytes | None:
    """The reply to the bytes of one request, or silence; no bytes at all make it raise."""
    parsed = framing.decode(request)
    if parsed is None:
        return None
    words = parsed.requested if isinstance(parsed.requested, Refusal) else device.accept(parsed.requested)
    return framing.encode(parsed, words)
