"""§6.2.4, §6.5.2: which states inputs reach, exactly and approximately.

Def. 6.3 and ℬⁿ, ℬ_r; Def. 6.6 and Theorem 6.4 as a construction, with the partition of erratum 10.
"""

import math

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from smarig.core.errors import UsageError
from smarig.theory.state_space.boundary import Boundary, anhysteretic, diagonal
from smarig.theory.state_space.input_signal import InputSignal
from smarig.theory.state_space.maps import G, G_inverse, H, H_left
from smarig.theory.state_space.operator_state import distance
from smarig.theory.state_space.reachability import reach, staircase
from smarig.theory.state_space.transition import transition
from theory.state_space.made import (
    BOUND,
    boundaries,
    curves,
    drawn_coarsely,
    monotone_pieces,
    reachable,
    sequences,
)

tolerances = st.sampled_from([20.0, 3.0, 0.3])


def from_zero_state(u: InputSignal) -> Boundary:
    """φ(τ, t₀, B*, u)."""
    return transition(u.end, u.times[0], anhysteretic(BOUND), u)


def edges_after_the_zero_state(boundary: Boundary) -> int:
    return sum(b0 == b1 or a0 == a1 for (b0, a0), (b1, a1) in zip(boundary.points, boundary.points[1:]))


@given(sequences())
def test_def_6_3_boundaries_of_n_edges_are_reached_by_n_monotone_moves(s):
    """ℬⁿ is reached exactly, n − 1 reversals after the start: n edges need n moves."""
    boundary = G(s)
    u = H(boundary, 0.0)
    assert from_zero_state(u) == boundary
    assert monotone_pieces(u) == edges_after_the_zero_state(boundary)


def test_def_6_3_counterexample_an_input_with_a_move_less_ends_elsewhere():
    boundary = G(G_inverse(H_left(InputSignal((0, 1, 2, 3), (0, 8, -5, 2)), 3, BOUND)))
    u = H(boundary, 0.0)
    assert from_zero_state(InputSignal(u.times[:-2], u.values[:-2])) != boundary


@given(curves(least=1), tolerances)
def test_def_6_3_the_whole_space_is_not_reachable(boundary, within):
    """A slope no input draws has no sequence; every approximation is at a distance from it."""
    assume(drawn_coarsely(boundary))
    try:
        G_inverse(boundary)
    except UsageError:
        assert distance(boundary, staircase(boundary, within)) > 0
    else:
        assert distance(from_zero_state(H(boundary, 0.0)), boundary) <= 1e-12 * BOUND**2


# --- Theorem 6.4 ---------------------------------------------------------------------------------------------


def check_theorem_6_4(reach_any, boundary: Boundary, within: float) -> None:
    """There is an admissible input with d(B, φ(τ, t₀, B*, u)) < ε (Def. 6.6)."""
    assert distance(boundary, from_zero_state(reach_any(boundary, within))) < within


@given(boundaries, tolerances)
def test_theorem_6_4_every_boundary_is_approximately_reachable(boundary, within):
    check_theorem_6_4(reach, boundary, within)


@settings(max_examples=10)
@given(curves(least=2), st.sampled_from([0.05, 0.01]))
def test_theorem_6_4_closely(boundary, within):
    check_theorem_6_4(reach, boundary, within)


def printed_partition(boundary: Boundary, within: float) -> InputSignal:
    """Theorem 6.4 as printed: steps on [−û, 0] only, B(β_i) on each."""
    n = math.ceil(BOUND**2 / within)
    heights = [boundary_at(boundary, -BOUND + (i + 0.5) * BOUND / n) for i in range(n)]
    ends = [-BOUND + i * BOUND / n for i in range(n + 1)]
    corners = [c for i, a in enumerate(heights) for c in ((ends[i], a), (min(ends[i + 1], a), a))]
    last = min(corners[-1])
    return H(Boundary(((-BOUND, BOUND), *_inside(corners), (last, last)), BOUND), 0.0)


def boundary_at(boundary: Boundary, beta: float) -> float:
    for (b0, a0), (b1, a1) in zip(boundary.points, boundary.points[1:]):
        if b0 <= beta < b1:
            return a0 + (beta - b0) / (b1 - b0) * (a1 - a0)
    return boundary.u


def _inside(corners):
    """Corners up to the diagonal: with u < 0 the printed partition runs past the end of the curve."""
    kept = []
    for beta, alpha in corners:
        if beta > alpha:
            break
        kept.append((beta, alpha))
    return kept


@pytest.mark.parametrize("centre", [3.0, 6.0])
def test_theorem_6_4_counterexample_erratum_10_the_printed_partition_misses_what_lies_right_of_zero(centre):
    goal = diagonal(BOUND, centre)
    check_theorem_6_4(reach, goal, 1.0)
    with pytest.raises(AssertionError):
        check_theorem_6_4(printed_partition, goal, 1.0)


def test_theorem_6_4_printed_partition_serves_boundaries_that_end_at_zero():
    """Where u = 0 print and construction agree: the failure above is the partition's alone."""
    goal = Boundary(((-10, 10), (-6, 7), (-2, 3), (0, 0)), BOUND)
    check_theorem_6_4(printed_partition, goal, 1.0)
    check_theorem_6_4(reach, goal, 1.0)


def test_theorem_6_4_counterexample_half_the_steps_come_half_as_near():
    """The steps are no more than needed: the same construction for twice the area breaks the promise."""
    goal = diagonal(BOUND, 5.0)
    with pytest.raises(AssertionError):
        check_theorem_6_4(lambda b, within: reach(b, 2.2 * within), goal, 0.5)


@given(reachable, tolerances)
def test_theorem_6_4_what_is_reachable_is_reached_exactly(boundary, within):
    assert staircase(boundary, within) == boundary


@given(boundaries, tolerances)
def test_theorem_6_4_more_steps_are_no_farther(boundary, within):
    near = distance(boundary, staircase(boundary, within / 4))
    assert near < within / 4


@pytest.mark.parametrize(
    ("within", "message"), [(0.0, "positive"), (float("nan"), "positive"), (1e-9, "reversals")]
)
def test_theorem_6_4_needs_a_tolerance_that_can_be_met(within, message):
    with pytest.raises(UsageError, match=message):
        reach(diagonal(BOUND, 2.0), within)
