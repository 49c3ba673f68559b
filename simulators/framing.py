"""The interface of every framing: exchanges from the bytes of requests, and bytes of replies.

A device is used through ``accept`` alone, so every device works with every framing.
"""

from typing import NamedTuple, Protocol

from smarig.device import Exchange, Refusal


class ParsedRequest(NamedTuple):
    """A request addressed to this device: its exchange, and what the framing needs for the reply."""

    requested: Exchange | Refusal
    envelope: bytes = b""


class ExchangeHandler(Protocol):
    """The state machine of a device."""

    def accept(self, exchange: Exchange) -> list[int] | Refusal:
        """Carry out the exchange and return the reply, or refuse it."""
        ...


class Receiver(Protocol):
    """Splits the bytes of a line into requests."""

    def take(self, data: bytes) -> list[bytes]:
        """Add bytes; returns the requests that are now complete."""
        ...

    def silence(self) -> list[bytes]:
        """End a request because the line is silent; returns what was received."""
        ...

    @property
    def waits_for_silence(self) -> bool:
        """Whether ``silence`` would end a request."""
        ...


class ServerFraming(Protocol):
    """A way of writing exchanges as bytes."""

    name: str

    def receiver(self) -> Receiver:
        """A new receiver for a new line."""
        ...

    def decode(self, request: bytes) -> ParsedRequest | None:
        """The exchange of a request; None if the request must not be answered."""
        ...

    def encode(self, parsed: ParsedRequest, answer: list[int] | Refusal) -> bytes:
        """The bytes of the reply."""
        ...


def answer(device: ExchangeHandler, framing: ServerFraming, request: bytes) -> bytes | None:
    """The reply to the bytes of one request, or None. Raises an error if there are no bytes."""
    parsed = framing.decode(request)
    if parsed is None:
        return None
    words = parsed.requested if isinstance(parsed.requested, Refusal) else device.accept(parsed.requested)
    return framing.encode(parsed, words)
