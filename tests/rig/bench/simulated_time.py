"""Time that passes only when somebody waits, and ports of a host that wait in it: nothing depends on the machine."""

import heapq
from collections.abc import Callable
from itertools import count
from typing import ClassVar

from pymodbus.client import ModbusTcpClient

Action = Callable[[], None]


class SimulatedTime:
    """A clock, ``sleep``, and what happens at its moments."""

    def __init__(self) -> None:
        self.now_s = 100.0
        self._coming: list[tuple[float, int, Action]] = []
        self._numbers = count()

    def __call__(self) -> float:
        return self.now_s

    def after(self, delay_s: float, action: Action) -> None:
        """Let something happen later."""
        heapq.heappush(self._coming, (self.now_s + delay_s, next(self._numbers), action))

    def every(self, period_s: float, action: Action) -> None:
        """Let something happen again and again."""

        def again() -> None:
            action()
            self.after(period_s, again)

        self.after(period_s, again)

    def sleep(self, seconds: float, enough: Callable[[], object] = lambda: False) -> None:
        """Pass, until ``enough`` of it at most."""
        end_s = self.now_s + seconds
        while self._coming and self._coming[0][0] <= end_s and not enough():
            self.now_s, _, action = heapq.heappop(self._coming)
            action()
        if not enough():
            self.now_s = end_s


class HostPort:
    """What links use of a pyserial port. ``send``: where its bytes go; ``arrive`` is what comes back."""

    def __init__(self, time: SimulatedTime, send: Callable[[bytes], None]) -> None:
        self.timeout = 0.0
        self._time, self._send = time, send
        self._there = b""

    def arrive(self, data: bytes) -> None:
        self._there += data

    def write(self, data: bytes) -> int:
        self._send(data)
        return len(data)

    @property
    def in_waiting(self) -> int:
        return len(self._there)

    def read(self, size: int = 1) -> bytes:
        """What is there; else time passes until something comes, or the timeout has."""
        self._time.sleep(0 if self._there else self.timeout, lambda: self._there)
        data, self._there = self._there[:size], self._there[size:]
        return data

    def reset_input_buffer(self) -> None:
        self._there = b""

    def open(self) -> None:
        self._there = b""

    def close(self) -> None:
        self._there = b""


class HostClient(ModbusTcpClient):
    """pymodbus's client, all of it but its socket: that is a port. What comes for a closed connection is lost."""

    port_of: ClassVar[dict[int, HostPort]] = {}  # by TCP port

    def __init__(self, host: str, port: int, timeout: float, retries: int) -> None:
        super().__init__(host, port=port, timeout=timeout, retries=retries)
        self._port = self.port_of[port]
        self._port.timeout = timeout

    def connect(self) -> bool:
        if not self.socket:
            self._port.open()
            self.socket = self._port
        return True

    def send(self, request: bytes, addr: tuple | None = None) -> int:
        del addr
        return self._port.write(request)

    def recv(self, size: int | None) -> bytes:
        return self._port.read(size or 4096)
