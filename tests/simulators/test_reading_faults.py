"""Faults of wire, shunt, encoder, clock and power, as seen in the registers."""

import pytest
from benches import Bench

from simulators import faults


def counts(bench: Bench, last_tick: int) -> list[int]:
    """What the DAQ has counted, tick by tick; the amplifier is kept fed."""
    found = []
    for tick in range(1, last_tick + 1):
        bench.command(10 + tick, current=bench.amplifier.output_uA)
        found += [s[0] for s in bench.samples(tick, tick, 1)]
    return found


def test_an_encoder_that_sticks_is_true_again_afterwards():
    bench = Bench([faults.StuckEncoder(kind="stuck_encoder", from_s=0.2, to_s=0.5)])
    assert counts(bench, 7) == [10, 20, 30, 30, 30, 60, 70]


def test_an_encoder_that_slips_loses_its_share_for_good():
    bench = Bench([faults.SlippingEncoder(kind="slipping_encoder", share=0.5, from_s=0.2, to_s=0.4)])
    assert counts(bench, 6) == [10, 20, 25, 30, 40, 50]


def test_an_encoder_jumps_once():
    bench = Bench([faults.JumpingEncoder(kind="jumping_encoder", counts=-500, from_s=0.3)])
    assert counts(bench, 5) == [10, 20, 30, -460, -450]


def test_an_open_wire_trips():
    bench = Bench([faults.OpenWire(kind="open_wire", from_s=0.2)])
    bench.armed(300_000)
    counts(bench, 4)
    assert (bench.amplifier.state, bench.world.flowed_uA) == ("armed", 0)
    counts_after = bench.samples(100, 5, 1)
    assert counts_after
    assert bench.amplifier.trip == "open"


def test_a_shunt_that_drifts_is_an_over_current_in_the_end():
    bench = Bench([faults.DriftingShunt(kind="drifting_shunt", gain_per_s=0.5)])
    bench.armed(1_000_000)
    counts(bench, 2)
    assert bench.amplifier.state == "armed"
    counts_after = bench.samples(100, 3, 1)
    assert counts_after
    assert bench.amplifier.trip == "over_current"


@pytest.mark.parametrize(("ppm", "ticks"), [(100_000, 110), (-100_000, 90), (0, 100)])
def test_a_clock_that_drifts(ppm, ticks):
    bench = Bench([faults.ClockDrift(kind="clock_drift", device="amplifier", ppm=ppm)])
    for _ in range(100):
        bench.world.tick()
    assert (bench.amplifier.newest_tick, bench.daq.newest_tick) == (ticks, 100)


def test_a_reboot_is_once_and_shows_in_the_boot_count():
    bench = Bench([faults.Reboot(kind="reboot", device="amplifier", from_exchange=4)])
    bench.armed(300_000)
    for _ in range(3):
        bench.world.tick()
    assert bench.amplifier.newest_tick == 3
    for _ in range(3):
        bench.command(2)
    assert (bench.amplifier.boot_count, bench.amplifier.newest_tick, bench.amplifier.state) == (2, 0, "off")


def test_a_brown_out_drives_nothing_and_answers_nothing_until_it_is_over():
    bench = Bench([faults.BrownOut(kind="brown_out", device="amplifier", from_s=0.2, to_s=0.4)])
    bench.armed(300_000)
    flowed, answered = [], []
    for k in range(6):
        bench.world.tick()
        flowed.append(bench.world.flowed_uA)
        answered.append(bench.command(20 + k, current=300_000) is not None)
    assert flowed == [300_000, 300_000, 0, 0, 0, 0]
    assert answered == [True, False, False, True, True, True]
    assert (bench.amplifier.boot_count, bench.amplifier.newest_tick) == (2, 2)


def test_a_rebooted_daq_keeps_the_position_of_the_encoder():
    bench = Bench([faults.Reboot(kind="reboot", device="encoder_daq", from_s=0.3)])
    for _ in range(3):
        bench.world.tick()
    bench.samples(1, 1, 0)
    assert bench.daq.status()["counts"] == 30


def test_the_index_is_seen_once_a_turn():
    bench = Bench()
    for _ in range(450):
        bench.world.tick()
    assert bench.daq.status()["index_count"] == 2
