"""The main loop of a bench: bytes, ticks and the end of standard input in one poll, without threads."""

import contextlib
import os
import select
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from simulators.line import DeviceLine
from simulators.pace import Pace
from simulators.simulated_bench import SimulatedBench

LONGEST_SLEEP_s = 0.1  # so that a stop by a signal is noticed


HEAD = "tick,wall_s,output_uA,state,trip,counts\n"


class Server:
    """Serves until standard input has ended and ``afterwards_s`` have passed, or until ``stop``."""

    def __init__(
        self,
        world: SimulatedBench,
        lines: Sequence[DeviceLine],
        pace: Pace,
        host: int,
        afterwards_s: float,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._world, self._lines, self._pace = world, lines, pace
        self._host, self._afterwards_s, self._clock = host, afterwards_s, clock
        self._end_s = float("inf")
        self._stopped = False
        self._poll = select.poll()
        self._polled: dict[int, DeviceLine] = {}
        self._poll.register(host, select.POLLIN)

    def stop(self) -> None:
        """Stop at the end of the present round."""
        self._stopped = True

    def run(self) -> None:
        """Run rounds until the end."""
        while not self._stopped and self._clock() < self._end_s:
            self._listen()
            events = self._poll.poll(1000 * self._sleep_s())
            now_s = self._clock()
            if any(channel in self._polled for channel, _ in events):
                self._pace.host_active(now_s)  # the host has sent data; this process was delayed
            self._pace.catch_up(now_s)
            for channel, _ in events:
                self._serve(channel, now_s)
            for line in self._lines:
                for channel, request in line.due(now_s):
                    self._answer(line, channel, request, now_s)

    def _listen(self) -> None:
        """Update the polled channels, since ports appear and disappear."""
        wanted = {channel: line for line in self._lines for channel in line.channels()}
        if wanted.keys() == self._polled.keys():
            return
        for channel in self._polled.keys() - wanted.keys():
            with contextlib.suppress(KeyError):
                self._poll.unregister(channel)
        for channel in wanted.keys() - self._polled.keys():
            self._poll.register(channel, select.POLLIN)
        self._polled = wanted

    def _sleep_s(self) -> float:
        moments = [self._pace.next_due_s(), *(line.next_due_s() for line in self._lines)]
        first_s = min((m for m in moments if m is not None), default=float("inf"))
        return min(max(first_s - self._clock(), 0), LONGEST_SLEEP_s)

    def _serve(self, channel: int, now_s: float) -> None:
        line = self._polled.get(channel)
        if line is not None:
            for request in line.requests(channel, now_s):
                self._answer(line, channel, request, now_s)
        elif channel == self._host and not os.read(self._host, 4096):
            self._poll.unregister(self._host)
            self._pace.host_ended(now_s)
            self._end_s = now_s + self._afterwards_s

    def _answer(self, line: DeviceLine, channel: int, request: bytes, now_s: float) -> None:
        for arrived in line.arrived(request):
            self._pace.host_active(now_s)
            self._pace.before_answer(line.name, arrived)
            reply = self._world.answer(line.name, arrived)
            if reply is not None:
                line.send(channel, reply, now_s)


class TickTrace:
    """A CSV file of the ticks. Each row is flushed as soon as its tick is over."""

    def __init__(self, path: Path) -> None:
        self._file = path.open("x", encoding="utf-8", buffering=1)  # never in place of another file
        self._start_s = time.monotonic()
        self._file.write(HEAD)

    def write(self, world: SimulatedBench) -> None:
        """Write the last tick: the current that flowed and the reading of the amplifier."""
        wall_s = time.monotonic() - self._start_s
        state, trip = world.amplifier.state, world.amplifier.trip
        self._file.write(f"{world.ticks},{wall_s:.4f},{world.flowed_uA},{state},{trip},{world.raw_counts}\n")
