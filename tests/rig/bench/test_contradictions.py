"""A bench whose amplifier has another master, or whose line changes words: nothing false is recorded as good.

And what looks alike but is none: a command that took two attempts, and samples from before off or arm.
"""

import re

import pytest

from rig.bench.wired_bench import FILE, POLLS, Wired
from rig.bench.wired_time import ADDRESSES, PERIOD_s
from smarig.core.errors import RigFault
from smarig.core.sample import Quality
from smarig.device.drivers.smarig_amplifier import SmarigAmplifier, _settings
from smarig.device.encoding import lines, rtu
from smarig.device.encoding.exchange import Exchange
from smarig.device.encoding.register import load_register_map, to_words

MAP = load_register_map("amplifier")
OFF, ARM = 2, 1


@pytest.fixture(params=["lines", "modbus_rtu", "modbus_tcp"])
def wired(request, monkeypatch):
    return Wired(request.param, monkeypatch)


def test_a_bench_alone_has_no_contradiction(wired):
    assert wired.work() is None
    assert len(wired.samples) >= POLLS
    assert {s.quality for s in wired.samples} == {0}
    assert wired.wrong() == []


@pytest.mark.parametrize("moment", range(2, 20, 3))
def test_a_second_host_that_sets_another_current(wired, moment):
    """F9: 0.479 A flowed between two polls, and the samples said 0.758 A."""
    wired.work(moment)
    other = wired.other_host()
    echo = other.exchange(Exchange(7, 2))[1]
    other.exchange(Exchange(0, 14, 0x100, (0, echo + 1, 0, 1, 0, *to_words(479_000, 2))))
    assert wired.world.amplifier.output_uA == 479_000
    wired.world.time.sleep(PERIOD_s)
    fault = wired.work()
    assert fault is not None
    assert "Another program may use it" in str(fault)
    assert 479_000 in wired.world.driven_uA
    assert wired.wrong() == []
    assert any(s.quality & Quality.SUSPECT for s in wired.samples)
    assert (wired.world.amplifier.state, wired.world.amplifier.output_uA) == ("off", 0)
    assert [(a.level, a.kind, a.text) for a in wired.bench.alarms()] == [
        ("error", "contradiction", str(fault))
    ]


def test_a_second_host_that_polls_all_the_time(wired):
    """Each takes the other's commands for repetitions, or executes them."""
    other = wired.other_host()
    fault = None
    for k in range(POLLS):
        echo = other.exchange(Exchange(7, 2))[1]
        other.exchange(Exchange(0, 14, 0x100, (0, echo + 1, 0, 1, 0, *to_words(479_000 * (k % 2), 2))))
        fault = wired.work(1)
        if fault is not None:
            break
    assert fault is not None
    assert wired.wrong() == []


def test_a_second_host_that_opens_the_amplifier_as_its_own(wired):
    wired.work(4)
    second = SmarigAmplifier(wired.other_host(), _settings(FILE))
    second.set(0.479)
    wired.world.time.sleep(1.5 * PERIOD_s)
    assert wired.work() is not None, "the first one is told"
    assert 479_000 in wired.world.driven_uA
    assert wired.wrong() == []


def test_what_only_the_driver_finds_is_a_contradiction_too(wired):
    """Another host has written other settings, which no sample shows, least of all at zero current."""
    wired.step(0.3)
    wired.step(0.0)
    wired.world.bench.amplifier.stored["heat_max"] += 1

    def polled():
        for _ in range(3):
            wired.step(0.0)

    with pytest.raises(RigFault, match="its settings are not those that were written") as fault:
        polled()
    assert fault.type is RigFault, "no trip of the device"
    assert [(a.level, a.kind) for a in wired.bench.alarms()] == [("error", "contradiction")]
    assert wired.world.amplifier.output_uA == 0


@pytest.mark.parametrize("which", range(8))
@pytest.mark.parametrize("bit", [3, 16, 18])
def test_a_current_that_the_line_changed_with_a_right_check_word(wired, which, bit):
    """The how manieth command that sets a current; 2 to the power of ``bit`` µA more or less."""
    commands = []

    def change(request: bytes) -> bytes:
        e = wired.world.bench.decoded("amplifier", request)
        if e is None or e.write_at != 0x100 or len(e.words) < 7 or e.words[5] == e.words[6] == 0:
            return request
        commands.append(request)
        return resealed(wired.world.framing, request, e, bit) if len(commands) == which + 1 else request

    wired.change = change
    fault = wired.work()
    assert fault is not None
    refused = "out of its range" in str(fault)  # by the amplifier, before anything flowed
    assert refused or re.search(
        r"drives [\d.]+ A, but [\d.]+ A is ordered. .* its line changes words\.", str(fault)
    )
    assert refused or wired.samples[-1].quality & Quality.SUSPECT
    assert wired.wrong() == []
    wired.bench.safe()  # as a runner does
    assert (wired.world.amplifier.state, wired.world.amplifier.output_uA) == ("off", 0)


def resealed(framing: str, request: bytes, e: Exchange, bit: int) -> bytes:
    """The same request with another current."""
    raw = (e.words[5] << 16 | e.words[6]) ^ 1 << bit
    other = Exchange(e.read_at, e.count, e.write_at, (*e.words[:5], *to_words(raw, 2), *e.words[7:]))
    if framing == "lines":
        return lines.request(other).removesuffix(b"\n")
    frame = rtu.request(ADDRESSES["amplifier"], other)
    return frame if framing == "modbus_rtu" else request[:6] + frame[:-2]


@pytest.mark.parametrize("poll", range(1, 13))
def test_a_command_whose_first_attempt_was_executed_is_no_contradiction(wired, poll):
    """Its reply was lost; a tick and a half pass before it is repeated."""
    assert wired.work(poll) is None
    wired.lose_next_reply = True
    assert wired.work() is None
    assert not wired.lose_next_reply
    assert wired.repeated == 1 or wired.world.framing == "modbus_tcp"  # there it has another number
    assert not any(s.quality & Quality.SUSPECT for s in wired.samples)
    assert wired.wrong() == []
    assert wired.source.tripped == ""


@pytest.mark.parametrize("off_first", [True, False])
@pytest.mark.parametrize("late_ticks", [0.4, 1.6, 5.3, 9.2])
def test_samples_from_before_off_and_arm_are_no_contradiction(wired, late_ticks, off_first):
    for _ in range(4):
        wired.step(0.5)
    wired.world.time.sleep(late_ticks * PERIOD_s)  # they wait in the ring
    if off_first:
        wired.bench.safe()
        wired.world.time.sleep(2 * PERIOD_s)
    wired.bench.arm()
    wired.world.time.sleep(2 * PERIOD_s)
    for _ in range(12):
        wired.step(0.3)
    assert not any(s.quality & Quality.SUSPECT for s in wired.samples)
    assert wired.wrong() == []
    assert {0.5, 0.0, 0.3} <= {s.current_command_A for s in wired.samples}
    assert [s.tick for s in wired.samples] == list(
        range(wired.samples[0].tick, wired.samples[0].tick + len(wired.samples))
    )


def test_samples_from_before_a_trip_are_no_contradiction(wired):
    """A host that is late for longer than the lease reads what it missed after arming anew."""
    for _ in range(4):
        wired.step(0.5)
    wired.world.time.sleep(14.5 * PERIOD_s)
    fault = wired.work()
    assert fault is not None
    assert "lease" in str(fault)
    wired.bench.arm()
    assert wired.work() is None
    assert not any(s.quality & Quality.SUSPECT for s in wired.samples)
    assert wired.wrong() == []


def test_a_tick_that_says_another_output_than_its_reply_ends_the_run(wired):
    """The reply agrees, one record of the ring does not: a current flowed for a tick between two commands."""
    wired.work(3)
    other = wired.other_host()
    echo = other.exchange(Exchange(7, 2))[1]
    held = wired.world.amplifier.output_uA
    other.exchange(Exchange(0, 14, 0x100, (0, echo + 1, 0, 1, 0, *to_words(479_000, 2))))
    wired.world.time.sleep(PERIOD_s)
    other.exchange(Exchange(0, 14, 0x100, (0, echo + 2, 0, 1, 0, *to_words(held, 2))))
    wired.source.talk._sequence = echo + 2  # the host's word is new, so that only the ring tells
    fault = wired.work()
    assert fault is not None
    assert "The amplifier drove 0.479 A in its tick" in str(fault)
    assert wired.wrong() == []
    assert wired.world.amplifier.state == "off"
