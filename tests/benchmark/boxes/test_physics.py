"""Effects of the boxes against closed forms, in direction and in size."""

import math
from functools import cache

import numpy as np
import pytest

from benchmark.boxes.small import HOLDS, WIRES, few_relays
from benchmarks.boxes.box_effects import EFFECTS
from benchmarks.boxes.box_plant import BoxPlant
from benchmarks.boxes.box_session import (
    AmbientFluctuation,
    nominal_input,
    simulate_on_grid,
    simulate_on_new_grid,
)
from benchmarks.boxes.heat import WireTemperatures
from benchmarks.boxes.hold_plan import PlannedHold
from benchmarks.boxes.output_effects import position, sensor_output
from benchmarks.boxes.relays import Relays

WIRE, STROKE = WIRES["one_wire"], few_relays("one_wire").stroke


@cache
def grid_of(rig="one_wire"):
    """Times of the staircase without effects, and its record."""
    plant = BoxPlant(WIRES[rig], few_relays(rig), {})
    return simulate_on_new_grid(plant, WIRES[rig], HOLDS[rig], lambda _: 0.0)


def made(name=None, rig="one_wire", **values):
    """Grid, record and position (n,) with an effect, at the times without."""
    hidden = {name: EFFECTS[name].values(values)} if name else {}
    grid, _ = grid_of(rig)
    record = simulate_on_grid(BoxPlant(WIRES[rig], few_relays(rig), hidden), WIRES[rig], HOLDS[rig], grid)
    y = position(record, WIRES[rig], few_relays(rig), hidden)
    return grid, record, sensor_output(y, record.t_s, hidden)


def settled(name=None, **values):
    grid, _, y = made(name, **values)
    return grid.settled(y)


def targets():
    return np.array([hold.target_K for hold in HOLDS["one_wire"]])


def through_relays(temperatures):
    """Settled outputs of relays that go straight from one temperature to the next."""
    relays, h = Relays(few_relays("one_wire")), few_relays("one_wire")
    return np.array([h.y_lower + h.stroke * relays.move(float(u)) for u in temperatures])


@pytest.mark.parametrize("rig", ["one_wire", "two_wire"])
def test_without_effects_the_wire_follows_the_closed_form(rig):
    grid, record, _ = made(rig=rig)
    nominal = nominal_input(WIRES[rig], HOLDS[rig], grid)
    np.testing.assert_allclose(record.wire_K, nominal, atol=2e-3)


def test_a_hold_ends_a_window_after_the_wire_is_steady():
    grid, record, _ = made()
    ends = np.flatnonzero(np.diff(grid.hold, append=-1))
    begin = ends - 25  # the last time before the window
    assert np.all(np.abs(record.wire_K[begin] - targets()) < 0.01)
    assert np.all(grid.tick[ends] - grid.tick[begin] == 250)
    assert grid.dt_s.max() <= 2.0
    assert not any(grid.timed_out)


def test_walking_adds_its_share_of_the_stroke_each_cycle():
    _, record, y = made("walking", percent_per_cycle=0.4)
    strokes = np.cumsum(np.abs(np.diff(made()[2], prepend=-6.0))) / STROKE
    np.testing.assert_allclose(y - made()[2], 0.004 * STROKE * strokes / 2, atol=1e-9)
    assert record.travel[-1] > 4


def test_slip_is_one_step():
    grid, _, y = made("slip", jump_percent=-3.0, at_h=0.25)
    np.testing.assert_allclose(y - made()[2], np.where(grid.t_s >= 900, -0.03 * STROKE, 0), atol=1e-9)


def test_backlash_swallows_its_play_at_each_reversal():
    """After long moves to and fro the output lags by half the play."""
    lost = settled("backlash", play_percent=4.0) - settled()
    up = np.array([4, 10 - 2, 19])  # ends of long moves: up to saturation, down, up
    assert lost[up[0]] == pytest.approx(-0.02 * STROKE)
    assert lost[up[1]] == pytest.approx(+0.02 * STROKE)
    assert np.abs(lost).max() <= 0.02 * STROKE + 1e-9


def test_slack_is_a_floor_under_which_the_wire_goes_on():
    np.testing.assert_allclose(
        settled("slack", floor_percent=10.0), np.maximum(settled(), -6 + 0.1 * STROKE), atol=0.02
    )


def test_noncongruency_bends_the_output():
    m = (settled() + 6) / STROKE
    np.testing.assert_allclose(
        settled("noncongruency", bend_percent=15.0), -6 + STROKE * (m + 0.3 * m * (1 - m)), atol=1e-3
    )


def test_eccentricity_is_a_wave_over_the_position():
    x, y = made()[2], made("eccentricity", share_percent=3.0, phase=0.1)[2]
    turn = x / 15.0 + 0.2 * math.pi
    np.testing.assert_allclose(y - x, 0.45 * (np.sin(turn) - math.sin(0.2 * math.pi)), atol=1e-12)


def test_expansion_lengthens_by_temperature():
    lost = settled() - settled("thermal_expansion", percent_per_100K=5.0)
    np.testing.assert_allclose(lost, 0.05 * STROKE * targets() / 100, atol=1e-3)


def test_ambient_drift_acts_on_the_relays_and_is_recorded():
    grid, record, _ = made("ambient_drift", swing_K=2.0, period_h=0.4, phase=0.25)
    ambient = 2.0 * (np.cos(2 * np.pi * grid.t_s / 1440) - 1)
    np.testing.assert_allclose(record.ambient_shift_K, ambient, atol=1e-9)
    np.testing.assert_allclose(record.wire_K, made()[1].wire_K + ambient, atol=1e-9)


@pytest.mark.parametrize(
    ("name", "values", "current"),
    [
        (
            "amplifier_gain",
            {"gain_percent": 5.0, "offset_A": 0.01},
            lambda i: np.where(i > 0, 1.05 * i + 0.01, 0),
        ),
        ("dead_zone", {"below_A": 0.05}, lambda i: np.maximum(i - 0.05, 0)),
    ],
)
def test_the_current_that_flows_heats(name, values, current):
    grid, record, y = made(name, **values)
    i = current(np.sqrt(targets() / 174.0))
    np.testing.assert_allclose(grid.settled(record.current_A), i, atol=1e-9)
    np.testing.assert_allclose(grid.settled(y), through_relays(174.0 * i**2), atol=0.03)


def test_saturation_clips_below_what_saturates():
    grid, record, _ = made("saturation", clip_percent=20.0)
    most = 0.8 * math.sqrt(few_relays("one_wire").upper / 174.0)
    np.testing.assert_allclose(
        grid.settled(record.current_A), np.minimum(np.sqrt(targets() / 174.0), most), atol=1e-9
    )


def test_sensor_lag_of_a_ramp_and_of_a_step():
    t = np.linspace(0, 60, 601)
    ramp = sensor_output(2.0 * t, t, {"sensor_lag": {"lag_s": 4.0, "dead_time_s": 3.0}})
    assert ramp[-1] == pytest.approx(2.0 * (60 - 3 - 4), abs=1e-4)
    step = sensor_output((t > 1) * 1.0, t, {"sensor_lag": {"lag_s": 4.0, "dead_time_s": 0.0}})
    np.testing.assert_allclose(step[t > 1.05], 1 - np.exp(-(t[t > 1.05] - 1.05) / 4), atol=1e-3)


def test_settling_comes_late_by_its_share_and_time():
    hold = [PlannedHold(85.0, "", 1500.0)]
    plant = BoxPlant(
        WIRE, few_relays("one_wire"), {"settling": {"share_percent": 4.0, "time_constant_s": 300.0}}
    )
    _, record = simulate_on_new_grid(plant, WIRE, hold, lambda _: 0.0)
    t = record.t_s
    hysteresis_input = 85 * (0.96 * (1 - np.exp(-t / WIRE.tau_s)) + 0.04 * (1 - np.exp(-t / 300)))
    np.testing.assert_allclose(record.hysteresis_input_K, hysteresis_input, atol=2e-3)


def test_cross_talk_comes_late_and_takes_away():
    _, record, _ = made("cross_talk", rig="two_wire", share_percent=10.0, time_constant_s=5.0)
    grid = grid_of("two_wire")[0]
    steady = np.array([hold.target_K for hold in HOLDS["two_wire"]])
    np.testing.assert_allclose(grid.settled(record.hysteresis_input_K), 0.9 * steady, atol=0.05)


def test_stress_is_solved_with_the_relays():
    grid, record, y = made("stress_coupling", shift_K=9.0)
    np.testing.assert_allclose(record.hysteresis_input_K, record.wire_K - 9.0 * record.share, atol=1e-9)
    np.testing.assert_allclose(
        grid.settled(y), through_relays(grid.settled(record.hysteresis_input_K)), atol=0.03
    )


def test_resistance_settles_where_its_heat_agrees_with_the_phase():
    grid, record, _ = made("resistance_phase", change_percent=-15.0)
    share = grid.settled(record.share)
    expected = targets() * (1 - 0.15 * (share - 0.5))
    np.testing.assert_allclose(grid.settled(record.wire_K), expected, atol=0.05)
    np.testing.assert_allclose(grid.settled(record.resistance), 1 - 0.15 * (share - 0.5), atol=1e-6)


def test_latent_heat_takes_its_joules():
    """Heat that came in less heat that was lost is in the wire: c ΔT + L Δξ."""
    hold = [PlannedHold(110.0, "")]
    hidden = {"latent_heat": EFFECTS["latent_heat"].values({"latent_J_per_g": 20.0})}
    _, record = simulate_on_new_grid(
        BoxPlant(WIRE, few_relays("one_wire"), hidden), WIRE, hold, lambda _: 0.0
    )
    T, t = record.wire_K, record.t_s
    before = np.concatenate([[0.0], T[:-1]])
    gained = np.cumsum((110 - (T + before) / 2) * np.diff(t, prepend=0)) / WIRE.tau_s
    stored = T + 20_000 / WIRE.specific_heat * record.share
    np.testing.assert_allclose(gained[20:], stored[20:], rtol=0.02)


def test_convection_keeps_the_steady_temperatures_of_its_law():
    grid, record, _ = made("convection", exponent=0.2)
    expected = 174.0 * (targets() / 174.0) ** (1 / 1.2)
    hot = targets() > 0
    np.testing.assert_allclose(grid.settled(record.wire_K)[hot], expected[hot], atol=0.05)


def test_convection_cools_by_a_power_law():
    """dT/dt = −T (T/T_ref)ⁿ/τ has the solution T = (T₀⁻ⁿ + n t/(τ T_refⁿ))^(−1/n)."""
    heat, n = WireTemperatures(170.0, 0.3), 0.3
    heat.wire_K[0] = 100.0
    for _ in range(20):
        heat.step((0.0, 0.0), 0.5, 5.0)
    assert heat.input_K == pytest.approx((100.0**-n + n * 10 / (5 * 170.0**n)) ** (-1 / n), rel=1e-6)


def test_wire_lag_scales_the_time_constant():
    hold = [PlannedHold(100.0, "")]
    plant = BoxPlant(WIRE, few_relays("one_wire"), {"wire_lag": {"change_percent": 50.0}})
    _, record = simulate_on_new_grid(plant, WIRE, hold, lambda _: 0.0)
    np.testing.assert_allclose(record.wire_K, 100 * (1 - np.exp(-record.t_s / WIRE.tau_s / 1.5)), atol=2e-3)


def test_creep_is_the_sum_of_logarithms():
    grid, _, y = made("creep", percent_per_decade=2.0)
    x, t = made()[2], grid.t_s
    dy = np.diff(x, prepend=x[0])
    for k in range(60, x.size, 300):
        exact = 0.02 * np.sum(dy[: k + 1] * np.log10(1 + t[k] - t[: k + 1]))
        assert y[k] - x[k] == pytest.approx(exact, abs=1e-3)


def test_friction_is_play_and_widens_every_relay():
    _, record, _ = made("coulomb_friction", half_width_K=3.0)
    lag = record.wire_K - record.hysteresis_input_K
    assert np.abs(lag).max() == pytest.approx(3.0)
    assert lag[np.argmax(record.wire_K)] == pytest.approx(3.0)


def test_fatigue_lowers_the_hysteresis_input_with_cycles():
    _, record, _ = made("fatigue", shift_K=4.0, cycles=3.0)
    expected = 4.0 * (1 - np.exp(-record.travel / 2 / 3.0))
    np.testing.assert_allclose(record.wire_K - record.hysteresis_input_K, expected, atol=1e-9)


def test_accommodation_follows_the_state_over_its_strokes():
    _, record, _ = made("accommodation", shift_K=3.0, strokes=0.5)
    z, s, before = [0.0], record.share, 0.0
    for share in s.tolist():  # the differential equation in tiny straight pieces
        here = z[-1]
        for piece in np.linspace(before, share, 51)[1:]:
            here += abs(share - before) / 50 / 0.5 * (piece - here)
        z.append(here)
        before = share
    np.testing.assert_allclose((record.hysteresis_input_K - record.wire_K) / 3.0, z[1:], atol=0.01)


def test_an_arrest_halts_the_next_heating_there_and_a_full_one_erases_it():
    holds = [PlannedHold(float(u), "") for u in (0, 88, 0, 88, 174, 0, 88)]
    hidden = {"temperature_memory": {"retard_K": 1.5, "width_K": 4.0}}
    plant = BoxPlant(WIRE, few_relays("one_wire"), hidden)
    grid, record = simulate_on_new_grid(plant, WIRE, holds, lambda _: 0.0)
    halted = grid.settled(record.wire_K - record.hysteresis_input_K)
    assert halted[[1, 3, 6]] == pytest.approx([0.0, 1.5, 0.0], abs=0.01)
    assert halted[4] == 0.0


def test_a_second_phase_and_cooler_ends_are_relays_in_parallel():
    _grid, record, y = made("r_phase", share_percent=20.0, at=0.5, width_K=2.0)
    x = made()[2]
    h = few_relays("one_wire")
    centre = (h.lower + h.upper) / 2
    far = np.abs(record.hysteresis_input_K - centre) > 40
    np.testing.assert_allclose(
        y[far], 0.8 * x[far] + 0.2 * np.where(record.hysteresis_input_K[far] > centre, 6.0, -6.0), atol=1e-6
    )
    ends = settled("end_conduction", share_percent=10.0, cooler=0.7)
    expected = 0.9 * through_relays(targets()) + 0.1 * through_relays(0.7 * targets())
    np.testing.assert_allclose(ends, expected, atol=0.03)


def test_ambient_fluctuations_have_their_deviation_and_correlation_time():
    next_fluctuation_K = AmbientFluctuation(0.2, 50.0).source(np.random.default_rng(0))
    noise = np.array([next_fluctuation_K(2.0) for _ in range(40_000)])
    assert noise.std() == pytest.approx(0.2, rel=0.05)
    assert np.corrcoef(noise[:-25], noise[25:])[0, 1] == pytest.approx(math.exp(-1), abs=0.06)


def test_a_heating_that_ends_near_saturation_is_no_arrest():
    near = few_relays("one_wire").upper - 8.0  # within three widths
    holds = [PlannedHold(u, "") for u in (0.0, near, 0.0, near)]
    hidden = {"temperature_memory": {"retard_K": 1.5, "width_K": 4.0}}
    grid, record = simulate_on_new_grid(
        BoxPlant(WIRE, few_relays("one_wire"), hidden), WIRE, holds, lambda _: 0.0
    )
    np.testing.assert_allclose(
        grid.settled(record.wire_K - record.hysteresis_input_K)[[1, 3]], 0.0, atol=1e-9
    )
