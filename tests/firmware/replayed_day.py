"""A host that works for a day and dies, and its frames, which are all said again while its current still flows."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple, Protocol

from firmware.codes import ARM, ARMED, LEASE, OFF, TRIPPED
from smarig.device.encoding import rtu
from smarig.device.encoding.exchange import Exchange
from smarig.device.encoding.register import RawValues, load_register_map, to_words

MAP = load_register_map("amplifier")
ADDRESS = MAP.device.default_address
HEAD, ECHO = MAP["ring"].address, MAP["echo"].address
LAST = MAP["sequence"].limits[1]
DAY = 864_000  # exchanges at 10 Hz
LEASE_TICKS = 5
CURRENT_uA = 500_000
REARMED = 1000  # exchanges after which a host switches off and arms again
AGAIN = 50  # frames of both ends of the day that are said in each tick after the lease


class Amplifier(Protocol):
    """An amplifier of any make, asked by frames of Modbus RTU; its ticks are given."""

    def boot(self, boot_count: int) -> None:
        """Start it again."""
        ...

    def answer(self, request: bytes) -> bytes:
        """The reply to one frame."""
        ...

    def tick(self, current_uA: int, voltage_uV: int, temperature: int, hardware: int) -> None:
        """One tick, in which this was measured."""
        ...


Tick = tuple[int, int, int, int]  # the inputs of one
Step = bytes | Tick


def carried_out(amplifier: Amplifier, steps: Sequence[Step]) -> list[bytes]:
    """The replies to frames, with ticks between them: at once, if the amplifier takes them so."""
    if hasattr(amplifier, "carry_out"):
        return amplifier.carry_out(steps)
    replies = []
    for step in steps:
        if isinstance(step, bytes):
            replies.append(amplifier.answer(step))
        else:
            amplifier.tick(*step)
    return replies


class Host:
    """A host that continues where the device is, and keeps every frame that it has sent."""

    def __init__(self, amplifier: Amplifier, boot_count: int) -> None:
        self._amplifier, self._boot_count = amplifier, boot_count
        self.frames: list[bytes] = []
        self._sequence = status(amplifier)["echo"]
        safe = {r.name: r.safe or 0 for r in MAP.blocks["settings"]}
        wide = {"current_max": 10**6, "slew_max": 10**6, "heat_max": 2**32 - 1}
        words = tuple(MAP.encode("settings", safe | wide))
        asked(amplifier, Exchange(0x200, len(words), 0x200, words))

    def command(self, **values: int) -> RawValues:
        """A new command, which must be executed."""
        proof = {"sequence": self._next(), "epoch": self._boot_count}
        e = Exchange(0, HEAD, 0x100, tuple(MAP.encode("command", {**proof, **values})))
        self.frames.append(rtu.request(ADDRESS, e))
        status_ = _decoded(e, self._amplifier.answer(self.frames[-1]))
        assert status_["echo"] == self._sequence
        return status_

    def drive(self, currents_uA: Sequence[int]) -> None:
        """New currents, and the tick of each. Only the echo is read: a day is long."""
        steps: list[Step] = []
        expected = []
        for current_uA in currents_uA:
            proof = (*to_words(self._next(), 2), *to_words(self._boot_count, 2))
            e = Exchange(ECHO, 2, 0x100, (*proof, 0, *to_words(current_uA, 2)))
            steps += [rtu.request(ADDRESS, e), _inputs(current_uA)]
            expected.append((e, to_words(self._sequence, 2)))
        self.frames += steps[::2]
        replies = carried_out(self._amplifier, steps)
        assert all(rtu.find(ADDRESS, e, r) == echo for (e, echo), r in zip(expected, replies, strict=True))

    def _next(self) -> int:
        self._sequence += 1
        return self._sequence

    def work(self, exchanges: int) -> None:
        """Arm and drive, a tick for each current; after so many exchanges current flows."""
        self._arm()
        while (made := len(self.frames)) < exchanges - 1:
            if made % REARMED == 0 and made < exchanges - 4:
                self._arm()
                made = len(self.frames)
            until = min(exchanges - 1, made - made % REARMED + REARMED)
            self.drive([number % CURRENT_uA for number in range(made, until)])
        assert self.command(current=CURRENT_uA)["output"] == CURRENT_uA

    def _arm(self) -> None:
        self.command(order=OFF)
        self.command(order=ARM, nonce=status(self._amplifier)["arm_nonce"])


class Outcome(NamedTuple):
    """Ticks with current since the host's last command, and what the amplifier is at after that."""

    ticks_with_current: int
    after: RawValues


def replayed(amplifier: Amplifier, frames: list[bytes]) -> Outcome:
    """All frames again within the lease; then again, from both ends, after it."""
    flowed = 0
    for part in (*_parts(frames, LEASE_TICKS + 1), frames[:AGAIN], frames[-AGAIN:], frames[:AGAIN]):
        carried_out(amplifier, part)
        output_uA = status(amplifier)["output"]
        flowed += output_uA != 0
        _tick(amplifier, output_uA)
    return Outcome(flowed, status(amplifier))


def assert_dead(outcome: Outcome, echo: int) -> None:
    """0 A after the lease, and not one frame was executed."""
    assert outcome.ticks_with_current == LEASE_TICKS + 1
    after = outcome.after
    assert (after["state"], after["trip"], after["output"], after["echo"]) == (TRIPPED, LEASE, 0, echo)


def survive(amplifier: Amplifier, exchanges: int, boots: tuple[int, int]) -> int:
    """The whole campaign; how many frames were said again.

    The host dies; its successor, in the same boot, dies; after a restart, whose count of boots is the second one given,
    the next one dies. Each time all frames of all hosts are said again while the current of the last one flows.
    """
    frames: list[bytes] = []
    said = 0
    for boot_count, started, count in (
        (boots[0], True, exchanges),
        (boots[0], False, 3),
        (boots[1], True, 3),
    ):
        if started:
            amplifier.boot(boot_count)
        if status(amplifier)["echo"] > LAST - 3:
            continue  # this boot has no number left for a host
        host = Host(amplifier, boot_count)
        host.work(count)
        frames += host.frames
        before = status(amplifier)
        assert before["state"] == ARMED
        assert_dead(replayed(amplifier, frames), before["echo"])
        said += len(frames)
    return said


def status(amplifier: Amplifier) -> RawValues:
    """As it is read, which feeds nothing."""
    e = Exchange(0, HEAD)
    return _decoded(e, amplifier.answer(rtu.request(ADDRESS, e)))


def asked(amplifier: Amplifier, e: Exchange) -> list[int]:
    """The words of a reply."""
    words = rtu.find(ADDRESS, e, amplifier.answer(rtu.request(ADDRESS, e)))
    assert isinstance(words, list), words
    return words


def _decoded(e: Exchange, reply: bytes) -> RawValues:
    words = rtu.find(ADDRESS, e, reply)
    assert isinstance(words, list), words
    return MAP.decode("status", words)


def _tick(amplifier: Amplifier, output_uA: int) -> None:
    amplifier.tick(*_inputs(output_uA))


def _inputs(output_uA: int) -> Tick:
    return output_uA, 5 * output_uA, -32768, 0


def _parts(frames: list[bytes], count: int) -> Iterator[list[bytes]]:
    size = -(-len(frames) // count)
    return (frames[k * size : (k + 1) * size] for k in range(count))
