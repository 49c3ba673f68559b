"""The encoder DAQ in C: counts, zero, index, faults and its ring."""

import pytest

ZERO = 1
INDEX, ILLEGAL_STEP, NO_SUPPLY = 1, 2, 4


def test_it_boots(daq):
    known = {"kind": 0x5344, "version": 3, "map_hash": daq.map.hash, "boot_count": 7}
    assert {name: value for name, value in daq.status().items() if value} == known
    assert daq.read("period") == 100


def test_zero_is_now_for_counts_and_from_the_next_tick_on_for_samples(daq):
    daq.tick(100, 2150, 0)
    daq.now(130)
    assert daq.status()["counts"] == 130
    assert daq.command(order=ZERO, ring_next=1, ring_want=24) == 0
    status = daq.status()
    assert (status["counts"], daq.read("order")) == (0, 0)
    assert status.samples == [(100, 2150, 0)]
    daq.tick(120, -32768, 0)
    daq.command(ring_next=2, ring_want=24)
    assert daq.status().samples == [(-10, -32768, 0)]


def test_a_repeated_zero_is_not_done_again(daq):
    daq.now(50)
    daq.command(sequence=5, order=ZERO)
    daq.now(80)
    assert daq.command(sequence=5, order=ZERO) == 0
    assert (daq.status()["counts"], daq.status()["echo"]) == (30, 5)


def test_a_zero_of_another_boot_is_not_done(daq):
    daq.now(50)
    for sequence, epoch in ((1, 6), (1, 8), (1, 0), (2, 7 + 2**16)):
        assert daq.command(sequence=sequence, epoch=epoch, order=ZERO) == 0
        assert (daq.status()["counts"], daq.status()["echo"]) == (50, 0)
    assert daq.command(sequence=1, order=ZERO) == 0
    assert daq.status()["counts"] == 0


def test_counts_go_round(daq):
    daq.now(-(2**31))
    daq.command(order=ZERO)
    daq.tick(2**31 - 1, 0, 0)
    assert daq.status()["counts"] == -1


def test_marks_index_and_fault(daq):
    for hardware in (0, INDEX, ILLEGAL_STEP, NO_SUPPLY, INDEX | ILLEGAL_STEP | NO_SUPPLY):
        daq.tick(0, 0, hardware)
    daq.command(ring_next=1, ring_want=24)
    status = daq.status()
    assert [marks for *_, marks in status.samples] == [0, 1, 2, 0, 3]
    assert (status["index_count"], status["fault"]) == (2, 1)
    daq.tick(0, 0, 0)
    assert daq.status()["fault"] == 0  # what is wrong now
    daq.tick(0, 0, INDEX, times=65535)
    assert daq.status()["index_count"] == 1


@pytest.mark.parametrize(
    ("ticks", "ring_next", "first", "count"),
    [
        (0, 1, 1, 0),
        (1024, 1, 1, 24),
        (1025, 1, 2, 24),
        (2500, 0, 1477, 24),
        (2500, 2490, 2490, 11),
        (2500, 2501, 2501, 0),
    ],
)
def test_the_ring_loses_nothing_within_its_size(daq, ticks, ring_next, first, count):
    for tick in range(1, ticks + 1):
        daq.tick(3 * tick, tick, 0)
    daq.command(ring_next=ring_next, ring_want=24)
    status = daq.status()
    assert (status["tick"], status["ring_first"], status["ring_count"]) == (ticks, first, count)
    assert status.samples == [(3 * t, t, 0) for t in range(first, first + count)]


@pytest.mark.parametrize(
    ("body", "code"),
    [
        ("w 100 0 1 0 7 2", 3),
        ("w 100 0 0", 3),
        ("w 100 0 1 0 7 1 0 0 19", 3),
        ("w 100 0 1 0 7 1 0", 2),
        ("w 100 0 1 0 7 1 0 0 0 0", 2),
        ("w 200 0", 3),
        ("w 200 ea61", 3),
        ("w 200 1 1", 2),
        ("w 100 0 1 0 7 1 r 71 1", 2),
        ("w 100 0 1 0 7 1 r b 1", 2),
        ("w 100 0 1 0 7 1 r 12 1", 2),
    ],
)
def test_a_refused_request_changes_nothing(daq, body, code):
    daq.tick(5, 5, 0)
    before = daq.memory
    assert daq.ask(body).code == code
    assert daq.memory == before


def test_the_period_can_be_set_at_any_time(daq):
    assert daq.settings(period=60_000) == 0
    assert daq.read("period") == 60_000
