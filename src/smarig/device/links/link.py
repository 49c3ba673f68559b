"""The interface of a link to one device."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol

from smarig.device.encoding.exchange import Exchange, Refusal


class Link(Protocol):
    """A connection to one device."""

    @property
    def where(self) -> str:
        """The name of the line, for messages."""
        ...

    def exchange(self, exchange: Exchange) -> list[int] | Refusal:
        """Send one request and return its reply: words, or the device's refusal. Raises Silent, Garbled."""
        ...

    def more(self, exchange: Exchange) -> list[int] | Refusal:
        """The next reply without a new request, when the last one belonged to an earlier request."""
        ...

    def reopen(self) -> None:
        """Close the line and open it again. Raises Silent if the port does not exist."""
        ...

    def close(self) -> None:
        """Close the line. Never raises and may be called repeatedly."""
        ...


@contextmanager
def let_go_on_failure(link: Link) -> Iterator[Link]:
    """Close the link if the body raises, because nobody else holds it then."""
    try:
        yield link
    except BaseException:
        link.close()
        raise
