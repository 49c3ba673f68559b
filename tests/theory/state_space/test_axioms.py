"""§6.1: the axioms of a dynamical system (Def. 6.1) for 𝒰, φ (6.8) and r.

1 shift of inputs, 2 outputs, 4a consistency, 4b determinism, 4c semi-group, 4d stationarity, 5 read-out
without memory, 6 outputs are restrictions (3, the state space, is Def. 6.2: ``test_boundaries``).
Each law is a check that is passed by φ and failed by a map made to break it.
"""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from smarig.core.errors import UsageError
from smarig.preisach.hysteresis.relay_measure import RelayMeasure
from smarig.preisach.operator import Preisach
from smarig.theory.state_space.boundary import Boundary
from smarig.theory.state_space.input_signal import InputSignal
from smarig.theory.state_space.maps import H_left
from smarig.theory.state_space.read_out import read_out
from smarig.theory.state_space.transition import sweep, transition
from theory.state_space.made import (
    BOUND,
    inputs,
    reachable,
    values,
)
from theory.state_space.made_transitions import DEEP, ONWARD, SOFT, forgetful

shares = st.sampled_from([0.0, 0.25, 0.5, 1.0])


@st.composite
def admissible(draw, least: int = 1) -> tuple[Boundary, InputSignal]:
    """A reachable state at t = 0 and an input that begins where it stands (Def. 6.5)."""
    boundary, u = draw(reachable), draw(inputs(least=least))
    return boundary, InputSignal(u.times, (boundary.u, *u.values[1:]))


# --- maps made to break a law ---------------------------------------------------------------------------


def peeking(t1, t0, boundary, u):
    """Takes a little of what comes after t₁."""
    return sweep(transition(t1, t0, boundary, u), u(min(t1 + 0.5, u.end)))


def ageing(t1, t0, boundary, u):
    """After t = 2 the clock itself moves the state."""
    moved = transition(t1, t0, boundary, u)
    return moved if t1 <= 2 else sweep(moved, 0.9 * moved.u)


# --- Def. 6.1, axiom by axiom ------------------------------------------------------------------------------


def check_shift(u: InputSignal, T: float, shift) -> None:
    """Axiom 1: σ_T u(t) = u(t + T) belongs to 𝒰 again."""
    moved = shift(u, T)
    assert all(moved(t - T) == u(t) for t in u.times)
    assert moved.times[-1] == u.times[-1] - T
    assert H_left(moved, moved.end, BOUND) == H_left(u, u.end, BOUND)


@given(inputs(), st.integers(-20, 20))
def test_def_6_1_axiom_1_inputs_are_closed_under_shift(u, T):
    check_shift(u, T, InputSignal.shifted)


def test_def_6_1_axiom_1_counterexample_a_shift_the_wrong_way():
    with pytest.raises((AssertionError, UsageError)):
        check_shift(InputSignal((0, 1, 2), (0, 5, -3)), 1.0, lambda u, T: u.shifted(-T))


def largest_jump(hysteresis, moves, parts: int) -> float:
    """Largest change of the output between neighbours when every move is cut into equal parts."""
    op = Preisach(hysteresis)
    ends = np.r_[hysteresis.lower, moves]
    fine = np.concatenate([np.linspace(a, b, parts + 1)[1:] for a, b in zip(ends, ends[1:])])
    return float(np.max(np.abs(np.diff([op.y, *(op.step(u) for u in fine)]))))


def steepest_strip(grid: int = 200) -> float:
    """Largest output change per kelvin, over the whole triangle: C of Lemma 4.2, reversible part included."""
    a, b = np.meshgrid(*[np.linspace(-185.0, 185.0, grid)] * 2, indexing="ij")
    strips = np.stack([SOFT.strip_alpha(a, b), SOFT.strip_beta(a, b)])
    return 1.01 * float(np.max(np.abs(strips[:, a >= b])))


@settings(max_examples=20)
@given(st.lists(st.floats(-185, 185, width=32), min_size=1, max_size=5))
def test_def_6_1_axiom_2_outputs_are_continuous_for_a_density(moves):
    """𝒴 ⊂ C⁰ (Thm 4.3): jumps fall in proportion to the steps of the input."""
    assert largest_jump(SOFT, moves, 64) <= steepest_strip() * 370 / 64


def test_def_6_1_axiom_2_counterexample_single_relays_jump_however_fine_the_steps():
    relays = RelayMeasure.from_arrays([40.0, 185.0], [-30.0, -185.0], [50.0, 1.0])
    assert largest_jump(relays, [100.0, -100.0], 64) > steepest_strip() * 370 / 64
    assert largest_jump(relays, [100.0, -100.0], 4096) == 100.0


def check_consistency(phi, boundary, u) -> None:
    assert phi(0.0, 0.0, boundary, u) == boundary


@given(admissible())
def test_def_6_1_axiom_4a_consistency(case):
    check_consistency(transition, *case)


@pytest.mark.parametrize("phi", [forgetful, peeking])
def test_def_6_1_axiom_4a_counterexamples(phi):
    with pytest.raises(AssertionError):
        check_consistency(phi, DEEP, ONWARD)


def check_determinism(phi, boundary, u, other, share) -> None:
    """Inputs that agree on [t₀, t₁] and not elsewhere lead to one state at t₁."""
    t1 = share * u.end
    piece = u.between(0.0, t1)
    changed = InputSignal((-1.0, *piece.times, t1 + 1), (other, *piece.values, other))
    assert phi(t1, 0.0, boundary, u) == phi(t1, 0.0, boundary, changed)


@given(admissible(), values, shares)
def test_def_6_1_axiom_4b_determinism(case, other, share):
    check_determinism(transition, *case, other, share)


def test_def_6_1_axiom_4b_counterexample():
    with pytest.raises(AssertionError):
        check_determinism(peeking, DEEP, ONWARD, 3.0, 0.5)


def check_semi_group(phi, boundary, u, share, further) -> None:
    t1 = share * u.end
    t2 = t1 + further * (u.end - t1)
    by_way = phi(t2, t1, phi(t1, 0.0, boundary, u), u)
    assert by_way == phi(t2, 0.0, boundary, u)


@given(admissible(), shares, shares)
def test_def_6_1_axiom_4c_semi_group(case, share, further):
    check_semi_group(transition, *case, share, further)


@pytest.mark.parametrize("phi", [forgetful, peeking])
def test_def_6_1_axiom_4c_counterexamples(phi):
    with pytest.raises((AssertionError, UsageError)):
        check_semi_group(phi, DEEP, ONWARD, 0.25, 1 / 3)


def check_stationarity(phi, boundary, u, T) -> None:
    assert phi(u.end + T, T, boundary, u.shifted(-T)) == phi(u.end, 0.0, boundary, u)


@given(admissible(), st.integers(-30, 30))
def test_def_6_1_axiom_4d_stationarity(case, T):
    """φ(t₁ + T, t₀ + T, B₀, σ₋_T u) = φ(t₁, t₀, B₀, u): print shifts u by +T under σ_T u(t) = u(t + T)."""
    check_stationarity(transition, *case, T)


def test_def_6_1_axiom_4d_counterexample():
    with pytest.raises(AssertionError):
        check_stationarity(ageing, DEEP, ONWARD.between(0, 1), 10)


def test_def_6_1_axiom_4d_with_the_printed_sign_of_the_shift_concerns_another_input():
    """σ_T as defined moves the input by −T: at t₀ + T it is 2T late, and in general not admissible."""
    with pytest.raises(UsageError):
        transition(2.0, 1.0, DEEP, ONWARD.between(0, 1).shifted(1))


def check_memoryless(output_of, one: InputSignal, other: InputSignal) -> None:
    """Axiom 5: histories with one boundary have one output."""
    assert H_left(one, one.end, 185.0) == H_left(other, other.end, 185.0), "the histories must share a state"
    assert output_of(one) == output_of(other)


def by_read_out(u: InputSignal) -> float:
    return read_out(H_left(u, u.end, 185.0), SOFT)


def accommodating(u: InputSignal) -> float:
    """A read-out that counts reversals, as accommodation would (§3.5)."""
    return by_read_out(u) + 0.01 * len(u.values)


@st.composite
def with_a_loop(draw) -> tuple[InputSignal, InputSignal]:
    """An input, and the same with a loop inside one of its moves that closes again."""
    moves = draw(st.lists(st.floats(-185, 185, width=32), min_size=1, max_size=6))
    i = draw(st.integers(0, len(moves) - 1))
    start, end = ([0.0, *moves])[i], moves[i]
    a, b = sorted(draw(st.tuples(st.floats(0, 1), st.floats(0, 1))))
    loop = [start + b * (end - start), start + a * (end - start)]
    more = [*moves[:i], *loop, *moves[i:]]
    return tuple(InputSignal(range(len(m) + 1), (0.0, *m)) for m in (moves, more))


@given(with_a_loop())
def test_def_6_1_axiom_5_read_out_has_no_memory(pair):
    check_memoryless(by_read_out, *pair)


def test_def_6_1_axiom_5_counterexample_a_read_out_that_counts_reversals():
    pair = InputSignal((0, 1), (0, 100)), InputSignal((0, 1, 2, 3), (0, 50, 20, 100))
    with pytest.raises(AssertionError):
        check_memoryless(accommodating, *pair)


def check_restriction(phi, moves, since: int) -> None:
    """Axiom 6: outputs along φ from a state are those of one output function of the whole input."""
    u = InputSignal(range(len(moves) + 1), (0.0, *moves))
    whole_output = Preisach(SOFT).simulate(moves, "anhysteretic")
    state = H_left(u, since, 185.0)
    along = [read_out(phi(t, since, state, u), SOFT) for t in range(since + 1, len(moves) + 1)]
    assert along == pytest.approx(whole_output[since:], abs=1e-12 * 35)


@given(st.lists(st.floats(-184, 184, width=32), min_size=2, max_size=8), st.integers(1, 7))
def test_def_6_1_axiom_6_outputs_are_restrictions(moves, since):
    assume(since < len(moves))
    check_restriction(transition, moves, since)


def test_def_6_1_axiom_6_counterexample():
    with pytest.raises(AssertionError):
        check_restriction(forgetful, [150, -120, 90, -60, 100, -140], 4)
