"""The times of the ticks: by the wall clock, or only when the host requests samples of the future
(lock-step)."""

from collections.abc import Callable
from typing import Protocol

from simulators.layout import RegisterLayout
from simulators.register_device import is_new, ticks_after
from simulators.simulated_bench import DAQ, SimulatedBench
from smarig.device import Exchange, Refusal, load_register_map

Tick = Callable[[], None]
MAX_CATCH_UP_TICKS = 100  # late ticks between two polls of the ports, so that a slow bench still answers
HOST_TIMEOUT_s = (
    1.0  # of silence in lock-step, by default; then the host has failed and the lease must expire
)


class Pace(Protocol):
    """Controls device time. ``now_s`` is the monotonic wall clock."""

    def host_active(self, now_s: float) -> None:
        """Called when data arrive on any line."""
        ...

    def before_answer(self, name: str, request: bytes) -> None:
        """Called before a request is answered."""
        ...

    def host_ended(self, now_s: float) -> None:
        """Called when standard input has ended and no more requests will come."""
        ...

    def catch_up(self, now_s: float) -> None:
        """Execute the ticks that are due."""
        ...

    def next_due_s(self) -> float | None:
        """Wall-clock time of the next tick; None if there is none."""
        ...


class RealTime:
    """One tick per ``period_s`` of the wall clock. Late ticks are caught up."""

    def __init__(self, tick: Tick, period_s: float, start_s: float) -> None:
        self._tick, self._period_s, self._start_s = tick, period_s, start_s
        self._done = 0

    def host_active(self, now_s: float) -> None:
        """No effect in real time."""

    def before_answer(self, name: str, request: bytes) -> None:
        """No effect in real time."""

    def host_ended(self, now_s: float) -> None:
        """No effect in real time."""

    def catch_up(self, now_s: float) -> None:
        """Execute the ticks up to now, at most ``MAX_CATCH_UP_TICKS``."""
        for _ in range(MAX_CATCH_UP_TICKS):
            if self.next_due_s() > now_s:
                break
            self._done += 1
            self._tick()

    def next_due_s(self) -> float:
        """Time of the next tick, counted from the start so that rounding errors do not add up."""
        return self._start_s + (self._done + 1) * self._period_s


class LockStep:
    """Ticks only when the host requests new samples from the DAQ, and in real time while the host is silent."""

    def __init__(self, world: SimulatedBench, tick: Tick, host_timeout_s: float = HOST_TIMEOUT_s) -> None:
        self._world, self._tick, self._host_timeout_s = world, tick, host_timeout_s
        self._map = load_register_map(DAQ)
        self._layout = RegisterLayout(self._map)
        self._last_request_s: float | None = None
        self._host_ended = False
        self._free_running: RealTime | None = None

    def host_active(self, now_s: float) -> None:
        """Let time wait for the host again."""
        self._last_request_s = now_s
        if not self._host_ended:
            self._free_running = None

    def before_answer(self, name: str, request: bytes) -> None:
        """Execute the ticks up to the newest requested sample, but no more than samples were requested."""
        exchange = self._world.decoded(name, request) if name == DAQ else None
        wanted = self._wanted(exchange) if exchange else None
        if not wanted:
            return
        last_tick, most = wanted
        while ticks_after(last_tick, self._world.daq.newest_tick) > 0 and most > 0:
            self._tick()
            most -= 1

    def _wanted(self, exchange: Exchange) -> tuple[int, int] | None:
        """Tick of the last requested sample and number of samples; None if the command is not new or will be
        refused."""
        if not exchange.words or self._layout.refuses(exchange):
            return None
        values = self._layout.values(exchange)
        if isinstance(values, Refusal) or "sequence" not in values:
            return None
        if not is_new(values, self._world.daq.boot_count, self._world.daq.echo):
            return None
        most = values.get("ring_want", 0)
        return values.get("ring_next", 0) + most - 1, most

    def host_ended(self, now_s: float) -> None:
        """Let time follow the clock from now on."""
        self._host_ended = True
        self._free_running = self._free_running or self._real_time_from(now_s)

    def catch_up(self, now_s: float) -> None:
        """Execute free ticks if the host has been silent for too long."""
        if self._free_running is None and self._silent_until_s() <= now_s:
            self._free_running = self._real_time_from(self._silent_until_s())
        if self._free_running is not None:
            self._free_running.catch_up(now_s)

    def next_due_s(self) -> float | None:
        """Time of the next free tick, or of the start of free ticks."""
        if self._free_running is not None:
            return self._free_running.next_due_s()
        return self._silent_until_s() if self._last_request_s is not None else None

    def _real_time_from(self, start_s: float) -> RealTime:
        return RealTime(self._tick, self._world.period_s, start_s)

    def _silent_until_s(self) -> float:
        """The end of the permitted silence. It starts with the first message of the host."""
        return float("inf") if self._last_request_s is None else self._last_request_s + self._host_timeout_s
