"""Sequences, boots, orders, ticks and counts where they end or go round, in Python and C: counting begins just below.

``SMARIG_LONG=1`` replays a whole day of frames at 10 Hz, 864,000 of them, after each.
"""

import pytest

from firmware.codes import ARM, ARMED, LEASE, OFF, TRIPPED
from firmware.firmware_build import RTU, Device, make, open_library
from firmware.python_device import PythonDevice
from firmware.replayed_day import DAY, LAST, MAP, Host, asked, assert_dead, replayed, status, survive
from simulators import register_device
from smarig.device.encoding.exchange import Exchange

SHORT = 400
BOOT = 7
WORD, HALF, ALL = 2**16, 2**31, 2**32
WRAPS = {  # the sequence at or before which the host begins, the tick, the boots
    "a word": (WORD - 150, WORD - 100, (7, 8)),
    "half of all": (HALF - 150, ALL - 100, (7, 7 + WORD)),
    "the end of all": (None, HALF - 100, (ALL - 1, 0)),
}
DAYS = [(wrap, SHORT) for wrap in WRAPS]
# a day passes 13 words
DAYS += [pytest.param(wrap, DAY, marks=pytest.mark.long("some minutes each")) for wrap in list(WRAPS)[1:]]


@pytest.fixture(scope="session")
def begun(build_folder):
    """Devices of a language whose counting begins at a sequence and a tick."""
    built = {}

    def device(language, name="amplifier", sequence=0, tick=0, boot_count=BOOT):
        if language == "Python":
            return PythonDevice(boot_count, name, sequence, tick)
        key = f"{sequence}_{tick}"
        if key not in built:
            variables = (f"FIRST_SEQUENCE={sequence}", f"FIRST_TICK={tick}")
            built[key] = open_library(make(build_folder / key, "libsmarig_firmware.so", ("gcc",), *variables))
        return Device(built[key], name, boot_count)

    return device


class Framed:
    """A ``Device`` that is asked by frames of Modbus RTU."""

    def __init__(self, device):
        self._device = device
        self.boot, self.tick = device.boot, device.tick

    def answer(self, request):
        return self._device.answer(request, RTU)


# --- a day of frames, said again ---


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize(("wrap", "exchanges"), DAYS)
@pytest.mark.parametrize("language", ["C", "Python"])
def test_no_frame_of_a_day_is_new_again(begun, language, wrap, exchanges):
    """Sequence and tick wrap, or end, within the day; in the boot after it numbers begin where they did before."""
    sequence, tick, boots = WRAPS[wrap]
    amplifier = Framed(begun(language, sequence=sequence or LAST - exchanges, tick=tick))
    said = survive(amplifier, exchanges, boots)
    print(f"{language}, {wrap}: {said:,} frames said again, 0 A after the lease")
    assert said >= 2 * exchanges


@pytest.mark.long("130,000 orders each")
@pytest.mark.parametrize("language", ["Python", "C"])
def test_nor_after_as_many_orders_as_a_word_holds(begun, language):
    amplifier = Framed(begun(language))
    amplifier.boot(BOOT)
    host = Host(amplifier, BOOT)
    for _ in range(WORD - 50):
        host.command(order=OFF)
    host.frames.clear()
    host.work(SHORT)
    nonce = status(amplifier)["arm_nonce"]
    for _ in range(WORD):  # until the nonce is the same
        host.command(order=OFF)
    assert status(amplifier)["arm_nonce"] == nonce
    host.work(len(host.frames) + 3)
    assert_dead(replayed(amplifier, host.frames), status(amplifier)["echo"])


@pytest.mark.parametrize("language", ["Python", "C"])
def test_after_the_last_number_nothing_is_executed_until_a_restart(begun, language):
    amplifier = Framed(begun(language, sequence=LAST - 4))
    amplifier.boot(BOOT)
    host = Host(amplifier, BOOT)
    host.work(4)
    assert status(amplifier)["echo"] == LAST
    words = MAP.encode("command", {"sequence": 1, "epoch": BOOT, "order": OFF})
    assert asked(amplifier, Exchange(7, 2, 0x100, tuple(words))) == [0xFFFF, 0xFFFF]
    assert_dead(replayed(amplifier, host.frames), LAST)


FORMER_RULES = {
    "numbers that go round": lambda values, boot, echo: (
        values.get("epoch") == boot and 1 <= (values["sequence"] - echo) % 300 <= 256
    ),
    "a boot that is not asked": lambda values, boot, echo: 1 <= values["sequence"] - echo <= 256,
}


@pytest.mark.parametrize("rule", FORMER_RULES.values(), ids=FORMER_RULES)
def test_the_campaign_sees_what_feeds_the_lease(begun, monkeypatch, rule):
    monkeypatch.setattr(register_device, "is_new", rule)
    with pytest.raises(AssertionError):
        survive(Framed(begun("Python")), SHORT, (7, 8))


# --- ticks and the ring ---

AROUND = [WORD - 5, HALF - 5, ALL - 5]  # ticks before the one that wraps


def names(tick):
    """What a test puts into the sample of a tick: a part of its number."""
    return tick % 1000


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("first", AROUND)
@pytest.mark.parametrize("name", ["amplifier", "encoder_daq"])
@pytest.mark.parametrize("language", ["Python", "C"])
def test_samples_around_a_wrap_of_the_tick(begun, language, name, first):
    device = begun(language, name, tick=first)
    rest = (0, 0, 0) if name == "amplifier" else (0, 0)
    most = {"amplifier": 12, "encoder_daq": 24}[name]
    for tick in range(first + 1, first + 1001):
        device.tick(names(tick), *rest)
        now = tick - first
        if now in (1, 4, 5, 6, 7, 12, 25, 300, 1000):
            for ago in (0, 4, 11, 40, 300):  # the last: before the ring of an amplifier, or before boot
                kept = min(now, {"amplifier": 256, "encoder_daq": 1024}[name])
                begins = tick - min(ago, kept - 1)
                expected = list(range(begins, tick + 1))[:most]
                assert device.command(ring_next=(tick - ago) % ALL, ring_want=most) == 0
                status = device.status()
                assert (status["tick"], status["ring_first"]) == (tick % ALL, begins % ALL)
                assert [sample[0] for sample in status.samples] == list(map(names, expected))
            device.command(ring_next=(tick + 1) % ALL, ring_want=most)
            assert (device.status()["ring_first"], device.status()["ring_count"]) == ((tick + 1) % ALL, 0)


@pytest.mark.parametrize("first", AROUND)
@pytest.mark.parametrize("language", ["Python", "C"])
def test_the_lease_runs_out_across_a_wrap_of_the_tick(begun, language, first):
    amp = begun(language, tick=first)
    assert amp.settings(current_max=10**6, slew_max=10**6, heat_max=ALL - 1) == 0
    assert amp.command(order=ARM, current=100_000) == 0
    amp.tick(100_000, 500_000, 0, 0, times=2)
    amp.command(current=100_000)
    amp.tick(100_000, 500_000, 0, 0, times=5)
    assert (amp.status()["state"], amp.status()["tick"]) == (ARMED, (first + 7) % ALL)
    amp.tick(100_000, 500_000, 0, 0)
    assert (amp.status()["state"], amp.status()["trip"], amp.output_uA) == (TRIPPED, LEASE, 0)


@pytest.mark.parametrize("language", ["Python", "C"])
def test_the_window_of_a_ring_that_is_full_twice(begun, language):
    """The index of the ring goes round with 1024 samples, the tick between them."""
    daq = begun(language, "encoder_daq", tick=ALL - 700)
    for tick in range(1, 2501):
        daq.tick(tick, 0, 0)
    for ago in (1023, 1000, 500, 23, 0):
        daq.command(ring_next=(ALL - 700 + 2500 - ago) % ALL, ring_want=24)
        samples = [counts for counts, *_ in daq.status().samples]
        assert samples == list(range(2500 - ago, 2501))[:24]


# --- counts ---


@pytest.mark.parametrize("start", [2**31 - 3, -(2**31) + 3, 2**15 - 3, -(2**15) + 3])
@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("language", ["Python", "C"])
def test_counts_go_on_where_the_counter_of_the_hardware_wraps(begun, language, start, way):
    daq = begun(language, "encoder_daq")

    def raw(moved):
        return (start + moved + HALF) % ALL - HALF

    daq.now(raw(0))
    assert daq.command(order=1) == 0
    for moved in range(0, 11 * way, way):
        daq.tick(raw(moved), 0, 0)
        assert daq.status()["counts"] == moved
    daq.command(ring_next=1, ring_want=24)
    assert [counts for counts, *_ in daq.status().samples] == list(range(0, 11 * way, way))


@pytest.mark.parametrize("language", ["Python", "C"])
def test_index_pulses_are_counted_modulo_a_word(begun, language):
    daq = begun(language, "encoder_daq")
    for _ in range(WORD + 3):
        daq.tick(0, 0, 1)
    assert daq.status()["index_count"] == 3
