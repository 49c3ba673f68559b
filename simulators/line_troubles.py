"""Faults that act on the bytes between the host and one device."""

import random
from collections.abc import Iterable
from typing import NamedTuple

from simulators.faults import (
    DeadLine,
    Delayed,
    Dropped,
    ForeignBytes,
    GarbledBytes,
    Repeated,
    SimulatedFault,
    Unplugged,
)


class Late(NamedTuple):
    """A reply and its delay."""

    delay_s: float
    data: bytes


class LineFaults:
    """The faults of one device's line. Random choices follow from the fault's seed and the number of the
    exchange."""

    def __init__(self, faults: Iterable[SimulatedFault]) -> None:
        self._faults = tuple(faults)

    def plugged(self, time_s: float, exchange: int) -> bool:
        """Whether the port is present."""
        return not any(isinstance(f, Unplugged) and f.active(time_s, exchange) for f in self._faults)

    def dead(self, time_s: float, exchange: int) -> bool:
        """Whether the line carries nothing."""
        return any(isinstance(f, DeadLine) and f.active(time_s, exchange) for f in self._faults)

    def requests(self, data: bytes, time_s: float, exchange: int) -> list[bytes]:
        """What arrives at the device for one request."""
        if not self._faults:
            return [data]
        return self._carried(data, "request", time_s, exchange)

    def replies(self, data: bytes, time_s: float, exchange: int) -> list[Late]:
        """What arrives at the host for one reply, with its delay."""
        if not self._faults:
            return [Late(0, data)]
        delay_s = 0.0
        for fault, draw in self._struck("reply", time_s, exchange):
            if isinstance(fault, ForeignBytes):
                data = draw.randbytes(fault.bytes) + data
            elif isinstance(fault, Delayed):
                delay_s += fault.delay_s
        return [Late(delay_s, copy) for copy in self._carried(data, "reply", time_s, exchange)]

    def _carried(self, data: bytes, direction: str, time_s: float, exchange: int) -> list[bytes]:
        if self.dead(time_s, exchange):
            return []
        copies = 1
        for fault, draw in self._struck(direction, time_s, exchange):
            if getattr(fault, "direction", "") != direction:
                continue
            if isinstance(fault, Dropped):
                copies = 0
            elif isinstance(fault, Repeated):
                copies *= 2
            elif isinstance(fault, GarbledBytes):
                data = _garbled(data, draw)
        return [data] * copies

    def _struck(
        self, direction: str, time_s: float, exchange: int
    ) -> Iterable[tuple[SimulatedFault, random.Random]]:
        for number, fault in enumerate(self._faults):
            if not fault.active(time_s, exchange):
                continue
            draw = random.Random(f"{getattr(fault, 'seed', 0)} {number} {direction} {exchange}")
            if draw.random() < getattr(fault, "share", 1):
                yield fault, draw


def _garbled(data: bytes, draw: random.Random) -> bytes:
    if not data:  # an empty message has no bits
        return data
    at = draw.randrange(len(data))
    return data[:at] + bytes([data[at] ^ 1 << draw.randrange(8)]) + data[at + 1 :]
