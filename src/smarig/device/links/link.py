"""The seam between drivers and whatever carries bytes."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol

from smarig.device.wire.exchange import Exchange, Refusal


class Link(Protocol):
    """One device at the end of a line."""

    @property
    def where(self) -> str:
        """Which line this is, for people."""
        ...

    def exchange(self, exchange: Exchange) -> list[int] | Refusal:
        """One request and its reply: words, or the device's no. Raises Silent, Garbled."""
        ...

    def more(self, exchange: Exchange) -> list[int] | Refusal:
        """The next reply without a request, where the last was not the one: it may be late."""
        ...

    def reopen(self) -> None:
        """Close the line and open it again. Raises Silent when it is not there."""
        ...

    def close(self) -> None:
        """Let go of the line; never raises, any number of times."""
        ...


@contextmanager
def let_go_on_failure(link: Link) -> Iterator[Link]:
    """Within: what is built on a link. If that fails nobody else has it, and it is closed."""
    try:
        yield link
    except BaseException:
        link.close()
        raise
