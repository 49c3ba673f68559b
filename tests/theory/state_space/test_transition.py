"""§6.4: the state transition φ (6.8) against the operator, the relays and the sweep of the curve.

Def. 6.5 admissibility; (6.8); the sweep does not increase d, so it extends φ to all of ℬ.
"""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarig.core.errors import UsageError
from smarig.preisach.operator import Preisach
from smarig.theory.state_space.boundary import Boundary, anhysteretic, diagonal
from smarig.theory.state_space.input_signal import InputSignal
from smarig.theory.state_space.maps import G, H
from smarig.theory.state_space.operator_state import boundary_of, distance
from smarig.theory.state_space.read_out import is_up, read_out
from smarig.theory.state_space.transition import sweep, transition
from theory.state_space.made import (
    BOUND,
    boundaries,
    curves,
    drawn_by_relays,
    points_of_relays,
    reachable,
    sequences,
    values,
    whole,
)
from theory.state_space.made_transitions import DEEP, ONWARD, SOFT, forgetful

# --- Def. 6.5 ---------------------------------------------------------------------------------------------


def refuses(boundary: Boundary, start: float, slack: float = 1e-9 * BOUND) -> bool:
    try:
        H(boundary, 0.0).joined_with(InputSignal((0, 1), (start, 3)), slack)
    except UsageError:
        return True
    return False


@given(reachable, values)
def test_def_6_5_inputs_are_admissible_when_they_begin_where_the_state_stands(boundary, start):
    u = InputSignal((0, 1), (start, 3))
    assert refuses(boundary, start) == (abs(start - boundary.u) > 1e-9 * BOUND)
    if refuses(boundary, start):
        with pytest.raises(UsageError, match="not admissible"):
            transition(1, 0, boundary, u)


def test_def_6_5_counterexample_without_the_condition_inputs_could_jump():
    assert refuses(DEEP, -9.0)
    assert not refuses(DEEP, -9.0, slack=100.0)


@pytest.mark.parametrize(
    ("t1", "t0", "boundary", "u", "message"),
    [
        (0, 1, DEEP, ONWARD, "must not be before its start"),
        (9, 0, DEEP, ONWARD, "defined until"),
        (1, 0, diagonal(BOUND, 5), ONWARD, "no input generates"),
    ],
)
def test_eq_6_8_refuses_unreachable_states(t1, t0, boundary, u, message):
    with pytest.raises(UsageError, match=message):
        transition(t1, t0, boundary, u)


def test_inputs_join_only_where_the_first_ends():
    with pytest.raises(UsageError, match="cannot be joined"):
        ONWARD.joined_with(InputSignal((3, 5), (8, 0)))


# --- (6.8) against the operator, the relays, the sweep ---------------------------------------------------


def check_against_the_operator(phi, moves) -> None:
    op, state = Preisach(SOFT, "anhysteretic"), anhysteretic(185.0)
    for k, u in enumerate(moves):
        state = phi(k + 1, k, state, InputSignal((k, k + 1), (state.u, u)))
        assert read_out(state, SOFT) == pytest.approx(op.step(u), abs=1e-12 * 35)
        assert state == boundary_of(op.state, SOFT)


@given(st.lists(st.floats(-184.5, 184.5, width=32), min_size=1, max_size=12))
def test_eq_6_8_is_what_the_operator_does(moves):
    check_against_the_operator(transition, moves)


@pytest.mark.parametrize("phi", [forgetful, lambda t1, t0, b, u: sweep(b, 0.99 * u(t1))])
def test_eq_6_8_counterexample_other_transitions_are_not_the_operator(phi):
    with pytest.raises((AssertionError, UsageError)):
        check_against_the_operator(phi, [150.0, -120.0, 90.0, 100.0])


def check_against_relays(phi, moves) -> None:
    alpha, beta = points_of_relays()
    state = anhysteretic(BOUND)
    for k, u in enumerate(moves):
        state = phi(k + 1, k, state, InputSignal((k, k + 1), (state.u, u)))
        assert np.array_equal(is_up(state, alpha, beta), drawn_by_relays(moves[: k + 1]))


@given(st.lists(whole, min_size=1, max_size=8))
def test_eq_6_8_is_what_the_relays_do(moves):
    check_against_relays(transition, moves)


def test_eq_6_8_counterexample_a_forgetful_transition_is_not_the_relays():
    with pytest.raises((AssertionError, UsageError)):
        check_against_relays(forgetful, [8.0, -5.0, 4.0, 6.0])


@given(sequences(), st.lists(values, min_size=1, max_size=6))
def test_eq_6_8_is_the_sweep_of_the_curve(s, moves):
    by_phi = by_sweep = G(s)
    for k, u in enumerate(moves):
        by_phi = transition(k + 1, k, by_phi, InputSignal((k, k + 1), (by_phi.u, u)))
        by_sweep = sweep(by_sweep, u)
        assert distance(by_phi, by_sweep) <= 1e-12 * BOUND**2


def check_contraction(move, first, second, u) -> None:
    """d(φB₁, φB₂) ≤ d(B₁, B₂): relays that two states share, a move does not part."""
    assert distance(move(first, u), move(second, u)) <= distance(first, second) + 1e-12 * BOUND**2


@given(boundaries, curves(), values)
def test_a_sweep_never_parts_two_states(first, second, u):
    """So the sweep is the one continuous extension of φ from the reachable states to all of ℬ."""
    check_contraction(sweep, first, second, u)


def test_a_sweep_counterexample_a_move_that_starts_from_where_each_state_stands_parts_them():
    with pytest.raises(AssertionError):
        check_contraction(lambda b, u: sweep(b, -3 * b.u), diagonal(BOUND, 0.1), diagonal(BOUND, -0.1), 0.0)


@given(boundaries, values)
def test_a_sweep_ends_at_the_input_and_keeps_relays_it_does_not_pass(boundary, u):
    moved = sweep(boundary, u)
    assert moved.u == u
    alpha, beta = points_of_relays()
    before, after = is_up(boundary, alpha, beta), is_up(moved, alpha, beta)
    untouched = (alpha > u + 1e-9) & (beta < u - 1e-9)
    near = np.abs(alpha + beta - np.interp(beta - alpha, *_turned(boundary))) < 1e-9  # on B: rounding decides
    assert np.array_equal(before[untouched & ~near], after[untouched & ~near])
    assert after[alpha <= u].all()
    assert not after[beta > u].any()


def _turned(boundary: Boundary):
    return boundary.beta - boundary.alpha, boundary.beta + boundary.alpha


@pytest.mark.parametrize("u", [10.5, -11.0, float("nan")])
def test_a_sweep_beyond_the_bound_is_refused(u):
    with pytest.raises(UsageError, match="outside"):
        sweep(DEEP, u)
