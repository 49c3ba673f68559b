"""A line that repeats, delays, reorders, drops, replays and changes frames, and goes on when the host has died.

Changed frames have a right check word: no framing can tell them from others.
"""

import random
import re
from collections import Counter, deque
from collections.abc import Callable

from rig.bench.simulated_time import SimulatedTime
from smarig.device.encoding.crc import crc16

Carry = Callable[[bytes], None]
KINDS = ("repeated", "delayed", "reordered", "dropped", "replayed", "changed")
KEPT = 5000  # frames of either direction that the line remembers
LATE_s = (0.02, 0.7)  # a delay: from much less than a tick to most of a lease
ARM_ORDERS = (1, 3)
_WORD = re.compile(r"(?<= )[0-9A-Fa-f]{1,4}(?= |$)")


class HostileLine:
    """Between one host and one device. ``share``: of the frames in each direction that suffer, each kind as often.

    ``answer`` is the device, ``arms`` tells its frames that arm, ``to_host`` is where replies go.
    """

    def __init__(
        self,
        time: SimulatedTime,
        framing: str,
        answer: Callable[[bytes], bytes | None],
        arms: Callable[[bytes], bool],
        draw: random.Random,
        share: float,
    ) -> None:
        self.to_host: Carry = lambda data: None
        self.counted: Counter[str] = Counter()
        self._time, self._framing, self._answer, self._arms = time, framing, answer, arms
        self._draw, self.share = draw, share
        self._requests: deque[bytes] = deque(maxlen=KEPT)
        self._replies: deque[bytes] = deque(maxlen=KEPT)
        self._armings: list[bytes] = []
        self._held: dict[str, list[Callable[[], None]]] = {"request": [], "reply": []}
        self.host_lives = True
        self.last_arrival_s = 0.0  # of a frame that had not arrived before

    def sent(self, request: bytes) -> None:
        """A frame of the host."""
        self._carried("request", request, self._requests, self._arrived, self._delivered)

    def _arrived(self, request: bytes) -> None:
        """For the first time, however late."""
        self.last_arrival_s = self._time()
        self._requests.append(request)
        if self._arms(request):
            self._armings.append(request)
        self._delivered(request)

    def _delivered(self, request: bytes) -> None:
        reply = self._answer(request)
        if reply is not None:
            self._replies.append(reply)
            self._carried("reply", reply, self._replies, self._received, self._received)

    def _received(self, reply: bytes) -> None:
        if self.host_lives:
            self.to_host(reply)

    def _carried(self, way: str, frame: bytes, before: deque[bytes], first: Carry, again: Carry) -> None:
        """What the line does with one frame, which arrives by ``first``; repetitions and old ones, by ``again``."""
        overtaken, self._held[way] = self._held[way], []
        suffers = self.host_lives and self._draw.random() < self.share
        kind = self._draw.choice(KINDS) if suffers else ""
        if kind:
            self.counted[f"{way} {kind}"] += 1
        if kind == "delayed":
            self._time.after(self._draw.uniform(*LATE_s), lambda: first(frame))
        elif kind == "reordered":
            self._held[way] = [lambda: first(frame)]
        elif kind == "replayed":
            both = [lambda: again(old), lambda: first(frame)] if (old := self._old(before)) else []
            self._draw.shuffle(both)
            for one in both or [lambda: first(frame)]:
                one()
        elif kind == "changed":
            first(changed(self._framing, frame, self._draw))
        elif kind != "dropped":
            first(frame)
            if kind == "repeated":
                again(frame)
        for late in overtaken:
            late()

    def _old(self, before: deque[bytes]) -> bytes:
        """A frame of before; of requests, one that arms in half of the cases."""
        if before is self._requests and self._armings and self._draw.random() < 0.5:
            return self._draw.choice(self._armings)
        return self._draw.choice(before) if before else b""

    def haunt(self) -> None:
        """Once the host is dead: the last frame again, or old ones."""
        if not self._requests:
            return
        for _ in range(self._draw.randrange(4)):
            recent = list(self._requests)[-20:]
            again = (recent[-1], self._draw.choice(recent), self._old(self._requests))
            self.counted["after death"] += 1
            self._delivered(self._draw.choice(again))


def changed(framing: str, frame: bytes, draw: random.Random) -> bytes:
    """The frame with one bit of its words, addresses or numbers flipped, and a check word that is right."""
    if framing == "lines":
        return _changed_line(frame, draw)
    first, end = (2, len(frame) - 2) if framing == "modbus_rtu" else (8, len(frame))
    spoilt = bytearray(frame)
    spoilt[draw.randrange(first, end)] ^= 1 << draw.randrange(8)
    if framing == "modbus_rtu":
        spoilt[end:] = crc16(spoilt[:end]).to_bytes(2, "little")
    return bytes(spoilt)


def _changed_line(line: bytes, draw: random.Random) -> bytes:
    end = b"\n" if line.endswith(b"\n") else b""
    body = line.decode().strip().rpartition(" *")[0]
    words = list(_WORD.finditer(body))
    if words:
        at = draw.choice(words)
        word = int(at[0], 16) ^ 1 << draw.randrange(16)
        body = f"{body[: at.start()]}{word:04X}{body[at.end() :]}"
    return f"{body} *{crc16(body.encode()):04X}".encode() + end
