"""§6.3.1: what an input leaves behind. (6.1), (6.2), (6.3), Def. 6.4, and infinite sequences cut short.

A fact beside the printed chapter: Definition 6.4 lets |s₂| ≥ |s₁|, which no input leaves behind and with
which Lemma 6.1 (1) fails.
"""

from itertools import count, pairwise

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from smarig.core.errors import UsageError
from smarig.theory.state_space import memory_sequence
from smarig.theory.state_space.input_signal import InputSignal
from smarig.theory.state_space.maps import F, G, H_left
from smarig.theory.state_space.memory_sequence import MemorySequence
from smarig.theory.state_space.operator_state import distance
from theory.state_space.made import BOUND, inputs, sequences, whole


def check_6_1(u: InputSignal, s) -> None:
    """(6.1) as a description: s₁ the last value of largest modulus, then extrema of what comes after, to the end."""
    v, at, size = u.values, -1, max(abs(x) for x in u.values)
    for i, element in enumerate(s):
        later = v[at + 1 :]
        if i == 0:
            assert abs(element) == size
        else:
            assert element == (min(later) if s[i - 1] > ([0.0, *s])[i - 1] else max(later))
        last = max(k for k in range(at + 1, len(v)) if v[k] == element)
        assert i > 0 or all(abs(x) < size for x in v[last + 1 :]), "attained again later"
        at = last
    assert at == len(v) - 1, "the sequence must end at the present input"


@given(inputs())
def test_eq_6_1_reduced_memory_sequence(u):
    check_6_1(u, F(u, u.end, BOUND).values)


def turning_points(u: InputSignal):
    """Every extremum, wiped out or not: the memory sequence before it is reduced."""
    v = [u.values[0], *(b for a, b in pairwise(u.values) if a != b)]
    return [b for a, b, c in zip(v, v[1:], v[2:]) if (b - a) * (c - b) < 0] + v[-1:]


@pytest.mark.parametrize(
    ("broken", "history"),
    [
        (turning_points, (3, 1, 5, 2)),
        (lambda u: F(u, u.end, BOUND).values[1:], (5, -3, 2)),
        (lambda u: F(u, u.end, BOUND).values[:-1], (5, -3, 2)),
        (lambda u: (5.0, -5.0, 2.0), (5, -5, 2)),
    ],
    ids=["nothing wiped out", "largest left out", "stops early", "first largest, not last"],
)
def test_eq_6_1_counterexample_sequences_that_are_not_reduced_are_detected(broken, history):
    u = InputSignal(range(len(history) + 1), (0, *history))
    with pytest.raises(AssertionError):
        check_6_1(u, tuple(broken(u)))


@given(inputs(least=1), st.floats(0, 1))
def test_eq_6_2_a_sequence_ends_at_the_present_input(u, share):
    tau = share * u.end
    assert F(u, tau, BOUND).limit == u(tau)


def test_eq_6_2_counterexample_a_sequence_of_another_time_ends_elsewhere():
    u = InputSignal((0, 1, 2), (0, 5, -3))
    assert F(u, 1.5, BOUND).limit == u(1.5) != F(u, 2, BOUND).limit


def last_change(s: MemorySequence, horizon: int = 30) -> int:
    """sup{i : s_{i−1} ≠ s_i}, read off the infinite sequence; 1 for the zero sequence (Table 6.2)."""
    return max([i for i in range(1, horizon) if s.at(i - 1) != s.at(i)], default=1)


@given(sequences())
def test_eq_6_3_N_is_where_a_sequence_stops_changing(s):
    assert last_change(s) == s.N


def test_eq_6_3_counterexample_the_length_as_written_is_not_N():
    written = (5.0, -3.0, -3.0, -3.0)
    assert (
        last_change(MemorySequence(written, BOUND)) == MemorySequence(written, BOUND).N == 2 != len(written)
    )


# --- Definition 6.4 -----------------------------------------------------------------------------------


def obeys_def_6_4(s, horizon: int = 30) -> bool:
    """Bounded; even and odd subsequences strictly monotone in opposite directions up to N(s); one limit."""
    values = [s[min(i, len(s)) - 1] for i in range(1, horizon)]
    odd, even = np.diff(s[0::2]), np.diff(s[1::2])
    falls = s[0] > s[1] if len(s) > 1 else True
    sign = -1.0 if falls else 1.0
    return bool(
        max(abs(x) for x in s) <= BOUND
        and np.all(sign * odd > 0)
        and np.all(sign * even < 0)
        and (len(s) < 3 or (values[-1] == values[-2] and min(s[:2]) < values[-1] < max(s[:2])))
        and all(min(s[i - 2 : i]) < x < max(s[i - 2 : i]) for i, x in enumerate(s) if i >= 2)
    )


@given(inputs())
def test_def_6_4_what_inputs_leave_behind_is_in_S(u):
    s = F(u, u.end, BOUND).values
    assert obeys_def_6_4(s)
    assert len(s) == 1 or abs(s[1]) < abs(s[0])


@pytest.mark.parametrize(
    "elements",
    [
        (5.0, -3.0, -4.0),
        (5.0, -3.0, 6.0),
        (5.0, 3.0, 2.0),
        (5.0, -3.0, 2.0, -3.0),
        (-5.0, 3.0, -5.0),
        (11.0,),
    ],
)
def test_def_6_4_counterexamples_are_refused(elements):
    assert not obeys_def_6_4(elements)
    with pytest.raises(UsageError, match="Memory sequence"):
        MemorySequence(elements, BOUND)


@given(sequences(), st.data())
def test_def_6_4_counterexample_any_element_moved_past_its_predecessors_is_refused(s, data):
    assume(s.N > 2)
    i = data.draw(st.integers(2, s.N - 1))
    moved = list(s.values)
    moved[i] = s.values[i - 2] + (s.values[i - 2] - s.values[i - 1])
    with pytest.raises(UsageError):
        MemorySequence(tuple(moved), 100.0)


@pytest.mark.parametrize("elements", [(1.0, -5.0), (-1.0, 1.0), (0.0, 2.0), (2.0, -3.0, 1.0)])
def test_def_6_4_as_printed_allows_what_no_input_leaves_behind(elements):
    """The printed definition does not restrict |s₂|: the sequence satisfies it, but its input leaves another
    one."""
    assert obeys_def_6_4(elements)
    left = F(InputSignal(range(len(elements) + 1), (0, *elements)), len(elements), BOUND).values
    assert left != elements
    with pytest.raises(UsageError, match="largest modulus"):
        MemorySequence(elements, BOUND)


def test_an_empty_sequence_is_refused():
    with pytest.raises(UsageError, match="at least one"):
        MemorySequence((), BOUND)


# --- infinite sequences ---------------------------------------------------------------------------------


def spiral(shares, start: float = 8.0):
    """An infinite sequence: s₁, then each element the next share of the way back to the one before last."""
    s, other = start, -0.99 * start
    for i in count():
        yield s
        s, other = s + shares[i % len(shares)] * (other - s), s


def left_out(shares, kept: int, within: float) -> tuple[float, MemorySequence]:
    """Area between a sequence cut early and the same one cut far later, and the early one."""
    early = MemorySequence.truncated(spiral(shares), BOUND, within)
    late = MemorySequence.truncated(spiral(shares), BOUND, within * kept)
    return distance(G(early), G(late)), early


@given(st.lists(st.floats(0.05, 0.95), min_size=1, max_size=5), st.floats(1e-3, 4.0))
def test_truncated_infinite_sequences_miss_no_more_than_their_bound(shares, within):
    area, early = left_out(shares, 1e-6, within)
    late = MemorySequence.truncated(spiral(shares), BOUND, within * 1e-6)
    assert early.remainder <= within
    assert area <= early.truncation_area * (1 + 1e-9)
    assert abs(early.limit - late.limit) <= early.remainder


def test_infinite_sequences_counterexample_half_the_area_is_not_enough():
    area, early = left_out([0.95, 0.05], 1e-6, 2.0)
    assert area > 0.5 * early.truncation_area


def test_infinite_sequence_that_does_not_converge_is_refused(monkeypatch):
    """Nested, but with two limits: condition 3 of Definition 6.4."""
    monkeypatch.setattr(memory_sequence, "MAX_ELEMENTS", 1000)
    with pytest.raises(UsageError, match="converges"):
        MemorySequence.truncated(((-1) ** i * (2 + 1 / (i + 1)) for i in count()), BOUND, 1e-3)


@pytest.mark.parametrize("within", [0.0, -1.0, float("nan")])
def test_infinite_sequence_is_cut_at_a_positive_difference_only(within):
    with pytest.raises(UsageError, match="positive"):
        MemorySequence.truncated([5.0, 3.0], BOUND, within)


def test_finite_sequence_passes_uncut():
    assert MemorySequence.truncated([5.0, -3.0, 2.0], BOUND, 1e-3) == MemorySequence((5.0, -3.0, 2.0), BOUND)


# --- inputs ------------------------------------------------------------------------------------------------


@given(inputs(of=whole), st.sampled_from([0.25, 0.5, 0.75]))
def test_inputs_between_knots_are_straight(u, share):
    for (t0, u0), (t1, u1) in pairwise(zip(u.times, u.values)):
        assert u(t0 + share * (t1 - t0)) == pytest.approx(u0 + share * (u1 - u0), abs=1e-12)
        assert min(u0, u1) <= u(t0 + share * (t1 - t0)) <= max(u0, u1)


@pytest.mark.parametrize(
    ("times", "moves", "message"),
    [
        ((), (), "one value per time"),
        ((0, 1), (0,), "one value per time"),
        ((0, 1, 1), (0, 2, 3), "increase strictly"),
        ((0, 1), (0, float("inf")), "not finite"),
        ((0, float("nan")), (0, 1), "not finite"),
    ],
)
def test_inputs_that_are_not_functions_of_time_are_refused(times, moves, message):
    with pytest.raises(UsageError, match=message):
        InputSignal(times, moves)


def test_inputs_outside_U_are_refused():
    with pytest.raises(UsageError, match="at rest"):
        F(InputSignal((0, 1), (2, 3)), 1, BOUND)
    with pytest.raises(UsageError, match="exceeds its bound"):
        H_left(InputSignal((0, 1), (0, 11)), 1, BOUND)
    with pytest.raises(UsageError, match="defined until"):
        InputSignal((0, 1), (0, 3))(1.5)
