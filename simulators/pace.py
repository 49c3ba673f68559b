"""When ticks happen: by the wall clock, or only when a host asks for what has not been measured yet.

Knows sequence words and ring windows as far as lock-step needs them. Refuses to know bytes and ports.
"""

from collections.abc import Callable
from typing import Protocol

from simulators.layout import RegisterLayout
from simulators.world import DAQ, SimulatedBench
from smarig.device import Exchange, Refusal, load_register_map

Tick = Callable[[], None]
MAX_CATCH_UP_TICKS = 100  # late ticks between two looks at the ports: a bench that is too slow still answers
HOST_TIMEOUT_s = (
    1.0  # of silence, in lock-step, unless said otherwise: the host is dead or stuck, the lease must run out
)


class Pace(Protocol):
    """Decides about device time; ``now_s`` is the monotonic wall clock."""

    def host_active(self, now_s: float) -> None:
        """Anything at all came over any line."""
        ...

    def before_answer(self, name: str, request: bytes) -> None:
        """A request is about to be answered."""
        ...

    def host_ended(self, now_s: float) -> None:
        """Standard input ended: from now on nobody will ask."""
        ...

    def catch_up(self, now_s: float) -> None:
        """Let the ticks happen that are due."""
        ...

    def next_due_s(self) -> float | None:
        """When the next tick is due by the wall clock; None where none is."""
        ...


class RealTime:
    """A tick every ``period_s`` of the wall clock; late ones are made up for."""

    def __init__(self, tick: Tick, period_s: float, start_s: float) -> None:
        self._tick, self._period_s, self._start_s = tick, period_s, start_s
        self._done = 0

    def host_active(self, now_s: float) -> None:
        """Time does not care."""

    def before_answer(self, name: str, request: bytes) -> None:
        """Time does not care."""

    def host_ended(self, now_s: float) -> None:
        """Time does not care."""

    def catch_up(self, now_s: float) -> None:
        """Ticks up to now, as far as they can be made up for at once."""
        for _ in range(MAX_CATCH_UP_TICKS):
            if self.next_due_s() > now_s:
                break
            self._done += 1
            self._tick()

    def next_due_s(self) -> float:
        """Counted from the start, so that no rounding adds up."""
        return self._start_s + (self._done + 1) * self._period_s


class LockStep:
    """Ticks only when the DAQ is asked anew for a sample of the future; in real time while the host is gone."""

    def __init__(self, world: SimulatedBench, tick: Tick, host_timeout_s: float = HOST_TIMEOUT_s) -> None:
        self._world, self._tick, self._host_timeout_s = world, tick, host_timeout_s
        self._map = load_register_map(DAQ)
        self._layout = RegisterLayout(self._map)
        self._last_request_s: float | None = None
        self._host_ended = False
        self._free_running: RealTime | None = None

    def host_active(self, now_s: float) -> None:
        """The host lives: time waits for it again."""
        self._last_request_s = now_s
        if not self._host_ended:
            self._free_running = None

    def before_answer(self, name: str, request: bytes) -> None:
        """As many ticks as the newest sample asked for needs, and no more than samples were asked for."""
        exchange = self._world.decoded(name, request) if name == DAQ else None
        wanted = self._wanted(exchange) if exchange else None
        if not wanted:
            return
        last_tick, most = wanted
        while self._world.daq.newest_tick < last_tick and most > 0:
            self._tick()
            most -= 1

    def _wanted(self, exchange: Exchange) -> tuple[int, int] | None:
        """Tick of the last sample asked for, and how many; None where it is no new command or will be refused."""
        if not exchange.words or self._layout.refuses(exchange):
            return None
        values = self._layout.values(exchange)
        if isinstance(values, Refusal) or values.get("sequence") in (None, self._world.daq.echo):
            return None
        most = values.get("ring_want", 0)
        return values.get("ring_next", 0) + most - 1, most

    def host_ended(self, now_s: float) -> None:
        """Nobody will ask: time runs by itself, for good."""
        self._host_ended = True
        self._free_running = self._free_running or self._real_time_from(now_s)

    def catch_up(self, now_s: float) -> None:
        """Free ticks, where the host has not been heard for too long."""
        if self._free_running is None and self._silent_until_s() <= now_s:
            self._free_running = self._real_time_from(self._silent_until_s())
        if self._free_running is not None:
            self._free_running.catch_up(now_s)

    def next_due_s(self) -> float | None:
        """Of a free tick, or of the moment when time begins to run."""
        if self._free_running is not None:
            return self._free_running.next_due_s()
        return self._silent_until_s() if self._last_request_s is not None else None

    def _real_time_from(self, start_s: float) -> RealTime:
        return RealTime(self._tick, self._world.period_s, start_s)

    def _silent_until_s(self) -> float:
        """Before a host was ever there, none can be gone."""
        return float("inf") if self._last_request_s is None else self._last_request_s + self._host_timeout_s
