"""A serial port with a simulated clock, whose far end replies as late as the test requires, without waiting."""

from collections.abc import Callable, Iterable

LOST = float("inf")


class LatePort:
    """What links use of a pyserial port. ``delays_s``: of the reply to each request in turn; LOST: there is none.

    Replies keep the order of their requests: one that is late keeps back those after it.
    """

    def __init__(self, answer: Callable[[bytes], bytes | None], delays_s: Iterable[float] = ()) -> None:
        self.now_s, self.timeout = 100.0, 0.0
        self._answer, self._delays_s = answer, iter(delays_s)
        self._coming: list[tuple[float, bytes]] = []
        self._there = b""

    def clock(self) -> float:
        return self.now_s

    def will_delay(self, delays_s: Iterable[float]) -> None:
        self._delays_s = iter(delays_s)

    def write(self, data: bytes) -> int:
        reply, delay_s = self._answer(data), 0.0
        if reply:
            delay_s = next(self._delays_s, 0.0)
        if reply and delay_s < LOST:
            before_s = self._coming[-1][0] if self._coming else 0.0
            self._coming.append((max(self.now_s + delay_s, before_s), reply))
        return len(data)

    @property
    def in_waiting(self) -> int:
        self._arrive()
        return len(self._there)

    def read(self, size: int = 1) -> bytes:
        """What is there; else time passes until something comes, or the timeout has."""
        if not self.in_waiting and self.timeout > 0:
            end_s = self.now_s + self.timeout
            self.now_s = min(self._coming[0][0], end_s) if self._coming else end_s
            self._arrive()
        data, self._there = self._there[:size], self._there[size:]
        return data

    def read_until(self, end: bytes, size: int) -> bytes:
        line = b""
        while not line.endswith(end) and len(line) < size and (more := self.read()):
            line += more
        return line

    def reset_input_buffer(self) -> None:
        self._arrive()
        self._there = b""

    def open(self) -> None:
        self.reset_input_buffer()

    def close(self) -> None:
        pass

    def _arrive(self) -> None:
        while self._coming and self._coming[0][0] <= self.now_s:
            self._there += self._coming.pop(0)[1]
