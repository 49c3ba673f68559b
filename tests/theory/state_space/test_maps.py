"""§6.3: the maps between inputs, sequences and boundaries, each law with something that breaks it.

(6.4) as corrected by erratum 2, (6.5), Lemma 6.1 (1)–(4) with (6.6), G and its corners (erratum 10),
G G⁻¹ = G⁻¹ G = I, Ra(G), Lemma 6.2 (1)–(3) with (6.7).
"""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from smarig.core.errors import UsageError
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.operator import Preisach
from smarig.theory import state_space
from smarig.theory.state_space.boundary import Boundary, diagonal
from smarig.theory.state_space.input_signal import InputSignal
from smarig.theory.state_space.maps import F, F_right, G, G_inverse, H, H_left, partition_weights
from smarig.theory.state_space.memory_sequence import MemorySequence
from smarig.theory.state_space.read_out import is_up
from theory.state_space.made import (
    BOUND,
    curves,
    drawn_by_relays,
    inputs,
    points_of_relays,
    reachable,
    sequences,
    whole,
)

shares = st.sampled_from([0.0, 0.2, 0.5, 0.8, 1.0])


# --- Fʳ: (6.4), (6.5) -----------------------------------------------------------------------------------


def check_partition(weights) -> None:
    """(6.4): positive shares of [t₀, τ] that fill it in the limit; what is left after i falls as 1/i."""
    for n in (1, 10, 1000, 100_000):
        shares = weights(n)
        assert np.all(shares > 0)
        assert 0 < 1 - np.sum(shares) <= 1.0 / n


def test_eq_6_4_corrected_partition_fills_the_interval():
    check_partition(partition_weights)


def test_eq_6_4_counterexample_the_printed_partition_stops_at_pi_squared_over_12():
    def printed(n):
        return 0.5 / np.arange(1.0, n + 1) ** 2

    assert np.sum(printed(10**6)) == pytest.approx(math.pi**2 / 12, abs=1e-6)
    with pytest.raises(AssertionError):
        check_partition(printed)


def check_6_5(s: MemorySequence, u: InputSignal, start: float, tau: float) -> None:
    """(6.5): 0 until t₀, through the elements in order by straight lines, and u(τ) = lim s_i."""
    assert u(start - 1.0) == u(start) == 0
    assert u.times[0] == start
    assert u.end == tau
    assert u(tau) == s.limit
    assert u.values[1 : s.N + 1] == s.values
    for i in range(1, s.N + 1):
        (t0, t1), middle = u.times[i - 1 : i + 1], 0.5 * (s.at(i - 1) + s.at(i))
        assert u(0.5 * (t0 + t1)) == pytest.approx(middle, abs=1e-9)


@given(sequences(), st.integers(-5, 5), st.sampled_from([0.5, 1.0, 8.0]))
def test_eq_6_5_input_through_a_sequence(s, tau, span):
    check_6_5(s, F_right(s, tau, tau - span), tau - span, tau)


def test_eq_6_5_counterexample_other_inputs_are_detected():
    s = MemorySequence((5.0, -3.0, 2.0), BOUND)
    right = F_right(s, 1.0, 0.0)
    swapped = InputSignal(right.times, (0.0, -3.0, 5.0, 2.0, 2.0))
    early = right.until(0.9)
    for wrong in (swapped, early, right.shifted(0.5)):
        with pytest.raises(AssertionError):
            check_6_5(s, wrong, 0.0, 1.0)


@pytest.mark.parametrize("tau", [0.0, -3.0, 1e12, -1e12])
def test_eq_6_5_holds_for_long_sequences_at_any_time(tau):
    spiral = [9.0 * (-1) ** i * 0.999**i for i in range(3000)]
    s = MemorySequence(tuple(spiral), BOUND)
    assert F(F_right(s, tau), tau, BOUND) == s


def test_F_right_needs_time():
    with pytest.raises(UsageError, match="start before"):
        F_right(MemorySequence((1.0,), BOUND), 0.0, 0.0)


# --- Lemma 6.1 --------------------------------------------------------------------------------------------


def F_right_swapped(s: MemorySequence, tau: float) -> InputSignal:
    """Broken: the first two elements the other way round."""
    order = (s.at(2), s.at(1), *s.values[2:])
    return InputSignal(tuple(tau - len(order) + i for i in range(len(order) + 1)), (0.0, *order))


def F_first(u: InputSignal, tau: float, bound: float) -> MemorySequence:
    """Broken: keeps the first three elements only."""
    return MemorySequence((*F(u, tau, bound).values[:3], u(tau)), bound)


def F_peeking(u: InputSignal, tau: float, bound: float) -> MemorySequence:
    """Broken: looks at the input after τ."""
    return F(u, u.end, bound)


def check_right_inverse(F_any, F_right_any, s: MemorySequence, tau: float) -> None:
    assert F_any(F_right_any(s, tau), tau, BOUND) == s


@given(sequences(), st.integers(-4, 4))
def test_lemma_6_1_property_1_right_inverse(s, tau):
    check_right_inverse(F, F_right, s, tau)


@pytest.mark.parametrize(("F_any", "F_right_any"), [(F, F_right_swapped), (F_peeking, F_right_swapped)])
def test_lemma_6_1_property_1_counterexamples(F_any, F_right_any):
    with pytest.raises(AssertionError):
        check_right_inverse(F_any, F_right_any, MemorySequence((5.0, -3.0, 2.0, -1.0), BOUND), 0.0)


def check_deterministic(map_any, u: InputSignal, other: InputSignal, share: float) -> None:
    """The same input until τ, anything after it: the same value of the map at τ."""
    tau = share * u.end
    same = u.until(tau)
    changed = InputSignal((*same.times, tau + 1, tau + 2), (*same.values, *(other.values * 2)[:2]))
    assert map_any(u, tau, BOUND) == map_any(changed, tau, BOUND)


@given(inputs(least=1), inputs(least=1), shares)
def test_lemma_6_1_property_2_deterministic(u, other, share):
    check_deterministic(F, u, other, share)


def test_lemma_6_1_property_2_counterexample_a_map_that_sees_the_future():
    with pytest.raises(AssertionError):
        check_deterministic(F_peeking, InputSignal((0, 1, 2), (0, 5, -9)), InputSignal((0, 1), (0, 3)), 0.5)


def check_continuity(F_right_any, u: InputSignal, share: float) -> None:
    tau = share * u.end
    F_right_any(F(u, tau, BOUND), tau).joined_with(u.between(tau, u.end))


@given(inputs(least=1), shares)
def test_lemma_6_1_property_3_the_joined_input_is_continuous(u, share):
    check_continuity(F_right, u, share)


def test_lemma_6_1_property_3_counterexample_an_inverse_that_ends_one_element_early():
    def early(s: MemorySequence, tau: float) -> InputSignal:
        return F_right(MemorySequence(s.values[:-1] or (0.0,), s.bound), tau)

    with pytest.raises(UsageError, match="not admissible"):
        check_continuity(early, InputSignal((0, 1, 2, 3), (0, 5, -3, 4)), 0.5)


def check_6_6(F_any, u: InputSignal, share: float) -> None:
    """F_T[(F_τʳ F_τ u) ◇ u_(τ,T]] = F_T u (6.6)."""
    tau = share * u.end
    joined = F_right(F_any(u, tau, BOUND), tau).joined_with(u.between(tau, u.end))
    assert F(joined, u.end, BOUND) == F(u, u.end, BOUND)


@given(inputs(least=1), shares)
def test_lemma_6_1_property_4_eq_6_6(u, share):
    check_6_6(F, u, share)


def test_lemma_6_1_property_4_counterexample_a_memory_of_three_extrema_is_too_short():
    """Wiped out down to what was not kept: the difference shows only later."""
    u = InputSignal(range(8), (0, 9, -8, 7, -6, 5, 4, 4.5))
    check_6_6(F, u, 6 / 7)
    with pytest.raises(AssertionError):
        check_6_6(F_first, u, 6 / 7)


# --- G and G⁻¹ -----------------------------------------------------------------------------------------------


def corners_as_printed(s: MemorySequence, *, from_N: bool = False) -> list[tuple[float, float]]:
    """p₀ … p_{N+1}, element by element as §6.3 has them; ``from_N``: p_i = (u, u) already for i = N."""
    points = [(-s.bound, s.bound), (-abs(s.at(1)), abs(s.at(1)))]
    for i in range(2, s.N + 2):
        here, before = s.at(i), s.at(i - 1)
        end = i > s.N or (from_N and i == s.N)
        points.append((s.limit, s.limit) if end else (here, before) if here < before else (before, here))
    return points


@given(sequences())
def test_G_has_the_corners_of_the_thesis(s):
    assert G(s) == Boundary(tuple(corners_as_printed(s)), BOUND)


@pytest.mark.parametrize("elements", [(5.0, -3.0, 2.0), (-5.0, 3.0, -2.0, 1.0)])
def test_G_counterexample_erratum_10_p_N_is_a_corner_and_not_the_end(elements):
    """As printed the last step is cut off: what is drawn slopes, and its relays are not those of the input."""
    s = MemorySequence(elements, BOUND)
    printed = Boundary(tuple(corners_as_printed(s, from_N=True)), BOUND)
    assert printed != G(s)
    with pytest.raises(UsageError, match="no input generates"):
        G_inverse(printed)


def test_G_counterexample_corners_in_the_other_order_are_no_boundary():
    """(s_{i−1}, s_i) where (s_i, s_{i−1}) belongs lies outside the triangle."""
    wrong = [(alpha, beta) for beta, alpha in corners_as_printed(MemorySequence((5.0, -3.0, 2.0), BOUND))]
    with pytest.raises(UsageError, match="BP1"):
        Boundary(tuple(wrong), BOUND)


def check_against_relays(G_any, moves) -> None:
    """The boundary of an input separates the relays it leaves up from the others, relay by relay."""
    u = InputSignal(range(len(moves) + 1), (0.0, *moves))
    alpha, beta = points_of_relays()
    assert np.array_equal(is_up(G_any(F(u, u.end, BOUND)), alpha, beta), drawn_by_relays(moves))


@given(st.lists(whole, max_size=12))
def test_G_separates_the_relays(moves):
    check_against_relays(G, moves)


def test_G_counterexample_a_forgotten_corner_leaves_relays_on_the_wrong_side():
    with pytest.raises(AssertionError):
        check_against_relays(lambda s: G(MemorySequence(s.values[:1] + s.values[-1:], BOUND)), [8, -5, 4, 1])


def check_inverses(G_any, G_inverse_any, s: MemorySequence) -> None:
    assert G_inverse_any(G_any(s)) == s
    assert G_any(G_inverse_any(G_any(s))) == G_any(s)


@given(sequences())
def test_G_and_its_inverse_are_inverses(s):
    check_inverses(G, G_inverse, s)


def test_G_counterexample_inverse_that_reads_the_other_coordinate():
    """Corners printed as (α_i, β_i) and read as (β_i, α_i): the other member of every pair."""

    def other(boundary: Boundary) -> MemorySequence:
        turned = tuple((-alpha, -beta) for beta, alpha in boundary.points)
        return G_inverse(Boundary(turned, boundary.bound))

    with pytest.raises(AssertionError):
        check_inverses(G, other, MemorySequence((5.0, -3.0, 2.0), BOUND))


@given(curves(least=1))
def test_range_of_G_is_staircases_that_leave_the_zero_state_once(boundary):
    """A curve with any other slope has no sequence and is refused."""
    points = boundary.points
    edges = list(zip(points, points[1:]))
    level = [b0 == b1 or a0 == a1 for (b0, a0), (b1, a1) in edges]
    assume(not math.isclose(sum(points[1]), 0.0, abs_tol=1e-9))  # no part of B*
    if all(level):
        assert G(G_inverse(boundary)) == boundary
    else:
        with pytest.raises(UsageError, match="no input generates"):
            G_inverse(boundary)


@pytest.mark.parametrize("centre", [-4.0, 3.0])
def test_range_of_G_counterexample_a_slope_of_minus_one_elsewhere_does_not_pass_for_the_zero_state(centre):
    with pytest.raises(UsageError, match="no input generates"):
        G_inverse(diagonal(BOUND, centre))


# --- Lemma 6.2 ------------------------------------------------------------------------------------------------


@given(reachable, st.integers(-4, 4))
def test_lemma_6_2_property_1_left_inverse(boundary, tau):
    assert H_left(H(boundary, tau), tau, BOUND) == boundary


def test_lemma_6_2_property_1_counterexample_H_is_no_left_inverse_of_H_left():
    """The other way round fails: many inputs have one boundary."""
    u = InputSignal((0, 1, 2, 3), (0, 5, -3, 2))
    assert H(H_left(u, 3, BOUND), 3) != u


def H_left_peeking(u: InputSignal, tau: float, bound: float) -> Boundary:
    return G(F_peeking(u, tau, bound))


@given(inputs(least=1), inputs(least=1), shares)
def test_lemma_6_2_property_2_deterministic(u, other, share):
    check_deterministic(H_left, u, other, share)


def test_lemma_6_2_property_2_counterexample_a_map_that_sees_the_future():
    with pytest.raises(AssertionError):
        check_deterministic(
            H_left_peeking, InputSignal((0, 1, 2), (0, 5, -9)), InputSignal((0, 1), (0, 3)), 0.5
        )


def check_6_7(H_left_any, u: InputSignal, share: float) -> None:
    """H_Tˡ[(H_τ H_τˡ u) ◇ u_(τ,T]] = H_Tˡ u (6.7)."""
    tau = share * u.end
    joined = H(H_left_any(u, tau, BOUND), tau).joined_with(u.between(tau, u.end))
    assert H_left(joined, u.end, BOUND) == H_left(u, u.end, BOUND)


@given(inputs(least=1), shares)
def test_lemma_6_2_property_3_eq_6_7(u, share):
    check_6_7(H_left, u, share)


def test_lemma_6_2_property_3_counterexample_a_boundary_that_forgot_a_corner():
    u = InputSignal(range(8), (0, 9, -8, 7, -6, 5, 4, 4.5))
    with pytest.raises(AssertionError):
        check_6_7(lambda u, tau, bound: G(F_first(u, tau, bound)), u, 6 / 7)


def test_the_package_offers_the_maps_by_name():
    """``__all__`` is the public chapter 6: each name resolves, and the way u → s → B → y runs on them alone."""
    assert all(hasattr(state_space, name) for name in state_space.__all__)
    u = state_space.InputSignal((0, 1, 2), (0, 60, -20))
    drawn = state_space.G(state_space.F(u, 2.0, bound=185.0))
    assert drawn == state_space.H_left(u, 2.0, bound=185.0)
    wire = Preisach(thesis_surface("two_c"), "anhysteretic")
    wire.simulate([60.0, -20.0], "anhysteretic")
    assert state_space.boundary_of(wire.state, wire.hysteresis) == drawn
    assert state_space.read_out(drawn, wire.hysteresis) == pytest.approx(wire.y, abs=1e-9)
    assert state_space.distance(drawn, state_space.anhysteretic(185.0)) > 0
