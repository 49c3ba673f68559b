"""The inverse: a round trip with the least move, exact where possible, and an error where there is no
inverse."""

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from smarig.core.errors import DataError, UsageError
from smarig.preisach.everett import Everett
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.hysteresis.mirrored import Mirrored
from smarig.preisach.hysteresis.relay_measure import RelayMeasure
from smarig.preisach.inverse import InverseSolver, bracketed_root
from smarig.preisach.operator import Preisach


def _table() -> FodTable:
    nodes = np.array([-185.0, -140.0, -60.0, -20.0, -15.0, 30.0, 31.0, 90.0, 150.0, 185.0])
    a, b = np.meshgrid(nodes, nodes, indexing="ij")
    return FodTable.from_arrays(nodes, nodes, np.where(b <= a, thesis_surface("two_e").y(a, b), np.nan))


def _measure() -> RelayMeasure:
    """Whole thresholds −180, −175 … 180, some degenerate; whole masses, so that equal outputs are equal."""
    rng = np.random.default_rng(21)
    pair = np.sort(5.0 * rng.integers(-36, 37, (150, 2)), axis=1)
    pair = pair[(pair[:, 1] < 180) & (pair[:, 0] > -180)]
    mass = rng.integers(1, 5, len(pair)).astype(float)
    return RelayMeasure.from_arrays([*pair[:, 1], 185.0], [*pair[:, 0], -185.0], [*mass, 1.0])


SMOOTH: dict[str, Everett] = {
    "two_e": thesis_surface("two_e"),
    "two_c": thesis_surface("two_c"),
    "table": _table(),
    "mirror": Mirrored(thesis_surface("two_e")),
}
MEASURE = _measure()
SPAN = 35.0
initials = st.sampled_from(["negative", "positive", "anhysteretic"])
inputs = st.one_of(st.integers(-37, 37).map(lambda k: 5.0 * k), st.floats(-190, 190, width=32))
paths = st.lists(inputs, max_size=10)
shares = st.floats(0.0, 1.0)


def range_of(h: Everett) -> tuple[float, float]:
    return h.y_lower, h.y_lower + h.everett(h.upper, h.lower)


# --- there and back -----------------------------------------------------------------------------------


@pytest.mark.long("takes a second")
@given(st.sampled_from(sorted(SMOOTH)), initials, paths, shares)
@example("two_e", "anhysteretic", [60.0, -20.0], 0.02)  # past the mirror image, out of B*
@example("two_e", "anhysteretic", [], 0.9)
@example("table", "negative", [90.0, -15.0, 30.0], 0.999)
def test_the_input_found_brings_the_output_back(name: str, initial, path, share: float):
    h = SMOOTH[name]
    op = Preisach(h, initial)
    op.follow(path)
    before, (low, high) = op.state, range_of(h)
    target = low + share * (high - low)
    u = op.inverse(target)
    assert op.state == before
    assert h.lower <= u <= h.upper
    assert op.step(u) == pytest.approx(target, abs=1e-12 * SPAN)


@pytest.mark.long("takes two seconds")
@given(st.sampled_from(sorted(SMOOTH)), initials, paths, shares)
def test_no_smaller_move_is_enough(name: str, initial, path, share: float):
    """Half the way, and just short of it: the output is not there yet."""
    h = SMOOTH[name]
    op = Preisach(h, initial)
    op.follow(path)
    low, high = range_of(h)
    target = low + share * (high - low)
    assume(abs(target - op.y) > 1e-3)
    u, up = op.inverse(target), target > op.y
    for part in (0.5, 0.9, 0.99):
        short = op.peek(op.u + part * (u - op.u))
        assert short < target if up else short > target


@given(initials, paths, st.integers(-40, 40))
@example("negative", [100.0], 0)
@example("negative", [-100.0, -100.0, -105.0], -3)
def test_relays_switch_at_the_first_threshold_that_reaches_the_target(initial, path, step: int):
    """At the found input at least the target is reached; a hair before it, it is not."""
    op = Preisach(MEASURE, initial)
    op.follow(path)
    low, high = range_of(MEASURE)
    target = min(max(op.y + 7.0 * step, low), high)
    assume(target != op.y)
    up, u = target > op.y, op.inverse(target)
    before = op.peek(float(np.nextafter(u, op.u)))
    there = op.peek(u)
    assert there >= target if up else there <= target
    assert before < target if up else before > target


@given(initials, paths)
def test_the_present_output_needs_no_move(initial, path):
    for h in (*SMOOTH.values(), MEASURE):
        op = Preisach(h, initial)
        op.follow(path)
        assert op.inverse(op.y) == op.u


def test_relays_standing_on_a_threshold_switch_by_the_shortest_move():
    """At u = β a fall switches the relay at once; the next threshold down would switch two."""
    op = Preisach.from_measure([10.0, 10.0, 20.0], [10.0, 0.0, -20.0], [1.0, 1.0, 1.0])
    op.step(10.0)
    target = op.y - 2.0
    u = op.inverse(target)
    assert 10.0 - 1e-12 < u < 10.0
    assert op.step(u) == target


# --- trajectories -------------------------------------------------------------------------------------


@given(st.sampled_from(sorted(SMOOTH)), initials, st.lists(shares, min_size=1, max_size=10))
def test_a_trajectory_is_followed_output_by_output(name: str, initial, parts):
    h = SMOOTH[name]
    low, high = range_of(h)
    y = low + np.array(parts) * (high - low)
    op = Preisach(h, initial)
    u = op.inverse_trajectory(y)
    assert np.max(np.abs(Preisach(h).simulate(u, initial) - y)) <= 1e-12 * SPAN
    again = Preisach(h, initial)
    again.follow(u)
    assert again.state == op.state


def test_a_trajectory_of_relays_is_met_exactly_where_it_can_be():
    path = 5.0 * np.random.default_rng(22).integers(-37, 38, 400) + 2.0
    y = Preisach(MEASURE).simulate(path)
    assert np.unique(y).size > 50
    u = Preisach(MEASURE).inverse_trajectory(y)
    assert np.array_equal(Preisach(MEASURE).simulate(u), y)
    assert np.abs(np.diff(u)).sum() < np.abs(np.diff(path)).sum()


def test_an_unreachable_sample_is_named_and_what_came_before_stays():
    h = thesis_surface("two_e")
    op = Preisach(h)
    with pytest.raises(DataError, match=r"Sample 2: Output 30 cannot be reached: the range ends at 18\.1"):
        op.inverse_trajectory([0.0, -5.0, 30.0, 0.0])
    assert op.y == pytest.approx(-5.0, abs=1e-12)


@pytest.mark.parametrize("excess", [1e-6, 1e-9, 2e-11])
def test_a_refusal_prints_a_target_that_differs_from_the_end(excess: float):
    h = thesis_surface("one_e")
    with pytest.raises(DataError, match="cannot be reached") as refused:
        Preisach(h).inverse(h.y_upper + excess)
    words = str(refused.value).rstrip(".").split()
    assert float(words[1]) - float(words[-1]) == pytest.approx(excess, rel=1e-2)


@pytest.mark.parametrize("y", [[[1.0, 2.0]], 1.0, np.ones((2, 1))], ids=str)
def test_a_trajectory_is_one_row_of_outputs(y):
    with pytest.raises(UsageError, match="The inverse needs a one-dimensional output, got shape"):
        Preisach(thesis_surface("two_e")).inverse_trajectory(y)
    with pytest.raises(UsageError, match="The inverse needs a one-dimensional output of numbers"):
        Preisach(thesis_surface("two_e")).inverse_trajectory(["high"])


@pytest.mark.parametrize("target", [float("nan"), float("inf"), -float("inf")])
def test_what_is_no_number_is_no_target(target: float):
    with pytest.raises(DataError, match="it is not a finite number"):
        Preisach(thesis_surface("two_e")).inverse(target)


# --- where there is no inverse --------------------------------------------------------------------------


def test_two_wire_p_turns_back_rising_and_the_error_names_where():
    """The named stretch is where the output falls while the input rises; before it there is an inverse."""
    op = Preisach(thesis_surface("two_p"))
    op.follow([170.0, -55.0])
    u = np.linspace(-55.0, 185.0, 4001)
    y = np.array([op.peek(v) for v in u.tolist()])
    falling = u[1:][np.diff(y) < 0]
    assert falling.size > 0, "this branch must turn back, or the test shows nothing"
    with pytest.raises(DataError, match=r"not monotone on the way to 18\.1") as refusal:
        op.inverse(18.1)
    words = str(refusal.value).split(" from ")[1].split()
    pitch = 370 / 256
    assert float(words[0]) == pytest.approx(falling[0], abs=pitch)
    assert float(words[2]) == pytest.approx(falling[-1], abs=pitch)
    assert op.peek(op.inverse(18.0)) == pytest.approx(18.0, abs=1e-12 * SPAN)


def test_an_output_passed_on_the_way_up_is_not_looked_for_behind_the_dip():
    """From 175 the branch overshoots 18.1, comes back below it, and would pass it a second time."""
    op = Preisach(thesis_surface("two_p"))
    op.follow([175.0, -55.0])
    assert op.peek(175.0) < 18.1 < op.peek(159.0)
    u = op.inverse(18.1)
    assert u < 159.0
    assert op.peek(u) == pytest.approx(18.1, abs=1e-12 * SPAN)


def test_two_wire_p_falls_monotonically_and_is_invertible_that_way():
    op = Preisach(thesis_surface("two_p"), "positive")
    for target in (15.0, 3.0, -16.0):
        assert op.peek(op.inverse(target)) == pytest.approx(target, abs=1e-12 * SPAN)


@pytest.mark.parametrize("name", ["one_c", "one_e", "two_c", "two_e", "two_p", "one_p"])
def test_which_surfaces_are_monotone_everywhere(name: str):
    """Non-negative strip sums, not μ ≥ 0: all but two-wire p, whose slope goes down to −0.037 (theory.md §1)."""
    assert InverseSolver(thesis_surface(name)).monotone == (name != "two_p")


def test_relays_of_negative_mass_turn_back_and_the_error_names_where():
    op = Preisach.from_measure([10.0, 20.0, 40.0], [0.0, 5.0, 7.0], [1.0, -0.5, 2.0])
    assert op.peek(op.inverse(-1.0)) >= -1.0  # before the negative one
    with pytest.raises(DataError, match="rises from 10 to 20 the output reverses"):
        op.inverse(2.0)


def test_a_table_that_turns_back_is_refused_with_where():
    y = np.array([[0.0, np.nan, np.nan, np.nan], [0, 4, np.nan, np.nan], [0, 1, 3, np.nan], [0, 1, 2, 6]])
    op = Preisach.from_table([0, 1, 2, 3], [0, 1, 2, 3], y)
    assert op.peek(op.inverse(2.0)) == pytest.approx(2.0, abs=1e-12)
    with pytest.raises(DataError, match="rises from 1 to 2 the output reverses"):
        op.inverse(5.0)


def test_only_the_path_to_the_target_matters():
    """A measure that is not monotone somewhere has an inverse wherever the way there is."""
    op = Preisach.from_measure([10.0, 20.0, 40.0], [0.0, 5.0, 7.0], [1.0, -0.5, 2.0])
    op.step(45.0)
    assert op.inverse(op.y - 1.0) == 7.0


# --- the root finder ------------------------------------------------------------------------------------


@given(st.floats(-3, 3), st.sampled_from([0.2, 1.0, 3.0, 9.0]), st.booleans())
def test_the_root_is_found_in_few_calls_whatever_the_shape(zero: float, power: float, turned: bool):
    calls = []

    def f(u: float) -> float:
        calls.append(u)
        d = (zero - u) if turned else (u - zero)
        return float(np.sign(d) * abs(d) ** power)

    ends = (5.0, -4.0) if turned else (-4.0, 5.0)
    assert abs(bracketed_root(f, *ends) - zero) <= 1e-14 * 9
    assert len(calls) < 300


def test_a_linear_function_takes_one_step():
    calls = []
    assert bracketed_root(lambda u: calls.append(u) or u - 1.5, 0.0, 2.0) == 1.5
    assert len(calls) == 3
