"""States of the operator as boundaries and back: the same memory, so the same outputs for all future inputs.

The zero state of a one-sided actuator is its negative saturation (theory.md §1): same output, same future.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from smarig.core.errors import UsageError
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.operator import Preisach
from smarig.theory.state_space.boundary import Boundary, anhysteretic, diagonal
from smarig.theory.state_space.operator_state import boundary_of, distance, state_of
from smarig.theory.state_space.read_out import read_out
from smarig.theory.state_space.transition import sweep
from theory.state_space.made import reachable
from theory.state_space.made_operators import SYSTEMS, histories, initials, operator_after

SCALE = 35.0


def check_same_future(there_and_back, op: Preisach, onward) -> None:
    """An operator put into the state that came back gives the same outputs as the one that stayed."""
    other = Preisach(op.hysteresis, there_and_back(op.state, op.hysteresis))
    assert other.u == pytest.approx(op.u, abs=1e-9)
    for u in onward:
        assert other.step(u) == pytest.approx(op.step(u), abs=1e-11 * SCALE)


@settings(max_examples=120)
@given(st.sampled_from(sorted(SYSTEMS)), initials, histories, histories)
def test_state_to_boundary_to_state_keeps_the_future(name, initial, moves, onward):
    check_same_future(
        lambda s, h: state_of(boundary_of(s, h), h), operator_after(name, initial, moves), onward
    )


def test_state_to_boundary_to_state_counterexample_a_lost_extremum_shows_in_the_future():
    def lossy(state, h):
        boundary = boundary_of(state, h)
        return state_of(Boundary((*boundary.points[:2], (boundary.u, boundary.u)), boundary.bound), h)

    with pytest.raises((AssertionError, UsageError)):
        check_same_future(lossy, operator_after("surface", "negative", [150, -100, 80, -50, 40]), [90, -120])


@given(reachable)
def test_boundary_to_state_to_boundary_is_the_boundary(boundary):
    h = thesis_surface("two_e")
    big = Boundary(tuple((18.5 * b, 18.5 * a) for b, a in boundary.points), 185.0)
    state = state_of(big, h)
    assert distance(boundary_of(state, h), big) <= 1e-9
    assert state.y == pytest.approx(read_out(big, h), abs=1e-12 * SCALE)


@settings(max_examples=100)
@given(initials, histories)
def test_state_moves_as_its_boundary_is_swept(initial, moves):
    """From B_ℓ too, where (6.8) does not reach: the operator's memory is the swept curve, move by move."""
    h = SYSTEMS["surface"]
    op = operator_after("surface", initial, [])
    boundary = boundary_of(op.state, h)
    for u in np.clip(moves, -185, 185).tolist():
        op.step(u)
        boundary = sweep(boundary, u)
        assert distance(boundary_of(op.state, h), boundary) <= 1e-6


def test_state_counterexample_a_boundary_swept_to_another_input_is_not_the_memory():
    op = operator_after("surface", 20.0, [90.0, -30.0])
    wrong = sweep(sweep(diagonal(185.0, 20.0), 91.0), -30.0)
    assert distance(boundary_of(op.state, op.hysteresis), wrong) > 1.0


@given(st.floats(-185, 185, width=32))
def test_diagonal_state_to_boundary_and_back(centre):
    op = operator_after("surface", centre, [])
    boundary = boundary_of(op.state, op.hysteresis)
    assert boundary == diagonal(185.0, centre)
    assert state_of(boundary, op.hysteresis).y == pytest.approx(op.y, abs=1e-11 * SCALE)


@pytest.mark.parametrize("name", ["one_c", "one_p", "one_e"])
def test_one_sided_zero_state_is_negative_saturation(name):
    h = thesis_surface(name)
    cold = boundary_of(Preisach(h).state, h)
    rest = anhysteretic(h.upper)
    assert distance(cold, rest) > 1.0, "different curves, but only where there are no relays"
    assert read_out(rest, h) == read_out(cold, h) == h.y_lower
    futures = [
        Preisach(h, state_of(b, h)).simulate([90.0, 30.0, 60.0, 10.0], state_of(b, h)) for b in (cold, rest)
    ]
    assert np.allclose(*futures, rtol=0, atol=1e-12 * h.y_upper)


def test_two_sided_zero_state_counterexample_is_not_negative_saturation():
    h = thesis_surface("two_c")
    assert read_out(anhysteretic(185.0), h) - h.y_lower > 10


def test_states_of_slopes_no_input_draws_are_refused():
    with pytest.raises(UsageError, match="no input generates"):
        state_of(Boundary(((-185, 185), (-150, 40), (10, 10)), 185.0), thesis_surface("two_c"))
    # Slope −1, but not where a diagonal state begins.
    with pytest.raises(UsageError, match="no input generates"):
        state_of(
            Boundary(((-185, 185), (-185, 100), (-100, 100), (-50, 50), (50, 50)), 185.0),
            thesis_surface("two_c"),
        )
    with pytest.raises(UsageError, match="û = 185"):
        state_of(anhysteretic(50.0), thesis_surface("two_c"))
