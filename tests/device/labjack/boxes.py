"""What the tests of the LabJack drivers share: rig files, a simulated box, and a line with faults in front of it."""

import contextlib
import selectors
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from simulators.labjack import LabJackServer
from simulators.labjack_wire import LabJackWire
from smarig.config import LinkFile, RigFile, load_rig
from smarig.config.config_files import merged_tables
from smarig.rig import TwinSettings

SPEED = 10.0

VOLTAGE_STAGE = {"dac": 1, "volts_per_volt": 2.0}
INPUTS = {
    "current_input": {"channel": 0, "scale": 1.0},
    "voltage_input": {"channel": 1, "scale": 2.0, "range_V": 10.0},
}


def rig(url: str = "", roles: dict[str, Any] | None = None, **changed: Any) -> RigFile:
    """The shipped rig at an address, with further links and other values."""
    file = load_rig("labjack_one_wire")
    assert file.links is not None
    table = file.model_dump(exclude_none=True)
    table["simulator"] |= {"start": False, "speed": SPEED}
    for link in table["links"].values():
        link["url"] = url
    table = merged_tables(table, changed)
    for name, (driver, settings) in (roles or {}).items():
        table["links"][name] = {
            "driver": driver,
            "framing": "modbus_tcp",
            "url": url,
            "settings": settings,
        }
    return RigFile.model_validate(table)


@contextmanager
def running_box(
    roles: dict[str, Any] | None = None, product: int = 7, speed: float = SPEED, seed: int = 0
) -> Iterator[LabJackServer]:
    """A simulated LabJack wired as a rig file says."""
    server = LabJackServer(LabJackWire(rig(roles=roles), TwinSettings(seed=seed), product), speed).start()
    try:
        yield server
    finally:
        server.close()


def link_of(file: RigFile, role: str) -> LinkFile:
    """A link of a rig file."""
    return getattr(file.links, role)


class FaultyLine:
    """Passes bytes between a host and a box, and spoils them on order."""

    def __init__(self, url: str) -> None:
        self._to = ("127.0.0.1", int(url.rsplit(":", 1)[1]))
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.url = f"tcp://127.0.0.1:{self._listener.getsockname()[1]}"
        self.swallow = self.garble = 0  # replies that are dropped, or changed
        self._pairs: dict[socket.socket, socket.socket] = {}
        self._replies: set[socket.socket] = set()
        self._selector = selectors.DefaultSelector()
        self._selector.register(self._listener, selectors.EVENT_READ)
        self._over = False
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def cut(self) -> None:
        """Close all connections; new ones are accepted."""
        for one in list(self._pairs):
            with contextlib.suppress(OSError):
                one.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        """End."""
        self._over = True
        self._thread.join(5)
        for one in (self._listener, *self._pairs):
            one.close()

    def _serve(self) -> None:
        while not self._over:
            for key, _ in self._selector.select(0.02):
                if key.fileobj is self._listener:
                    self._let_in()
                elif isinstance(key.fileobj, socket.socket) and key.fileobj in self._pairs:
                    self._pass(key.fileobj)

    def _let_in(self) -> None:
        host, box = self._listener.accept()[0], socket.create_connection(self._to)
        self._replies.add(box)
        for one, other in ((host, box), (box, host)):
            self._pairs[one] = other
            self._selector.register(one, selectors.EVENT_READ)

    def _pass(self, one: socket.socket) -> None:
        data = b""
        with contextlib.suppress(OSError):
            data = one.recv(4096)
        other = self._pairs[one]
        if not data:
            for end in (one, other):
                self._selector.unregister(end)
                self._pairs.pop(end).close() if end in self._pairs else None
                end.close()
            return
        if one in self._replies:
            if self.swallow:
                self.swallow -= 1
                return
            if self.garble:
                self.garble -= 1
                data = data[:7] + bytes(b ^ 0x55 for b in data[7:])
        with contextlib.suppress(OSError):
            other.sendall(data)


@contextmanager
def faulty_line(url: str) -> Iterator[FaultyLine]:
    """A line to a box."""
    line = FaultyLine(url)
    try:
        yield line
    finally:
        line.close()
