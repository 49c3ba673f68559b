"""The ports of the devices: a pty that a host opens like a serial port, or a TCP port on this machine.

Both can be unplugged and plugged in again under the same name.
"""

import contextlib
import os
import pty
import socket
import tty
from pathlib import Path
from typing import Protocol

CHUNK = 4096


class Port(Protocol):
    """The device's end of its line. ``channels`` are descriptors to poll."""

    @property
    def url(self) -> str:
        """The address that a host opens."""
        ...

    def channels(self) -> list[int]:
        """The descriptors to poll; none while unplugged."""
        ...

    def read(self, channel: int) -> bytes | None:
        """Data of a channel; None if there is no data, because the channel is new or has ended."""
        ...

    def write(self, channel: int, data: bytes) -> None:
        """Send the data if a host is connected."""
        ...

    def plug(self) -> None:
        """Open the port if it is closed."""
        ...

    def unplug(self) -> None:
        """Close the port if it is open. The host loses its connection."""
        ...


class Pty:
    """A pty, with a link to it if a name is given. Both sides are raw: no echo, no line editing."""

    def __init__(self, link: Path | None = None) -> None:
        self._link = link
        self._master = self._slave = -1
        self.plug()

    @property
    def url(self) -> str:
        """Path of the link, or of the pty itself."""
        return str(self._link) if self._link else os.ttyname(self._slave)

    def channels(self) -> list[int]:
        """The master's descriptor."""
        return [self._master] if self._master >= 0 else []

    def read(self, channel: int) -> bytes | None:
        """The data that the host wrote."""
        with contextlib.suppress(OSError):
            return os.read(channel, CHUNK)
        return None

    def write(self, channel: int, data: bytes) -> None:
        """Send data. Bytes that do not fit are lost if the host does not read, as on a serial line."""
        with contextlib.suppress(OSError):
            os.write(channel, data)

    def plug(self) -> None:
        """A new pty under the old name. Its slave stays open here, since reading fails once the host has
        closed it."""
        if self._master >= 0:
            return
        self._master, self._slave = pty.openpty()
        tty.setraw(self._master)
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        if self._link:
            self._link.unlink(missing_ok=True)
            self._link.symlink_to(os.ttyname(self._slave))

    def unplug(self) -> None:
        """Close both sides and remove the name."""
        if self._master < 0:
            return
        if self._link:
            self._link.unlink(missing_ok=True)
        os.close(self._master)
        os.close(self._slave)
        self._master = self._slave = -1


class TcpPort:
    """A listener on 127.0.0.1 and its connections. Port 0 takes a free port and keeps it."""

    def __init__(self, number: int = 0) -> None:
        self._number = number
        self._listener: socket.socket | None = None
        self._connections: dict[int, socket.socket] = {}
        self.plug()

    @property
    def url(self) -> str:
        """The address with the port number."""
        return f"tcp://127.0.0.1:{self._number}"

    def channels(self) -> list[int]:
        """The listener and all connections."""
        return [*([self._listener.fileno()] if self._listener else []), *self._connections]

    def read(self, channel: int) -> bytes | None:
        """Data of a connection. New connections are accepted, ended ones are closed."""
        if self._listener and channel == self._listener.fileno():
            with contextlib.suppress(OSError):
                self._let_in(self._listener.accept()[0])
            return None
        data = b""
        with contextlib.suppress(BlockingIOError, ConnectionError):
            data = self._connections[channel].recv(CHUNK)
        if not data:
            self._connections.pop(channel).close()
        return data or None

    def write(self, channel: int, data: bytes) -> None:
        """Send to the connection of the request, if it is still open."""
        if channel in self._connections:
            with contextlib.suppress(OSError):
                self._connections[channel].send(data)

    def plug(self) -> None:
        """Listen on the same port as before."""
        if self._listener is None:
            self._listener = socket.create_server(("127.0.0.1", self._number))
            self._listener.setblocking(False)
            self._number = self._listener.getsockname()[1]

    def unplug(self) -> None:
        """Close all connections."""
        for one in (*self._connections.values(), *([self._listener] if self._listener else [])):
            one.close()
        self._connections, self._listener = {}, None

    def _let_in(self, connection: socket.socket) -> None:
        connection.setblocking(False)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._connections[connection.fileno()] = connection
