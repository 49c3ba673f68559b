"""Integral action with hysteresis: the gains that are proved to converge, and that larger ones do not.

The bounds are compared with the frequency response and with a search, and every loop is simulated by definition. The
whole campaign of 200 wires runs with SMARIG_LONG=1.
"""

import math
import os

import numpy as np
import pytest

from control.random_loops import FLATTEST, RANGE, Loop, random_loops, random_table, steepest_major_branch
from smarig.control import SETPOINT_CONTROLLERS, LoopTiming, integral_gains
from smarig.control.regulation.integral_action import IntegralAction
from smarig.core import UsageError, catalogue_entry
from smarig.preisach import FodTable, Mirrored, Preisach, RelayMeasure, thesis_surface
from smarig.protocols import Setup
from smarig.rig import Twin
from smarig.theory import largest_slope

LONG = os.environ.get("SMARIG_LONG") == "1"
WIRES = 200 if LONG else 40
COUNT = 0.02
TIMINGS = [(0.1, 5.3, 0.0), (0.1, 5.3, 0.1), (1.0, 0.4, 2.0), (0.5, 20.0, 3.0)]


# --- the bounds ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("period", "tau", "delay"), TIMINGS)
def test_the_first_bound_is_the_circle_criterion_of_the_sampled_loop(period, tau, delay):
    """inf Re G = −1/λ for the sampled lag, dead time and integral, computed on the unit circle."""
    gains = integral_gains(thesis_surface("one_c"), LoopTiming(period, tau, delay))
    z = np.exp(1j * np.logspace(-5, math.log10(math.pi), 200_000))
    a = math.exp(-period / tau)
    lag = (1 - a) * z ** -(1 + round(delay / period)) / (1 - a / z)
    response = gains.any_state * period * lag / (1 - 1 / z)
    assert float(response.real.min()) == pytest.approx(-1 / gains.slope, rel=1e-5)


@pytest.mark.parametrize(("period", "tau", "delay"), TIMINGS)
def test_the_second_bound_is_the_largest_that_a_search_finds(period, tau, delay):
    gains = integral_gains(thesis_surface("one_c"), LoopTiming(period, tau, delay))
    a, n = math.exp(-period / tau), np.arange(1, 2000)
    best = 0.0
    for shrink in np.linspace(a, 1.0, 2001)[1:-1]:  # e shrinks by at most this factor per tick
        shares = (1 - a) * (a / shrink) ** (n - 1) * shrink ** -round(delay / period)
        best = max(best, (1 - shrink) / float(shares.sum()))
    assert gains.from_rest * gains.slope * period == pytest.approx(best, rel=2e-3)


def test_short_ticks_give_the_continuous_bounds():
    gains = integral_gains(thesis_surface("two_c"), LoopTiming(1e-3, 5.0))
    assert gains.any_state * gains.slope * 5.0 == pytest.approx(1.0, rel=1e-6)
    assert gains.from_rest * gains.slope * 5.0 == pytest.approx(0.25, rel=1e-6)


# --- λ ------------------------------------------------------------------------------------------------------


@pytest.mark.long("takes a second", cases=("two_p",))
@pytest.mark.parametrize("name", ["one_p", "one_e", "two_c", "two_p"])
def test_no_chord_of_a_surface_is_steeper_than_its_largest_slope(name):
    s = thesis_surface(name)
    found = largest_slope(s)
    u, h = np.linspace(s.lower, s.upper, 301), 1e-4
    a, b = np.meshgrid(u, u, indexing="ij")
    a, b = (x[b < a - 2 * h] for x in (a, b))
    rising, falling = (s.swept(a, b) - s.swept(a - h, b)) / h, (s.swept(a, b) - s.swept(a, b + h)) / h
    dense = float(max(rising.max(), falling.max()))
    assert dense <= found.bound * (1 + 1e-7)
    assert dense == pytest.approx(found.value, rel=1e-3)
    assert found.value <= found.bound <= found.value * (1 + 1e-4)
    assert largest_slope(Mirrored(s)).value == pytest.approx(found.value, rel=1e-12)


def test_the_largest_slope_of_a_table_is_that_of_its_major_loop():
    for k in range(20):
        table = random_table(np.random.default_rng(k))
        assert largest_slope(table).value == pytest.approx(steepest_major_branch(table), rel=1e-12)


@pytest.mark.long("takes two seconds")
def test_no_move_of_an_operator_is_steeper():
    rng = np.random.default_rng(7)
    for name in ("one_e", "two_e"):
        s, u = thesis_surface(name), None
        u = rng.uniform(s.lower, s.upper, 2000) * rng.choice([1.0, 0.1], 2000)
        y = Preisach(s, "negative").simulate(np.clip(np.concatenate([[s.lower], u]), s.lower, s.upper))
        slopes = np.diff(y) / np.diff(np.concatenate([[s.lower], u]))
        assert slopes.min() >= 0
        assert slopes.max() <= largest_slope(s).bound * (1 + 1e-9)


# --- what has no bound --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("hysteresis", "says"),
    [
        (RelayMeasure.from_arrays([60.0, 50.0], [20.0, 10.0], [1.0, 1.0]), "jumps"),
        (thesis_surface("two_p"), "falls somewhere as its input rises"),
    ],
)
def test_a_model_without_a_bound_is_refused(hysteresis, says):
    with pytest.raises(UsageError, match=says):
        integral_gains(hysteresis, LoopTiming(0.1, 5.0))


# --- convergence --------------------------------------------------------------------------------------------


def ticks_until_settled(gain: float, time_constants: float = 12.0) -> int:
    """Enough ticks for the flattest branch, the even reversible part of every table, to settle to 1e-4."""
    return int(time_constants / (gain * FLATTEST)) + 500


def unlimited(gain: float, source: float):
    loop = IntegralAction(gain, 1.0, (-math.inf, math.inf))
    loop.start(source)
    return loop.step


@pytest.mark.long("takes two seconds")
def test_every_wire_converges_below_the_first_bound_from_any_state():
    """0.999 of the bound, from a random memory and a source that is not at rest."""
    for loop, rng in random_loops(1, WIRES):
        gain = 0.999 * integral_gains(loop.table, LoopTiming(1.0, loop.tau, float(loop.delay))).any_state
        source = float(rng.uniform(-50, 150))
        y = loop.run(unlimited(gain, source), ticks_until_settled(gain), source=source)
        assert np.abs(y[-50:] - loop.setpoint).max() < 1e-3


@pytest.mark.long("takes three seconds")
def test_every_wire_goes_to_its_count_without_overshoot_below_the_second_bound():
    """The whole bound, from rest, with counts and with a source between the saturations."""
    for loop, _ in random_loops(2, WIRES):
        gains = integral_gains(loop.table, LoopTiming(1.0, loop.tau, float(loop.delay)))
        controller = IntegralAction(gains.from_rest, 1.0, (0.0, RANGE), COUNT, gains)
        controller.start(loop.past[-1])
        y = loop.run(controller.step, ticks_until_settled(gains.from_rest, 8.0), count=COUNT)
        start = rest_output(loop)
        nearest = COUNT * round(loop.setpoint / COUNT)
        beyond = (y - nearest) * math.copysign(1.0, nearest - start)
        if abs(start - nearest) > COUNT:
            assert beyond.max() <= COUNT / 2 + 1e-9  # never past the count of the set-point
        assert np.abs(y[-50:] - nearest).max() <= COUNT / 2 + 1e-9
        assert np.abs(y[-50:] - loop.setpoint).max() <= COUNT


def rest_output(loop: Loop) -> float:
    operator = Preisach(loop.table, "negative")
    return float(operator.simulate(np.array(loop.past))[-1])


# --- the bounds are not empty -------------------------------------------------------------------------------


def straight_wire(delay: int) -> Loop:
    """No hysteresis: y = 0.1 u, and nearly no lag, so that the dead time alone limits the gain."""
    y = np.where(np.tri(2, dtype=bool), np.array([0.0, 10.0]), np.nan)
    return Loop(FodTable.from_arrays([0.0, RANGE], [0.0, RANGE], y), 0.2, delay, (20.0,), 5.0)


def test_both_bounds_are_close_for_dead_time_without_hysteresis():
    """The linear loop overshoots above kλD = 1/e and oscillates above π/2; the bounds are 1/e and 1."""
    loop = straight_wire(40)
    gains = integral_gains(loop.table, LoopTiming(1.0, loop.tau, 40.0))

    def outputs(gain: float) -> np.ndarray:
        return loop.run(unlimited(gain, 20.0), 6000)

    assert outputs(gains.from_rest).max() <= 5.0 + 1e-9
    assert outputs(1.05 * gains.from_rest).max() > 5.0 + 1e-4
    assert np.abs(outputs(1.45 * gains.any_state)[-200:] - 5.0).max() < 1e-3
    assert np.ptp(outputs(1.65 * gains.any_state)[-200:]) > 1.0


def test_most_wires_oscillate_at_a_multiple_of_the_first_bound():
    """Random wires lose convergence at 3 to 33 times the bound (median 8); at 30 times nearly all have."""
    oscillate = 0
    for loop, rng in random_loops(1, 12):
        gain = 30 * integral_gains(loop.table, LoopTiming(1.0, loop.tau, float(loop.delay))).any_state
        source = float(rng.uniform(-50, 150))
        tail = loop.run(unlimited(gain, source), 6000, source=source)[-1500:]
        oscillate += bool(np.ptp(tail[750:]) > max(0.05, 0.9 * np.ptp(tail[:750])))
    assert oscillate >= 10


# --- on the twin --------------------------------------------------------------------------------------------


@pytest.mark.long("takes a second", cases=("two_wire_twin-two_e-9.0-2000",))
@pytest.mark.parametrize(
    ("rig", "surface", "setpoint", "ticks"),
    [("one_wire_twin", "one_e", 6.0, 3500), ("two_wire_twin", "two_e", 9.0, 2000)],
)
def test_a_twin_is_brought_to_its_set_point_from_afar(rig, surface, setpoint, ticks):
    """From the encoder's zero, with instruments and their noise; the readings pass the set-point by noise alone."""
    twin, setup, h = Twin.named(rig, seed=3), Setup.of(rig), thesis_surface(surface)
    count = twin.position_per_count
    loop = catalogue_entry(SETPOINT_CONTROLLERS, "integral")(setup, h, count)
    loop.start(0.0)
    current, positions = 0.0, []
    for _ in range(ticks):
        sample = twin.step(current)[0]
        positions.append(sample.position)
        current = setup.current_for(loop.step(setpoint - sample.position))
    assert abs(float(np.mean(positions[-600:])) - setpoint) <= count
    assert max(positions) <= setpoint + 3 * count
