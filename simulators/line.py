"""The line of one device: its port, its receivers, and the faults between them."""

import heapq
from itertools import count
from typing import NamedTuple

from simulators.framing import Receiver, ServerFraming
from simulators.line_troubles import LineFaults
from simulators.simulated_bench import SimulatedBench
from simulators.transports import Port

FRAME_END_s = 0.002  # of silence: more than 3.5 characters, and long enough for the timing of a computer


class _Late(NamedTuple):
    """A delayed reply; ``number`` keeps replies of one moment in order."""

    due_s: float
    number: int
    channel: int
    data: bytes


class DeviceLine:
    """The connection between a port and the device ``name`` of the bench."""

    def __init__(
        self, name: str, port: Port, framing: ServerFraming, world: SimulatedBench, line_faults: LineFaults
    ) -> None:
        self.name, self.port = name, port
        self._framing, self._world, self._line_faults = framing, world, line_faults
        self._receivers: dict[int, Receiver] = {}
        self._quiet_at_s: dict[int, float] = {}
        self._late: list[_Late] = []
        self._numbers = count()

    def channels(self) -> list[int]:
        """The channels to poll, after plugging or unplugging the port as the faults require."""
        if self._line_faults.plugged(self._world.time_s, self._world.exchanges[self.name]):
            self.port.plug()
        elif self.port.channels():
            self.port.unplug()
            self._receivers, self._quiet_at_s, self._late = {}, {}, []
        return self.port.channels()

    def requests(self, channel: int, now_s: float) -> list[bytes]:
        """The complete requests on a channel. When a channel ends, its incomplete request is dropped."""
        data = self.port.read(channel)
        if data is None:
            self._receivers.pop(channel, None)
            self._quiet_at_s.pop(channel, None)
            return []
        receiver = self._receivers.get(channel) or self._receivers.setdefault(
            channel, self._framing.receiver()
        )
        whole = receiver.take(data)
        if receiver.waits_for_silence:
            self._quiet_at_s[channel] = now_s + FRAME_END_s
        else:
            self._quiet_at_s.pop(channel, None)
        return whole

    def arrived(self, request: bytes) -> list[bytes]:
        """The parts of a request that reach the device."""
        self._world.exchanges[self.name] += 1
        return self._line_faults.requests(request, *self._moment())

    def send(self, channel: int, reply: bytes, now_s: float) -> None:
        """Send a reply, now or late. A late reply delays those after it, as on a line."""
        for delay_s, data in self._line_faults.replies(reply, *self._moment()):
            before_s = [late.due_s for late in self._late if late.channel == channel]
            if delay_s or before_s:
                due_s = max([now_s + delay_s, *before_s])
                heapq.heappush(self._late, _Late(due_s, next(self._numbers), channel, data))
            else:
                self.port.write(channel, data)

    def due(self, now_s: float) -> list[tuple[int, bytes]]:
        """Send the replies that are due; return the requests that silence has ended, with their channels."""
        while self._late and self._late[0].due_s <= now_s:
            late = heapq.heappop(self._late)
            if late.channel in self.port.channels():
                self.port.write(late.channel, late.data)
        quiet = [channel for channel, at_s in self._quiet_at_s.items() if at_s <= now_s]
        return [
            (channel, request)
            for channel in quiet
            if self._quiet_at_s.pop(channel)
            for request in self._receivers[channel].silence()
        ]

    def next_due_s(self) -> float | None:
        """The time at which ``due`` has something to do."""
        moments = [*self._quiet_at_s.values(), *(late.due_s for late in self._late[:1])]
        return min(moments, default=None)

    def _moment(self) -> tuple[float, int]:
        return self._world.time_s, self._world.exchanges[self.name]
