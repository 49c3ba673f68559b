"""Connections that have not shown the token: few, for a short time, and the newest in place of the oldest.

Every process of this computer can connect. Each connection takes a descriptor, of which a process has a few hundred;
when none is left, nobody gets in and each attempt is logged. So a connection that has not shown the token gives way:
after ``LONGEST_S``, or as soon as ``most`` newer ones are there. One that has shown it is never closed.

The holder of the token is read before it could give way: the server accepts ``ACCEPTED_AT_ONCE`` connections in one
round of its loop and reads in the third round after, and ``most`` is larger than what it accepts until then.

Keeps the log of the server short: of messages that repeat, the first few of a minute, and the number of the rest.

Whoever can connect can make the server log: by bytes that are no request, or by more connections than it has
descriptors for.
"""

import asyncio
import logging
import time
from collections.abc import Callable
from dataclasses import dataclass
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


EACH, WINDOW_S = 3, 60.0  # messages of a kind
_KINDS = 50  # that are told apart; the rest is one kind
_LONGEST = 4000  # characters of a message


@dataclass
class _Count:
    began_s: float
    passed: int = 0
    left_out: int = 0


class LogLimit(logging.Filter):
    """A filter of a logger. Two messages are of one kind if they are made from the same text."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        super().__init__()
        self._clock = clock
        self._counts: dict[str, _Count] = {}

    def filter(self, record: logging.LogRecord) -> bool:
        """Whether the record is written. The first of a minute says how many of the last one were left out."""
        kind, now_s = str(record.msg), self._clock()
        if kind not in self._counts and len(self._counts) >= _KINDS:
            kind = ""
        count = self._counts.setdefault(kind, _Count(now_s))
        left_out = 0
        if now_s - count.began_s >= WINDOW_S:
            left_out = count.left_out
            self._counts[kind] = count = _Count(now_s)
        if count.passed >= EACH:
            count.left_out += 1
            return False
        count.passed += 1
        text = record.getMessage()[:_LONGEST]
        record.msg, record.args = (
            (f"{text} ({left_out} more were left out before.)" if left_out else text),
            (),
        )
        return True


def limit_logs(*loggers: str) -> None:
    """Limit the logs of these loggers."""
    for name in loggers:
        logging.getLogger(name).addFilter(LogLimit())
