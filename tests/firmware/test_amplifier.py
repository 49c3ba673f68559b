"""The amplifier in C, rule by rule: orders, currents, refusals, repeats and its ring."""

import pytest

from firmware.codes import (
    ARM,
    ARMED,
    BAD_WORD,
    IS_OFF,
    NO_REGISTER,
    NONE,
    NOT_NOW,
    OFF,
    REARM,
    STOP_IS_OPEN,
    TRIPPED,
)
from firmware.firmware_build import Device
from smarig.device.encoding.crc import crc16

SAFE_CRC = crc16(
    bytes.fromhex("0064 01F4 0000 0000 0000 0000 0000 03E8 0000 0000 000F 4240 0000 0001 03E8")
)  # of the safe settings, word for word


def in_state(amp, state):
    if state != IS_OFF:
        assert amp.command(order=ARM) == 0
    if state == TRIPPED:
        amp.tick(0, 0, 0, STOP_IS_OPEN)
    assert amp.status()["state"] == state


def test_it_boots_off_with_safe_settings(library):
    amp = Device(library, "amplifier", boot_count=0xFFFF1234)
    status = amp.status()
    known = {"kind": 0x5341, "version": 5, "map_hash": amp.map.hash, "boot_count": 0xFFFF1234}
    known |= {"board_max": 2_000_000, "settings_crc": SAFE_CRC, "arm_nonce": 0x12340000}
    assert {name: value for name, value in status.items() if value} == known
    registers = (r for block in ("command", "settings") for r in amp.map.blocks[block])
    safe = {r.name: r.safe % 2 ** (16 * r.words) for r in registers}
    safe["epoch"] = 0xFFFF1234
    assert {name: amp.read(name) for name in safe} == safe


@pytest.mark.parametrize(
    ("state", "order", "code", "after"),
    [
        (IS_OFF, ARM, 0, ARMED),
        (IS_OFF, REARM, 0, ARMED),
        (IS_OFF, OFF, 0, IS_OFF),
        (IS_OFF, NONE, 0, IS_OFF),
        (ARMED, ARM, NOT_NOW, ARMED),
        (ARMED, REARM, NOT_NOW, ARMED),
        (ARMED, OFF, 0, IS_OFF),
        (ARMED, NONE, 0, ARMED),
        (TRIPPED, ARM, NOT_NOW, TRIPPED),
        (TRIPPED, REARM, 0, ARMED),
        (TRIPPED, OFF, 0, IS_OFF),
        (TRIPPED, NONE, 0, TRIPPED),
    ],
)
def test_orders(amp, state, order, code, after):
    in_state(amp, state)
    assert amp.command(order=order) == code
    status = amp.status()
    assert status["state"] == after
    assert bool(status["trip"]) == (after == TRIPPED)
    assert status["output"] == amp.output_uA == 0
    assert amp.read("order") == 0


@pytest.mark.parametrize(
    ("state", "order", "current", "code"),
    [
        (IS_OFF, NONE, 1, NOT_NOW),
        (TRIPPED, NONE, 1, NOT_NOW),
        (TRIPPED, OFF, 1, NOT_NOW),
        (IS_OFF, NONE, 2_000_001, NOT_NOW),
        (IS_OFF, NONE, 0, 0),
        (TRIPPED, NONE, 0, 0),
        (IS_OFF, ARM, 2_000_000, 0),
        (TRIPPED, REARM, -2_000_000, 0),
        (ARMED, NONE, 2_000_001, BAD_WORD),
        (ARMED, NONE, -2_000_001, BAD_WORD),
        (ARMED, NONE, 5_000_001, BAD_WORD),
        (IS_OFF, NONE, -5_000_001, BAD_WORD),
    ],
)
def test_currents(amp, state, order, current, code):
    in_state(amp, state)
    assert amp.command(order=order, current=current) == code
    assert amp.output_uA == amp.status()["output"] == (0 if code else current)


def test_off_means_zero_whatever_the_current_register_holds(amp):
    amp.command(order=ARM, current=500_000)
    assert amp.command(order=OFF, current=500_000) == 0
    assert (amp.output_uA, amp.read("current")) == (0, 500_000)
    assert amp.command(order=ARM) == 0
    assert amp.output_uA == 0  # the current of before does not come back


def test_a_short_write_leaves_the_current_as_it_is(amp):
    amp.command(order=ARM, current=500_000)
    assert amp.command() == 0
    assert amp.output_uA == 500_000


@pytest.mark.parametrize(
    ("body", "code"),
    [
        ("w 100 0 0", BAD_WORD),  # sequence is never 0
        ("w 100 63", NO_REGISTER),  # half a sequence
        ("w 100 0 63 0", NO_REGISTER),  # half an epoch
        ("w 100 0 63 0 7 4", BAD_WORD),
        ("w 100 0 63 0 7 1 0 1 0 0 d", BAD_WORD),
        ("w 100 0 63 0 7 2 1 r 0 1", NO_REGISTER),  # half a current
        ("w 100 0 63 0 7 1 0 1 0 0 0 0", NO_REGISTER),  # half a nonce
        ("w 100 0 63 0 7 1 0 1 0 0 0 0 0 0", NO_REGISTER),  # beyond the block
        ("w 101 1", NO_REGISTER),  # not from its first register on
        ("w 105 0 0", NO_REGISTER),
        ("w 0 1", NO_REGISTER),  # not writable
        ("w ffff 1 1", NO_REGISTER),
        ("w 100 0 63 0 7 r 79 1", NO_REGISTER),
        ("w 100 0 63 0 7 r 0 7a", NO_REGISTER),
        ("w 100 0 63 0 7 r 4 1", NO_REGISTER),  # half a value, from the middle on
        ("w 100 0 63 0 7 r 0 4", NO_REGISTER),  # and up to the middle
        ("w 100 0 63 0 7 r 5 1", NO_REGISTER),  # of the boot count
        ("w 100 0 63 0 7 r 8 1", NO_REGISTER),  # of the echo
        ("w 100 0 63 0 7 r 15 1", NO_REGISTER),  # of the nonce
        ("w 100 0 63 0 7 r 18 1", NO_REGISTER),  # of board_max
        ("w 100 0 63 0 7 r 19 1", NO_REGISTER),  # of a sample, too
        ("w 100 0 63 0 7 r 0 1e", NO_REGISTER),  # up to the middle of its output
        ("w 100 0 63 0 7 r 205 1", NO_REGISTER),
        ("w 100 0 63 0 7 r ffff 2", NO_REGISTER),
        ("w 100 0 63 0 7 r 0 0", BAD_WORD),
        ("w 100 0 63 0 7 r 0 7e", BAD_WORD),
        ("w 100 0 63 0 7 1 0 1 r 200 1", NOT_NOW),  # a current, and nothing that arms: see below
        ("w 200 0", BAD_WORD),
        ("w 200 64 1f3", BAD_WORD),
        ("w 200 64 7d1", BAD_WORD),
        ("w 200 64 1f4 0 1", BAD_WORD),  # current_min is not positive
        ("w 200 64 1f4 0 0 ffff ffff", BAD_WORD),  # nor current_max negative
        ("w 200 64 1f4 0", NO_REGISTER),
        ("w 201 1f4", NO_REGISTER),
    ],
)
def test_a_refused_request_changes_nothing(amp, body, code):
    if code == NOT_NOW:
        body = body.replace("7 1 ", "7 0 ")
    before = amp.memory
    assert amp.ask(body).code == code
    assert amp.memory == before


@pytest.mark.parametrize(
    "body",
    [
        "r 0 14",
        "r 3 2",
        "r 5 4",
        "r 15 2",
        "r 19 2",
        "r 1b 4",
        "r 21 8",
        "r 102 2",
        "r 105 2",
        "r 10a 2",
        "r 200 f",
        "r 78 1",
    ],
)
def test_whole_values_can_be_read_from_anywhere(amp, body):
    reply = amp.ask(body)
    assert (reply.code, len(reply.words)) == (0, int(body.split()[-1], 16))


def test_settings_only_while_not_armed(amp):
    for state, code in ((IS_OFF, 0), (ARMED, NOT_NOW), (TRIPPED, 0)):
        amp.command(order=OFF)
        in_state(amp, state)
        assert amp.settings(lease=700) == code
        assert amp.settings(lease=2001) == BAD_WORD  # a bad word is one at any time


def test_a_part_of_the_settings_leaves_the_rest(amp):
    assert amp.ask("w 200 c8 258").code == 0
    assert (amp.read("period"), amp.read("lease"), amp.read("current_max")) == (200, 600, 2_000_000)


def test_a_repeated_exchange_is_answered_and_not_done_again(amp):
    amp.command(sequence=9, order=ARM, current=1000)
    assert amp.command(sequence=9, order=OFF, current=2000) == 0
    status = amp.status()
    assert (status["echo"], status["state"], status["output"], amp.read("current")) == (9, ARMED, 1000, 1000)
    assert amp.command(sequence=9, order=4) == BAD_WORD  # but it must be one that can be read
    assert amp.command(sequence=10, order=OFF) == 0
    assert amp.status()["state"] == IS_OFF


def test_a_repeated_exchange_is_answered_after_a_trip(amp):
    amp.command(sequence=9, order=ARM, current=1000)
    amp.tick(1000, 0, 0, STOP_IS_OPEN)
    assert amp.command(sequence=9, order=ARM, current=1000) == 0
    assert amp.status()["state"] == TRIPPED


def test_a_repeated_exchange_chooses_its_window(amp):
    amp.tick(1, 2, 3, 0, times=4)
    amp.command(sequence=9, ring_next=1, ring_want=1)
    assert amp.command(sequence=9, ring_next=2, ring_want=12) == 0
    status = amp.status()
    assert (status["ring_first"], status["ring_count"]) == (2, 3)


@pytest.mark.parametrize(
    ("ticks", "ring_next", "ring_want", "first", "count"),
    [
        (0, 0, 12, 0, 0),
        (0, 1, 12, 1, 0),
        (5, 0, 12, 1, 5),
        (5, 3, 12, 3, 3),
        (5, 3, 2, 3, 2),
        (5, 3, 0, 3, 0),
        (5, 5, 12, 5, 1),
        (5, 6, 12, 6, 0),
        (5, 2**31 + 5, 12, 2**31 + 5, 0),
        (5, 2**31 + 6, 12, 1, 5),
        (256, 1, 12, 1, 12),
        (257, 1, 12, 2, 12),
        (300, 0, 12, 45, 12),
        (300, 290, 12, 290, 11),
    ],
)
def test_the_ring_window_is_the_one_requested(amp, ticks, ring_next, ring_want, first, count):
    for tick in range(1, ticks + 1):
        amp.tick(-tick, 2 * tick, tick % 100, 0)
    amp.command(ring_next=ring_next, ring_want=ring_want)
    status = amp.status()
    assert (status["tick"], status["ring_first"], status["ring_count"]) == (ticks, first, count)
    assert status.samples == [(-t, 2 * t, 0, t % 100, 0) for t in range(first, first + count)]


def test_the_window_stays_until_the_next_command(amp):
    amp.tick(1, 2, -32768, 0, times=3)
    amp.command(ring_next=1, ring_want=12)
    amp.command(ring_next=2, ring_want=12)  # nothing is left over from the one before
    before = amp.status()
    amp.tick(7, 8, 9, 0, times=600)  # twice round
    after = amp.status()
    assert after.samples == before.samples == [(1, 2, 0, -32768, 0)] * 2
    assert after["tick"] == 603
    assert amp.ask("r 29 50").words == [0] * 80  # beyond the window


def test_marks(amp):
    amp.command(order=ARM)
    for hardware in (0, 1, STOP_IS_OPEN, 0, 1):
        amp.tick(0, 0, 0, hardware)
    amp.command(ring_next=1, ring_want=12)
    assert [marks for *_, marks in amp.status().samples] == [0, 1, 2, 2, 3]
