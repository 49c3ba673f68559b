"""What makes an amplifier and its host sure of each other, in C and in Python: the nonce of arming, the output of every
tick, the CRC of the settings, the board's largest current."""

import pytest

from firmware.codes import (
    ARM,
    ARMED,
    BAD_WORD,
    IS_OFF,
    NONE,
    NOT_NOW,
    OFF,
    REARM,
    SLEW,
    STOP,
    STOP_IS_OPEN,
    TRIPPED,
)
from firmware.firmware_build import RTU, Device, frame, make, open_library
from firmware.python_device import PythonDevice
from smarig.device.encoding.crc import crc16
from smarig.device.encoding.register import to_words

BOOT = 7
WIDE = {"current_min": -2_000_000, "current_max": 2_000_000, "slew_max": 1_000_000, "heat_max": 2**32 - 1}


@pytest.fixture(params=["C", "Python"])
def amp(request):
    """An amplifier with room to move, in either language."""
    library = request.getfixturevalue("library") if request.param == "C" else None
    device = Device(library, "amplifier", BOOT) if library else PythonDevice(BOOT)
    assert device.settings(**WIDE) == 0
    return device


def nonce(orders, boot=BOOT):
    return boot << 16 | orders


# --- the nonce ---


def test_every_order_and_every_boot_has_its_nonce(amp):
    assert amp.read("arm_nonce") == nonce(0)
    for orders, order in enumerate((ARM, OFF, OFF, REARM, OFF, ARM), 1):
        assert amp.command(order=order) == 0
        assert amp.read("arm_nonce") == nonce(orders)
        assert amp.read("nonce") == 0
    amp.boot(BOOT + 1)
    assert amp.read("arm_nonce") == nonce(0, BOOT + 1)


@pytest.mark.long("takes five seconds", cases=("Python",))
def test_the_orders_are_counted_modulo_a_word(amp):
    for orders in range(1, 65_537):
        assert amp.answer(rtu_write(orders, OFF), RTU)
        if orders in (65_535, 65_536):
            assert amp.read("arm_nonce") == nonce(orders % 65_536)


def test_nothing_but_an_executed_order_changes_the_nonce(amp):
    amp.command(sequence=1, order=ARM)
    before = amp.read("arm_nonce")
    assert amp.command(sequence=2, current=500_000) == 0
    assert amp.command(sequence=2, order=OFF) == 0  # a repetition
    assert amp.command(sequence=1, order=OFF) == 0  # late
    assert amp.command(sequence=3, order=ARM) == NOT_NOW
    assert amp.command(sequence=3, order=9) == BAD_WORD
    amp.tick(500_000, 2_500_000, 0, STOP_IS_OPEN)
    assert amp.status()["state"] == TRIPPED
    assert amp.settings(**WIDE) == 0
    assert amp.read("arm_nonce") == before == nonce(1)


@pytest.mark.parametrize("order", [ARM, REARM])
@pytest.mark.parametrize(
    "wrong",
    [0, 1, nonce(0) - 1, nonce(2), nonce(3), nonce(1, BOOT + 1), nonce(1, 0), 1 << 16 | BOOT, 2**32 - 1],
)
def test_arming_with_another_nonce_is_refused(amp, order, wrong):
    amp.command(order=OFF)  # its nonce is nonce(1)
    before = amp.status()
    assert amp.command(sequence=50, order=order, current=100_000, nonce=wrong) == NOT_NOW
    assert amp.status() == before
    assert amp.command(sequence=50, order=order, current=100_000, nonce=nonce(1)) == 0
    assert (amp.status()["state"], amp.output_uA) == (ARMED, 100_000)


@pytest.mark.parametrize("words", ["0 1 0 7 1", "0 1 0 7 1 0 0", "0 1 0 7 1 0 0 0 0 0", "0 1 0 7 3 0 0"])
def test_a_write_without_the_word_arms_nothing(amp, words):
    assert amp.ask(f"w 100 {words}").code == NOT_NOW
    assert (amp.status()["state"], amp.status()["echo"]) == (IS_OFF, 0)


def test_the_nonce_of_the_last_arming_does_not_rearm_after_a_trip(amp):
    assert amp.command(order=ARM, current=100_000, nonce=nonce(0)) == 0
    amp.tick(100_000, 500_000, 0, STOP_IS_OPEN)
    assert amp.command(order=REARM, current=100_000, nonce=nonce(0)) == NOT_NOW
    assert (amp.status()["state"], amp.status()["trip"]) == (TRIPPED, STOP)
    assert amp.command(order=REARM, current=100_000, nonce=nonce(1)) == 0


def test_off_and_no_order_need_no_nonce(amp):
    amp.command(order=ARM)
    assert amp.command(order=NONE, current=100_000, nonce=12_345) == 0
    assert amp.command(order=OFF, nonce=12_345) == 0
    assert (amp.status()["state"], amp.read("nonce")) == (IS_OFF, 0)


def rtu_write(sequence, order=NONE, current=0, with_nonce=None):
    """A frame that writes the command block, or what it begins with, up to the order."""
    words = [*to_words(sequence, 2), *to_words(BOOT, 2), order]
    if with_nonce is not None:
        words += [*to_words(current, 2), 0, 0, 0, *to_words(with_nonce, 2)]
    body = b"".join(word.to_bytes(2, "big") for word in words)
    return frame(bytes([65, 16, 1, 0, 0, len(words), len(body)]) + body)


@pytest.mark.long("takes eight seconds; each wrap is crossed in test_wraps.py", cases=("Python",))
def test_an_old_arm_frame_arms_nothing_at_any_later_moment(amp):
    """Replayed after each of 65,535 further commands, with the last of which a word would be ahead again."""
    arming = rtu_write(300, ARM, 500_000, with_nonce=nonce(0))
    for last in (255, 299):
        amp.command(sequence=last)
    assert not amp.answer(arming, RTU)[1] & 0x80
    assert amp.output_uA == 500_000
    amp.command(sequence=301, order=OFF)
    refused = 0
    for further in range(65_535):
        refused += amp.answer(arming, RTU)[1] >> 7
        assert amp.output_uA == 0
        amp.answer(rtu_write(302 + further), RTU)
    assert refused == 0, "it is always a repetition"
    assert amp.status()["state"] == IS_OFF
    assert amp.status()["echo"] == 301 + 65_535


def test_a_repetition_takes_only_its_window(amp):
    amp.tick(0, 0, 0, 0, times=4)
    amp.command(sequence=9, order=ARM, current=1000)
    values = {"order": OFF, "current": 2000, "ring_next": 2, "ring_want": 12, "nonce": nonce(1)}
    assert amp.command(sequence=9, **values) == 0
    status = amp.status()
    assert (status["state"], status["output"], amp.read("current"), amp.read("nonce")) == (
        ARMED,
        1000,
        1000,
        0,
    )
    assert (status["ring_first"], status["ring_count"], amp.read("ring_next")) == (2, 3, 2)


# --- the output of every tick ---


def outputs(amp, count):
    amp.command(ring_next=1, ring_want=12)
    return [(output, marks) for *_, output, _, marks in amp.status().samples][:count]


def test_the_ring_says_what_was_ordered_to_flow_in_each_tick(amp):
    amp.tick(7, 0, 0, 0)
    amp.command(order=ARM, current=100_000)
    amp.tick(99_000, 0, 0, 0, times=2)
    amp.command(current=-300_000)
    amp.tick(-301_000, 0, 0, STOP_IS_OPEN)  # ends with the trip
    amp.tick(-20_000, 0, 0, 0)
    amp.command(order=REARM, current=50_000)
    amp.tick(50_000, 0, 0, 0)
    amp.command(order=OFF)
    amp.tick(10, 0, 0, 0)
    expected = [(0, 0), (100_000, 0), (100_000, 0), (-300_000, 2), (0, 2), (50_000, 0), (0, 0)]
    assert outputs(amp, 7) == expected
    assert [current for current, *_ in amp.status().samples][:5] == [7, 99_000, 99_000, -301_000, -20_000]


def test_after_a_trip_by_slew_the_next_tick_has_no_output(amp):
    amp.settings(**(WIDE | {"slew_max": 1000}))
    amp.command(order=ARM, current=50_000)
    amp.tick(50_000, 0, 0, 0)
    amp.command(current=400_000)
    assert amp.status()["trip"] == SLEW
    amp.tick(20_000, 0, 0, 0)
    assert outputs(amp, 2) == [(50_000, 0), (0, 2)]


def test_the_lease_ends_the_output_after_its_tick(amp):
    amp.command(order=ARM, current=60_000)
    amp.tick(60_000, 10**6, 0, 0, times=8)
    assert outputs(amp, 8) == [(60_000, 0)] * 5 + [(60_000, 2), (0, 2), (0, 2)]


# --- settings ---


def crc_of(amp):
    """Of the settings as they are read."""
    words = amp.ask("r 200 f").words
    return crc16(b"".join(word.to_bytes(2, "big") for word in words))


def test_the_crc_follows_every_accepted_write_and_no_refused_one(amp):
    seen = {amp.read("settings_crc")}
    for body in ("w 200 c8", "w 200 c8 1f5", "w 200 c8 1f5 ffff fff0", "w 200 64 1f4 0 0 f 4240 0 2710 0 1"):
        assert amp.ask(body).code == 0
        assert amp.read("settings_crc") == crc_of(amp)
        seen.add(amp.read("settings_crc"))
    assert len(seen) == 5
    before = amp.read("settings_crc")
    for body in ("w 200 0", "w 200 64 1f4 0 1", "w 200 64 1f3", "w 200 fb", "w 200 64 1f4 0", "w 201 1f4"):
        assert amp.ask(body).code
    assert amp.settings(**(WIDE | {"current_max": 2_000_001})) == BAD_WORD
    amp.command(order=ARM)
    assert amp.settings(**WIDE) == NOT_NOW
    assert amp.read("settings_crc") == crc_of(amp) == before


@pytest.mark.parametrize(
    ("settings", "code"),
    [
        ({"current_max": 2_000_000}, 0),
        ({"current_max": 2_000_001}, BAD_WORD),
        ({"current_max": 5_000_000}, BAD_WORD),
        ({"current_min": -2_000_000}, 0),
        ({"current_min": -2_000_001}, BAD_WORD),
        ({"period": 250, "lease": 500}, 0),
        ({"period": 251, "lease": 501}, BAD_WORD),
        ({"period": 251, "lease": 502}, 0),
        ({"period": 1000, "lease": 2000}, 0),
        ({"period": 1001, "lease": 2000}, BAD_WORD),
        ({"period": 33_000, "lease": 2000}, BAD_WORD),  # twice that is 464, in a word
        ({"period": 60_000, "lease": 2000}, BAD_WORD),
    ],
)
def test_settings_fit_the_board_and_the_lease(amp, settings, code):
    before = amp.ask("r 200 f").words
    assert amp.settings(**settings) == code
    assert (amp.ask("r 200 f").words == before) == bool(code)


def test_what_counts_are_the_settings_after_the_write(amp):
    assert amp.ask("w 200 fa").code == 0
    assert amp.ask("w 200 fb").code == BAD_WORD  # the lease that stands is 500 ms
    assert amp.ask("w 200 fb 3e8").code == 0
    assert amp.ask("w 200 fb 1f4").code == BAD_WORD
    assert amp.ask("w 200 1f4 3e8").code == 0


def test_while_armed_settings_are_not_now_whatever_they_are(amp):
    amp.command(order=ARM)
    assert amp.settings(**(WIDE | {"current_max": 2_000_001})) == NOT_NOW
    assert amp.settings(period=1000) == NOT_NOW
    assert amp.settings(current_max=5_000_001) == BAD_WORD


@pytest.mark.parametrize("most_uA", [500_000, 3_000_000])
def test_the_board_is_set_when_it_is_built(tmp_path, most_uA):
    built = make(tmp_path, "libsmarig_firmware.so", ("gcc",), f"BOARD_MAX_uA={most_uA}")
    amp = Device(open_library(built), "amplifier")
    assert amp.read("board_max") == most_uA
    for limits in ({"current_max": most_uA}, {"current_min": -most_uA}):
        assert amp.settings(**limits) == 0
    for limits in ({"current_max": most_uA + 1}, {"current_min": -most_uA - 1}):
        assert amp.settings(**limits) == BAD_WORD
