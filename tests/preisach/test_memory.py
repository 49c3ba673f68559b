"""Memory: wiping-out, congruency of comparable loops, and independence of time."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from smarig.core.errors import DataError, UsageError
from smarig.preisach.everett import Everett
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.hysteresis.gorbet_1997 import THESIS_SURFACES, thesis_surface
from smarig.preisach.hysteresis.mirrored import Mirrored
from smarig.preisach.hysteresis.relay_measure import RelayMeasure
from smarig.preisach.operator import Preisach, State


def _table() -> FodTable:
    nodes = np.linspace(-185.0, 185.0, 9)
    a, b = np.meshgrid(nodes, nodes, indexing="ij")
    return FodTable.from_arrays(nodes, nodes, np.where(b <= a, thesis_surface("two_p").y(a, b), np.nan))


def _measure(seed: int, *, positive: bool) -> RelayMeasure:
    rng = np.random.default_rng(seed)
    pair = np.sort(rng.integers(-184, 185, (200, 2)), axis=1).astype(float)
    mass = rng.uniform(0, 1, 200) if positive else rng.normal(0, 1, 200)
    return RelayMeasure.from_arrays([*pair[:, 1], 185.0], [*pair[:, 0], -185.0], [*mass, 0.1])


# One of each kind on one input range, by name for readable failures.
SYSTEMS: dict[str, Everett] = {
    "surface": thesis_surface("two_e"),
    "table": _table(),
    "measure": _measure(1, positive=False),
    "mirror": Mirrored(thesis_surface("two_p")),
}
POSITIVE: dict[str, Everett] = {
    "two_c": thesis_surface("two_c"),
    "one_c": thesis_surface("one_c"),
    "measure": _measure(2, positive=True),
}
SPAN = 35.0  # output range of every system here, within a factor of ten

systems = st.sampled_from(sorted(SYSTEMS))
initials = st.sampled_from(["negative", "positive", "anhysteretic"])
inputs = st.one_of(
    st.integers(-37, 37).map(lambda k: 5.0 * k),  # ties, thresholds, nodes and both saturations
    st.floats(-190.0, 190.0, allow_nan=False, width=32),
)
histories = st.lists(inputs, min_size=1, max_size=12)


def after(name: str, initial, history) -> Preisach:
    op = Preisach(SYSTEMS[name], initial)
    for u in history:
        op.step(u)
    return op


def reduced(history: list[float]) -> list[float]:
    """Reduced memory sequence (6.1) from B*: the extremum of largest |u|, last attained; then in turns."""
    rest, sequence, rising = history, [], None
    while rest:
        if rising is None:
            size = max(map(abs, rest))
            k = max(i for i, u in enumerate(rest) if abs(u) == size)
            rising = rest[k] < 0
        else:
            best = max(rest) if rising else min(rest)
            k = max(i for i, u in enumerate(rest) if u == best)
            rising = not rising
        sequence.append(rest[k])
        rest = rest[k + 1 :]
    return sequence


# --- wiping-out (§3.3.1) ----------------------------------------------------------------------------


@given(systems, initials, histories, st.lists(st.floats(0, 1, width=32), max_size=8), inputs)
@example("measure", "negative", [100.0, -20.0], [0.5, 0.0, 1.0, 0.25], 100.0)
@example("surface", "anhysteretic", [100.0], [0.5, 0.2, 1.0], -100.0)
def test_a_dominated_sub_sequence_leaves_no_trace(name: str, initial, history, wiggle, end: float):
    """What stays between two inputs is forgotten on arrival at the second: equal states, bit for bit."""
    op, other = after(name, initial, history), after(name, initial, history)
    begin = op.u
    low, high = min(begin, end), max(begin, end)
    for part in wiggle:
        op.step(min(max(begin + part * (end - begin), low), high))
    op.step(end)
    other.step(end)
    assert op.state == other.state


@given(systems, st.lists(st.integers(-36, 36).map(lambda k: 5.0 * k), min_size=1, max_size=30))
@example("table", [180.0, -180.0, 180.0])
@example("measure", [100.0, -50.0, 80.0, -80.0, -100.0, 90.0])
def test_the_state_is_the_reduced_memory_sequence(name: str, history: list[float]):
    """From B*, the whole past and its reduced sequence (6.1) lead to the same state, bit for bit."""
    assert after(name, "anhysteretic", history).state == after(name, "anhysteretic", reduced(history)).state


def test_histories_reach_deep_memory():
    """The properties above mean something only if random histories remember: excitation of this chapter."""
    rng = np.random.default_rng(3)
    depth = [
        len(after("surface", "anhysteretic", rng.uniform(-180, 180, 30)).state.extrema) for _ in range(100)
    ]
    assert np.mean(depth) > 4
    assert max(depth) >= 8


# --- congruency (§3.3.2) ----------------------------------------------------------------------------


@given(systems, histories, histories, st.floats(-170, 160, width=32), st.floats(5, 60, width=32), st.data())
def test_comparable_minor_loops_are_congruent(name: str, one, two, low: float, width: float, data):
    high = low + width
    along = data.draw(st.lists(st.floats(0, 1, width=32), min_size=2, max_size=6))
    path = [*(low + part * width for part in along), high, low]

    def loop(history) -> np.ndarray:
        op = after(name, "negative", [*history, high, low])
        start = op.y
        return np.array([op.step(min(max(u, low), high)) for u in path]) - start

    assert np.max(np.abs(loop(one) - loop(two))) <= 1e-12 * SPAN


def test_congruent_loops_stand_at_different_outputs():
    """What congruency does not say: the loops differ by a vertical shift, so the test above is not empty."""
    low, high = -20.0, 40.0
    shift = after("surface", "negative", [high, low]).y - after("surface", "negative", [180.0, high, low]).y
    assert abs(shift) > 1.0


# --- rate-independence ------------------------------------------------------------------------------


@given(systems, initials, histories, st.integers(1, 5))
def test_intermediate_points_change_nothing(name: str, initial, history, between: int):
    here = after(name, initial, history)
    path = [Preisach(SYSTEMS[name], initial).u, *history]
    dense = [u for a, b in pairwise(path) for u in [*np.linspace(a, b, between + 2).tolist()[1:-1], b]]
    assert after(name, initial, dense).state == here.state


@given(systems, initials, histories)
def test_standing_still_changes_nothing(name: str, initial, history):
    twice = [u for u in history for _ in range(2)]
    assert after(name, initial, twice).state == after(name, initial, history).state


# --- saturation --------------------------------------------------------------------------------------


@given(st.sampled_from(sorted(POSITIVE)), initials, histories)
def test_positive_measures_stay_between_the_saturations(name: str, initial, history):
    h = POSITIVE[name]
    y_upper = h.y_lower + h.everett(h.upper, h.lower)
    y = Preisach(h).simulate(history, initial)
    slack = 1e-12 * (y_upper - h.y_lower)
    assert y.min() >= h.y_lower - slack
    assert y.max() <= y_upper + slack


@given(systems, initials, histories, st.floats(0, 1e6), st.booleans())
def test_saturation_clips_and_forgets(name: str, initial, history, beyond: float, up: bool):
    h = SYSTEMS[name]
    op = after(name, initial, history)
    edge = h.upper if up else h.lower
    op.step(edge + (beyond if up else -beyond))
    assert op.u == edge
    assert op.state == Preisach(h, "positive" if up else "negative").state
    assert op.state.extrema == (h.lower,)


@pytest.mark.parametrize("name", SYSTEMS)
def test_infinite_inputs_saturate(name: str):
    op = after(name, "anhysteretic", [30.0])
    assert op.step(float("inf")) == Preisach(SYSTEMS[name], "positive").y
    assert op.step(float("-inf")) == SYSTEMS[name].y_lower


# --- the state as a value ----------------------------------------------------------------------------


@given(systems, initials, histories, histories)
@example("surface", "anhysteretic", [50.0], [-50.0, 50.0])
def test_a_state_goes_on_bit_for_bit(name: str, initial, first, second):
    op = after(name, initial, first)
    saved = op.state
    straight = [op.step(u) for u in second]
    resumed = Preisach(SYSTEMS[name], saved)
    assert resumed.state == saved
    assert [resumed.step(u) for u in second] == straight
    assert resumed.state == op.state


@given(systems, initials, histories, inputs)
def test_peek_leaves_the_memory(name: str, initial, history, u: float):
    op = after(name, initial, history)
    before = op.state
    foreseen = op.peek(u)
    assert op.state == before
    assert op.step(u) == foreseen


def test_a_saved_state_does_not_follow_the_operator():
    op = after("surface", "negative", [100.0, 0.0, 50.0])
    saved = op.state
    op.step(180.0)
    assert saved.extrema == (-185.0, 100.0, 0.0)
    assert isinstance(saved, State)


# --- the mirror -------------------------------------------------------------------------------------


@given(st.sampled_from(["surface", "table"]), initials, histories)
def test_mirrored_twice_is_the_hysteresis_itself(name: str, initial, history):
    h = SYSTEMS[name]
    twice = Mirrored(Mirrored(h))
    assert (twice.lower, twice.upper) == (h.lower, h.upper)
    assert twice.everett(60.0, -30.0) == h.everett(60.0, -30.0)
    there, here = Preisach(twice).simulate(history, initial), Preisach(h).simulate(history, initial)
    assert np.max(np.abs(there - here)) <= 1e-12 * SPAN


@given(histories)
def test_the_mirror_turns_everything_round(history):
    """Γ̃[u] = −Γ[−u], from B* too (signs of F and of both diagonal integrals)."""
    h = thesis_surface("two_e")
    there = Preisach(Mirrored(h)).simulate(history, "anhysteretic")
    here = Preisach(h).simulate([-u for u in history], "anhysteretic")
    assert np.max(np.abs(there + here)) <= 1e-12 * SPAN


@given(st.sampled_from([-90.0, 10.0, 120.0]), histories)
def test_the_mirror_of_a_diagonal_state_is_one(centre: float, history):
    """B_ℓ is seen in the mirror as B_−ℓ, clipped at the other end of the range."""
    op, image = Preisach(Mirrored(thesis_surface("two_e"))), Preisach(thesis_surface("two_e"))
    assert op.go_to_diagonal(centre) == pytest.approx(-image.go_to_diagonal(-centre), abs=1e-12 * SPAN)
    for u in history:
        assert op.step(u) == pytest.approx(-image.step(-u), abs=1e-12 * SPAN)


# --- the inverse ------------------------------------------------------------------------------------


@given(st.sampled_from(["one_c", "one_e", "two_c", "two_e"]), histories, st.floats(0.001, 0.999))
def test_the_inverse_goes_back_and_forth(name: str, history, share: float):
    """Non-negative strip sums suffice, μ ≥ 0 is not needed: both e surfaces are invertible (theory §1)."""
    h = thesis_surface(name)
    op = Preisach(h, "anhysteretic")
    for u in history:
        op.step(u)
    before = op.state
    target = h.y_lower + share * (h.y_upper - h.y_lower)
    u = op.inverse(target)
    assert op.state == before
    assert op.step(u) == pytest.approx(target, abs=1e-12 * (h.y_upper - h.y_lower))


def test_the_inverse_starts_from_a_given_state_and_ends_at_saturation():
    h = thesis_surface("two_e")
    op = after("surface", "negative", [100.0, -50.0])
    elsewhere = after("surface", "negative", [20.0]).state
    u = op.inverse(9.0, elsewhere)
    assert Preisach(h, elsewhere).step(u) == pytest.approx(9.0, abs=1e-12)
    assert op.inverse(op.y) == op.u
    assert Preisach(h).step(op.inverse(h.y_upper)) == pytest.approx(h.y_upper, abs=1e-12)
    assert Preisach(h, "positive").step(op.inverse(h.y_lower)) == pytest.approx(h.y_lower, abs=1e-12)


@pytest.mark.parametrize("name", THESIS_SURFACES)
def test_saturation_is_reachable_to_the_last_bit(name: str):
    """Outputs computed elsewhere differ from y₊ and y₋ by rounding; that is no reason to refuse them."""
    h = thesis_surface(name)
    for initial in ("negative", "anhysteretic", "positive"):
        op = Preisach(h, initial)
        for target, end in ((h.y_upper, h.upper), (h.y_lower, h.lower)):
            for neighbour in (np.nextafter(target, 99), target, np.nextafter(target, -99)):
                u = op.inverse(float(neighbour))
                assert op.peek(u) == pytest.approx(target, abs=1e-12 * SPAN)
                assert op.peek(end) == pytest.approx(target, abs=1e-12 * SPAN)


@pytest.mark.parametrize("target", [18.2, -16.6])
def test_the_inverse_refuses_what_saturation_does_not_give(target: float):
    op = after("surface", "negative", [100.0, -50.0])
    before = op.state
    with pytest.raises(DataError, match=rf"Output {target} cannot be reached: the range ends at "):
        op.inverse(target)
    assert op.state == before


def _table_without(i, j) -> Preisach:
    y = np.tri(3).cumsum(axis=1)
    y[i, j] = np.nan
    return Preisach.from_table([0, 1, 2], [0, 1, 2], y)


# --- what the operator refuses -------------------------------------------------------------------------


@given(systems, initials, histories)
def test_nan_is_refused_and_leaves_the_memory(name: str, initial, history):
    op = after(name, initial, history)
    before = op.state
    with pytest.raises(DataError, match="The input of the Preisach operator is NaN"):
        op.step(float("nan"))
    assert op.state == before


NO_NUMBERS = ["1.0", None, [1.0], 1j, np.array([1.0, 2.0])]


@pytest.mark.parametrize("start", ["negative", "anhysteretic"])
@pytest.mark.parametrize("wrong", NO_NUMBERS, ids=str)
def test_what_is_no_number_is_refused_and_leaves_the_memory(wrong, start):
    op = after("surface", start, [100.0, -50.0])
    before = op.state
    for move in (op.step, op.peek, op.go_to_diagonal):
        with pytest.raises(UsageError, match="needs a number as its input, got "):
            move(wrong)
    with pytest.raises(UsageError, match="needs a number as its output, got "):
        op.inverse(wrong)
    assert op.state == before


def test_no_diagonal_state_is_centred_on_nan():
    op = after("surface", "negative", [100.0, -50.0])
    before = op.state
    with pytest.raises(DataError, match="The input of the Preisach operator is NaN"):
        op.go_to_diagonal(float("nan"))
    assert op.state == before


@pytest.mark.parametrize("wrong", ["surface", None, [1.0, 2.0]], ids=str)
def test_an_operator_needs_a_hysteresis(wrong):
    for build in (Preisach, Preisach.from_surface):
        with pytest.raises(UsageError, match="needs a hysteresis .*, got "):
            build(wrong)


def test_words_and_tables_of_inputs_are_refused():
    op = Preisach(thesis_surface("two_e"))
    with pytest.raises(
        UsageError, match="Initial state 'cold' must be negative, positive, anhysteretic or a State"
    ):
        op.reset("cold")
    with pytest.raises(UsageError, match=r"one-dimensional input, got shape \(2, 2\)"):
        op.follow(np.zeros((2, 2)))
    with pytest.raises(UsageError, match="one-dimensional input of numbers"):
        op.simulate([[1.0, 2.0], [3.0]])


HUGE = 10**400  # an integer of 401 digits is no float


@pytest.mark.parametrize(
    "give",
    [
        lambda op: op.simulate([0.0, HUGE]),
        lambda op: op.inverse(HUGE),
        lambda op: op.inverse_trajectory([HUGE]),
        lambda op: op.go_to_diagonal(HUGE),
        lambda op: Preisach.from_table([0, HUGE], [0, HUGE], np.zeros((2, 2))),
        lambda op: Preisach.from_table([0, 1], [0, 1], [[0, 0], [HUGE, 0]]),
        lambda op: Preisach.from_measure([HUGE], [0], [1]),
        lambda op: Preisach.from_measure([1], [0], [HUGE]),
        lambda op: replace(op.hysteresis, x=(HUGE, *op.hysteresis.x[1:])),
    ],
)
def test_an_integer_that_is_no_float_is_refused_in_a_sentence(give):
    with pytest.raises((UsageError, DataError), match="number"):
        give(Preisach(thesis_surface("two_e")))


def test_a_step_to_a_huge_integer_saturates():
    op = Preisach(thesis_surface("two_e"))
    assert (
        op.step(HUGE)
        == op.hysteresis.everett(op.hysteresis.upper, op.hysteresis.lower) + op.hysteresis.y_lower
    )
    assert op.u == op.hysteresis.upper


@pytest.mark.parametrize(
    ("build", "sentence"),
    [
        (lambda: Preisach.from_measure([1.0], [2.0], [1.0]), "A relay has α < β"),
        (lambda: Preisach.from_measure([1.0, 2.0], [0.0], [1.0]), "differ in length or are empty: 2, 1, 1"),
        (lambda: Preisach.from_measure(["a"], [2.0], [1.0]), "needs numbers below 1.8e308: thresholds α"),
        (lambda: Preisach.from_table([0, 1], [0, 1], "y"), "inputs α, β and outputs y must be numbers"),
        (lambda: Preisach.from_measure([], [], []), "differ in length or are empty: 0, 0, 0"),
        (lambda: Preisach.from_table([0, 1], [0, 1], np.zeros((2, 3))), r"shape \(2, 3\), expected \(2, 2\)"),
        (lambda: Preisach.from_table([0, 2], [0, 1], np.zeros((2, 2))), "α and β must share one partition"),
        (lambda: Preisach.from_table([0, 0], [0, 0], np.zeros((2, 2))), "strictly increasing"),
        (lambda: _table_without(2, 1), "no value at α = 2, β = 1"),
        (lambda: _table_without(slice(None), 0), "no value at α = 0, β = 0"),
    ],
)
def test_what_is_no_hysteresis_is_refused(build, sentence: str):
    with pytest.raises(DataError, match=sentence):
        build()


def test_assumptions_of_this_chapter():
    """SPAN is correct: the outputs of the four systems move over a comparable range."""
    for h in SYSTEMS.values():
        y = Preisach(h).simulate(np.random.default_rng(0).uniform(-185, 185, 200))
        assert SPAN / 10 < np.ptp(y) < SPAN * 10
