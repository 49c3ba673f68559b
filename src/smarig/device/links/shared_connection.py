"""One connection for several roles of one instrument: opened by the first user, closed by the last.

Instruments such as a LabJack accept few connections, and their watchdog counts the silence of all of them together; a
box that is both source and sensor has one port, and answers on it in the order of the queries.
"""

import threading
from collections.abc import Callable, Hashable
from typing import Generic, Protocol, TypeVar

from smarig.device.encoding.link_faults import Silent


class Connection(Protocol):
    """What can be shared. ``where`` is its name, for messages."""

    @property
    def where(self) -> str: ...

    def close(self) -> None: ...


C = TypeVar("C", bound=Connection)
U = TypeVar("U", bound="ConnectionUse")


class SharedConnections(Generic[C]):
    """The open connections of one kind, each with the number of its users."""

    def __init__(self) -> None:
        self._open: dict[Hashable, tuple[C, int]] = {}
        self._guard = threading.Lock()

    def use(self, kind: "type[U]", key: Hashable, connect: Callable[[], C]) -> "U":
        """One more user, of this kind, of the connection with this key; ``connect`` opens it for the first."""
        with self._guard:
            connection, users = self._open[key] if key in self._open else (connect(), 0)
            self._open[key] = connection, users + 1
        return kind(self, key, connection)

    def leave(self, key: Hashable) -> None:
        """One user less; the last one closes it."""
        with self._guard:
            connection, users = self._open.pop(key)
            if users > 1:
                self._open[key] = connection, users - 1
            else:
                connection.close()


class ConnectionUse(Generic[C]):
    """One user's part in a connection. After its ``close`` it raises Silent; the other users keep theirs."""

    def __init__(self, shared: SharedConnections[C], key: Hashable, connection: C) -> None:
        self._shared, self._key, self._connection = shared, key, connection
        self._is_open, self._guard = True, threading.Lock()

    @property
    def where(self) -> str:
        """The name of the connection, for messages."""
        return self._connection.where

    @property
    def connection(self) -> C:
        """The connection. Raises Silent after ``close``."""
        if not self._is_open:
            raise Silent(f"{self.where} is not open. {Silent.remedy}")
        return self._connection

    def close(self) -> None:
        """Leave the connection. Never raises and may be called repeatedly."""
        with self._guard:
            was_open, self._is_open = self._is_open, False
        if was_open:
            self._shared.leave(self._key)
