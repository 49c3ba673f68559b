"""A TCP port on which an instrument answers lines of text."""

import contextlib
import socket
import threading
import time
from abc import ABC, abstractmethod


class TextServer(ABC):
    """Listens on loopback while it exists. ``delay_answers_s``: before every answer."""

    def __init__(self) -> None:
        self.delay_answers_s = 0.0
        self.over = threading.Event()
        self._connections: list[socket.socket] = []
        self._server = socket.create_server(("127.0.0.1", 0))
        threading.Thread(target=self._accept, daemon=True).start()

    @abstractmethod
    def answer(self, line: str) -> str | None:
        """The answer to a line; None if it has none."""

    @property
    def port(self) -> int:
        """The port on which it listens."""
        return self._server.getsockname()[1]

    @property
    def url(self) -> str:
        """Its VISA address."""
        return f"TCPIP0::127.0.0.1::{self.port}::SOCKET"

    def drop(self) -> None:
        """Cut every connection."""
        for connection in self._connections:
            _closed(connection)
        self._connections.clear()

    def close(self) -> None:
        """Listen no longer."""
        self.over.set()
        _closed(self._server)
        self.drop()

    def _accept(self) -> None:
        while not self.over.is_set():
            try:
                connection, _ = self._server.accept()
            except OSError:
                return
            if self.over.is_set():
                connection.close()
                return
            self._connections.append(connection)
            threading.Thread(target=self._talk, args=(connection,), daemon=True).start()

    def _talk(self, connection: socket.socket) -> None:
        buffer = b""
        with contextlib.suppress(OSError):
            while data := connection.recv(4096):
                *lines, buffer = (buffer + data).split(b"\n")
                for line in lines:
                    answer = self.answer(line.decode("utf-8", "replace").strip())
                    if answer is not None:
                        time.sleep(self.delay_answers_s)
                        connection.sendall(f"{answer}\n".encode())


def _closed(line: socket.socket) -> None:
    """Close it also for a thread that waits on it; without the shutdown, the kernel keeps it open for that thread."""
    with contextlib.suppress(OSError):
        line.shutdown(socket.SHUT_RDWR)
    line.close()
