"""Connections that have not shown the token: few, for a short time, and the newest in place of the oldest.

Every process of this computer can connect. Each connection takes a descriptor, of which a process has a few hundred;
when none is left, nobody gets in and each attempt is logged. So a connection that has not shown the token gives way:
after ``LONGEST_S``, or as soon as ``most`` newer ones are there. One that has shown it is never closed.

The holder of the token is read before it could give way: the server accepts ``ACCEPTED_AT_ONCE`` connections in one
round of its loop and reads in the third round after, and ``most`` is larger than what it accepts until then.
"""

import asyncio
from typing import Any

from uvicorn.protocols.http.h11_impl import H11Protocol

LONGEST_S = 10.0
ACCEPTED_AT_ONCE = 4
_LEAST, _MOST, _SHARE = 16, 64, 8  # connections, and the share of the descriptors of the process


class ConnectionLimit:
    """``protocol`` is what the server makes of each connection; ``admit`` is called when one has shown the token."""

    def __init__(self, most: int | None = None) -> None:
        self.most = most or _most_of_this_process()
        self._without_token: dict[Any, _Connection] = {}  # by the address of the client, oldest first

    def protocol(self, **given: Any) -> "_Connection":
        """A connection that is counted."""
        return _Connection(self, **given)

    def admit(self, client: Any) -> None:
        """The connection from this address has shown the token."""
        self._without_token.pop(client, None)

    def begin(self, connection: "_Connection") -> None:
        """A new connection takes the place of the oldest."""
        self._without_token[connection.client] = connection
        if len(self._without_token) > self.most:
            self._without_token.pop(next(iter(self._without_token))).abort()

    def end(self, connection: "_Connection") -> None:
        """A connection was closed."""
        if self._without_token.get(connection.client) is connection:
            del self._without_token[connection.client]

    def has_shown_nothing(self, connection: "_Connection") -> bool:
        """Whether a connection may still be closed."""
        return self._without_token.get(connection.client) is connection


class _Connection(H11Protocol):
    """A connection of the server that the limit knows of."""

    def __init__(self, limit: ConnectionLimit, **given: Any) -> None:
        super().__init__(**given)
        self._limit = limit
        self._look_again: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:
        super().connection_made(transport)
        self._limit.begin(self)
        self._look_again = self.loop.call_later(LONGEST_S, self._close_if_silent)

    def connection_lost(self, exc: Exception | None) -> None:
        super().connection_lost(exc)
        self._limit.end(self)
        if self._look_again is not None:
            self._look_again.cancel()

    def abort(self) -> None:
        """Close at once: what is still to be sent is dropped."""
        self.transport.abort()

    def _close_if_silent(self) -> None:
        """A script without the token may still be on its way (``report_response``): look again later."""
        if not self._limit.has_shown_nothing(self):
            return
        if self.cycle is None or self.cycle.response_complete:
            self.abort()
        else:
            self._look_again = self.loop.call_later(LONGEST_S, self._close_if_silent)


def _most_of_this_process() -> int:
    import resource  # which Windows does not have; the queue refuses it in a sentence before

    descriptors = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    if descriptors == resource.RLIM_INFINITY:
        return _MOST
    return max(_LEAST, min(_MOST, descriptors // _SHARE))
