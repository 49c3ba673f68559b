"""Where the heating model starts: never colder than the wire can be, and cold where the wire is."""

import math
import sqlite3
from contextlib import closing
from dataclasses import replace

import pytest

import smarig
from runner.interrupted import cut
from smarig.core.sample import Quality
from smarig.plant.actuator import Actuator
from smarig.plant.heating import JouleHeating
from smarig.record import LastHeat, load_run
from smarig.runner.wire_heat import COLD_TAUS, UNRECORDED_S, elapsed_s, heat_left, recorded_heat

ONE, TWO = Actuator.named("gorbet_one_wire"), Actuator.named("gorbet_two_wire")
PERIOD_S = 0.1


def ticked(actuator, wire_K, *currents_and_seconds):
    """The temperatures after currents, tick by tick."""
    heating = JouleHeating(actuator, PERIOD_S)
    heating.wire_K = list(wire_K)
    for current_A, seconds in currents_and_seconds:
        for _ in range(round(seconds / PERIOD_S)):
            heating.step(current_A)
    return pytest.approx(tuple(heating.wire_K), abs=1e-9)


# --- what is left of the heat --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("elapsed", "course"),
    [
        (0.0, ()),
        (1.5, [(0.9, 1.5)]),
        (3.0, [(0.9, 3.0)]),
        (13.0, [(0.9, 3.0), (0.0, 10.0)]),
    ],
)
def test_the_last_current_flows_until_the_lease_ends_it_and_then_the_wire_cools(elapsed, course):
    last = LastHeat((100.0, 0.0), current_A=0.9, flows_s=3.0)
    assert heat_left(last, ONE, elapsed, has_lease=True) == ticked(ONE, (100.0, 0.0), *course)


def test_the_second_wire_is_heated_by_a_negative_current_while_the_first_cools():
    last = LastHeat((80.0, 20.0), current_A=-1.0, flows_s=2.0)
    expected = ticked(TWO, (80.0, 20.0), (-1.0, 2.0), (0.0, 4.0))
    assert heat_left(last, TWO, 6.0, has_lease=True) == expected


@pytest.mark.parametrize(("current_A", "expected_K"), [(0.0, 120.0), (0.3, 120.0), (1.0, None)])
def test_without_a_clock_nothing_has_cooled(current_A, expected_K):
    last = LastHeat((120.0, 0.0), current_A=current_A, flows_s=3.0)
    hottest = ticked(ONE, (120.0, 0.0), (current_A, 3.0)).expected[0] if expected_K is None else expected_K
    assert heat_left(last, ONE, None, has_lease=True)[0] == pytest.approx(hottest)


def test_without_a_lease_the_current_may_have_flowed_all_the_time():
    last = LastHeat((20.0, 0.0), current_A=1.0, flows_s=3.0)
    steady_K = ONE.input_for(1.0)
    for elapsed in (3600.0, None):
        assert heat_left(last, ONE, elapsed, has_lease=False)[0] == pytest.approx(steady_K)
    assert heat_left(replace(last, wire_K=(180.0, 0.0)), ONE, None, has_lease=False)[0] == 180.0


@pytest.mark.parametrize("elapsed", [7.0, None])
def test_a_current_of_unknown_duration_may_still_have_flowed(elapsed):
    last = LastHeat((20.0, 0.0), current_A=1.0, flows_s=math.inf)
    expected = ONE.input_for(1.0) if elapsed is None else ticked(ONE, (20.0, 0.0), (1.0, elapsed)).expected[0]
    assert heat_left(last, ONE, elapsed, has_lease=True)[0] == pytest.approx(expected)


def test_a_wire_that_has_cooled_for_long_is_cold():
    last = LastHeat((170.0, 0.0), current_A=1.0, flows_s=3.0)
    long_s = 3.0 + COLD_TAUS * ONE.tau_s
    assert heat_left(last, ONE, long_s + 0.1, has_lease=True) == (0.0, 0.0)
    assert heat_left(last, ONE, long_s - 0.1, has_lease=True)[0] > 0.0
    assert heat_left(last, ONE, math.inf, has_lease=False) == (0.0, 0.0)


# --- the time that has passed --------------------------------------------------------------------------------------

SEEN = LastHeat((100.0, 0.0), device="encoder, boot 3", tick=5000, epoch=1000.0)


@pytest.mark.parametrize(
    ("last", "device", "tick", "now", "expected"),
    [
        (SEEN, "encoder, boot 3", 5600, 9e8, 60.0),  # the device's clock comes first
        (SEEN, "encoder, boot 3", 4000, 1030.0, 30.0),  # its ticks went back: the host's clock
        (SEEN, "encoder, boot 4", 5600, 1030.0, 30.0),
        (SEEN, "encoder, boot 4", 5600, 970.0, None),  # the host's clock was set back,
        (SEEN, "encoder, boot 4", 5600, 9e8, None),  # or it was that of 1970
        (replace(SEEN, epoch=None), "encoder, boot 4", 5600, 1030.0, None),
        (replace(SEEN, device=""), "", 5600, 1030.0, 30.0),
    ],
)
def test_the_time_is_that_of_the_device_or_else_of_a_plausible_clock(last, device, tick, now, expected):
    assert elapsed_s(last, device, tick, PERIOD_S, twin=False, now=now) == pytest.approx(expected)


def test_simulated_devices_have_a_time_and_a_wire_of_their_own():
    assert elapsed_s(SEEN, "encoder, boot 3", 5600, PERIOD_S, twin=True) == pytest.approx(60.0)
    assert elapsed_s(SEEN, "encoder, boot 4", 5600, PERIOD_S, twin=True) == math.inf
    assert elapsed_s(replace(SEEN, device=""), "encoder, boot 4", 0, PERIOD_S, twin=True) is None


# --- what a record tells -------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    return {
        rig: smarig.run(
            "step_currents", rig=rig, out=folder / f"{rig}.run.sqlite", temperatures_K=temperatures
        )
        for rig, temperatures in (("one_wire_twin", "150,60"), ("two_wire_twin", "120,-90,60"))
    }


def at_hottest(run):
    """A tick in the middle of a run at which it is hottest."""
    return int(run["tick"][abs(run["input"]).argmax()])


def killed(run, folder, tick):
    return cut(run.path, folder / "r.run.sqlite", tick)


@pytest.mark.long("takes a second")
def test_one_wire_is_as_hot_as_its_last_input(whole, tmp_path):
    run = load_run(killed(whole["one_wire_twin"], tmp_path, at_hottest(whole["one_wire_twin"])))
    heat = recorded_heat(run, ONE, 1.0)
    assert heat.wire_K == (run["input"][-1], 0.0)
    assert heat.wire_K[0] > 140.0
    assert heat.current_A == max(run["current_command_A"][-1], run["current_A"][-1])
    assert heat.flows_s == math.inf, "simulated devices may have run ahead of the record"
    change(run.path, "UPDATE run SET value = '\"bench\"' WHERE key = 'source'")
    assert recorded_heat(load_run(run.path), ONE, 1.0).flows_s == 1.0 + UNRECORDED_S
    assert heat.tick == run["tick"][-1]


@pytest.mark.parametrize("seconds_into_the_second_step", [1.0, 8.0])
def test_both_wires_follow_from_the_recorded_currents(whole, tmp_path, seconds_into_the_second_step):
    """The first still cools while the second is heated; the input is only their difference."""
    run = whole["two_wire_twin"]
    turn = next(s for s in run.steps if s.target == -90.0)
    tick = round((turn.t_start_s + seconds_into_the_second_step) / PERIOD_S)
    heat = recorded_heat(load_run(killed(run, tmp_path, tick)), TWO, 1.0)
    heating = JouleHeating(TWO, PERIOD_S)
    for k in range(tick):
        heating.step(float(run["current_A"][k]))
    assert heat.wire_K == pytest.approx(tuple(heating.wire_K), abs=1e-9)
    assert min(heat.wire_K) > 5.0


def change(path, sql, *values):
    with closing(sqlite3.connect(path)) as db, db:
        assert db.execute(sql, values).rowcount > 0


def test_a_current_that_was_not_measured_is_the_larger_of_what_is_known(whole, tmp_path):
    run = whole["two_wire_twin"]
    turn = next(s for s in run.steps if s.target == -90.0)
    path = killed(run, tmp_path, round(turn.t_start_s / PERIOD_S) + 10)
    before = recorded_heat(load_run(path), TWO, 1.0).wire_K
    assert min(before) > 5.0
    change(path, "UPDATE sample SET current_A = 0, quality = ?", int(Quality.STALE))
    assert recorded_heat(load_run(path), TWO, 1.0).wire_K == pytest.approx(before, rel=0.01)


def test_wires_that_began_hot_are_known_from_the_event(whole, tmp_path):
    path = killed(whole["two_wire_twin"], tmp_path, 20)
    cold = recorded_heat(load_run(path), TWO, 1.0).wire_K
    change(path, "UPDATE event SET data = '{\"wire_K\": [50.0, 50.0]}' WHERE kind = 'start'")
    warm = recorded_heat(load_run(path), TWO, 1.0).wire_K
    kept = 50.0 * math.exp(-20 * PERIOD_S / TWO.tau_s)
    assert warm == pytest.approx((cold[0] + kept, cold[1] + kept), abs=1e-6)


def test_what_the_record_says_of_the_difference_is_never_undercut(whole, tmp_path):
    path = killed(whole["two_wire_twin"], tmp_path, at_hottest(whole["two_wire_twin"]))
    first, second = recorded_heat(load_run(path), TWO, 1.0).wire_K
    for difference_K in (first - second + 7.0, first - second - 7.0):
        change(path, "UPDATE sample SET input = ? WHERE tick = (SELECT max(tick) FROM sample)", difference_K)
        found = recorded_heat(load_run(path), TWO, 1.0).wire_K
        assert found[0] - found[1] == pytest.approx(difference_K)
        assert found[0] >= first - 1e-9
        assert found[1] >= second - 1e-9


def test_a_run_that_was_closed_and_a_clock_that_jumped(whole, tmp_path):
    path = killed(whole["one_wire_twin"], tmp_path, 500)
    assert recorded_heat(load_run(path), ONE, 1.0).epoch == pytest.approx(
        load_run(path).events[0].data["epoch"] + 50.0
    )
    change(path, "INSERT INTO event VALUES (40.0, 'warning', 'clock', 'The clock jumped.', '{}')")
    change(path, "INSERT INTO run VALUES ('end', '{\"cause\": \"enough\"}')")
    heat = recorded_heat(load_run(path), ONE, 0.5)
    assert heat.epoch is None
    assert heat.flows_s == 1.0, "the lease of the record, which is longer"


def test_a_run_without_samples_tells_nothing(whole, tmp_path):
    path = killed(whole["one_wire_twin"], tmp_path, 500)
    change(path, "DELETE FROM sample")
    assert recorded_heat(load_run(path), ONE, 1.0) is None
