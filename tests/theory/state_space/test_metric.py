"""§6.5: turned boundaries, the area metric, boundedness and completeness.

Claim 6.3 (B̃P1)–(B̃P3), (6.10), §6.5.1 metric axioms and (6.11), 'not a linear space', Def. 6.7 with the
bound 2û² (§6.5.3), Def. 6.8 and 6.9, Def. 6.10 with Lemma 6.5, what Thm 6.6 (Arzelà–Ascoli) is used for,
Thm 6.7. Area is checked against relays of unit density, counted one by one.
"""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from smarig.core.errors import UsageError
from smarig.theory.state_space.boundary import Boundary, RotatedBoundary, anhysteretic, diagonal, rotated
from smarig.theory.state_space.input_signal import InputSignal
from smarig.theory.state_space.maps import G_inverse, H_left
from smarig.theory.state_space.operator_state import distance, rotated_distance
from smarig.theory.state_space.reachability import staircase
from theory.state_space.made import BOUND, area_relays, boundaries, drawn_by_relays, drawn_coarsely, whole

ROOT = math.sqrt(2)
ROUNDING = 1e-12 * BOUND**2
X = np.linspace(-ROOT * BOUND, 0.0, 501)


# --- Claim 6.3 ---------------------------------------------------------------------------------------------


def check_claim_6_3(turned) -> None:
    """(B̃P1), (B̃P2), (B̃P3) on a grid."""
    h = turned(X)
    assert np.all(np.abs(h) <= ROOT * BOUND + X + 1e-12), "B̃P1"
    assert abs(h[0]) <= 1e-12, "B̃P2"
    assert np.all(np.abs(np.diff(h)) <= np.diff(X) + 1e-12), "B̃P3"


@given(boundaries)
def test_claim_6_3_turned_boundaries_are_lipschitz_functions(boundary):
    check_claim_6_3(rotated(boundary))


@pytest.mark.parametrize(
    ("broken", "turned"),
    [
        ("B̃P1", lambda x: 1.1 * (x + ROOT * BOUND)),
        ("B̃P2", lambda x: 0.0 * x + 0.5),
        ("B̃P3", lambda x: np.sin(2 * (x + ROOT * BOUND))),
    ],
)
def test_claim_6_3_counterexamples_are_refused(broken, turned):
    with pytest.raises(AssertionError):
        check_claim_6_3(turned)
    with pytest.raises(UsageError, match=r"B̃P|spans"):
        RotatedBoundary(X, np.asarray(turned(X)), BOUND)


def test_claim_6_3_counterexample_a_curve_that_increases_turns_into_one_steeper_than_1():
    """Figure 6.8."""
    points = np.array([(-10, 10), (-8, 2), (-3, 5), (3, 3)], dtype=float)
    x, h = (points[:, 0] - points[:, 1]) / ROOT, (points[:, 0] + points[:, 1]) / ROOT
    with pytest.raises(UsageError, match="B̃P3"):
        RotatedBoundary(x, h, BOUND)


@pytest.mark.parametrize(
    ("x", "h", "message"),
    [
        ([-ROOT * BOUND, -5.0, -6.0, 0.0], [0, 0, 0, 0], "strictly rising"),
        ([-ROOT * BOUND, 0.0], [0, 0, 0], "one ordinate per abscissa"),
        ([-ROOT * BOUND, -1.0], [0, 0], "must span"),
    ],
)
def test_claim_6_3_what_is_not_a_function_on_the_interval_is_refused(x, h, message):
    with pytest.raises(UsageError, match=message):
        RotatedBoundary(np.array(x), np.array(h, dtype=float), BOUND)


def check_6_10(turn, turn_back, boundary: Boundary) -> None:
    """R⁻¹R = I: the same curve, its level and upright edges level and upright again."""
    again = turn_back(turn(boundary))
    assert distance(again, boundary) <= ROUNDING
    edges = [
        sum(p[0] == q[0] or p[1] == q[1] for p, q in zip(b.points, b.points[1:])) for b in (boundary, again)
    ]
    assert edges[0] == edges[1]


@given(boundaries)
def test_eq_6_10_turning_back(boundary):
    assume(drawn_coarsely(boundary))
    check_6_10(rotated, RotatedBoundary.unrotated, boundary)


def test_eq_6_10_counterexample_turning_the_other_way():
    def reflected(boundary: Boundary) -> RotatedBoundary:
        turned = rotated(boundary)
        return RotatedBoundary(turned.abscissa, -turned.ordinate, turned.bound)

    with pytest.raises(AssertionError):
        check_6_10(reflected, RotatedBoundary.unrotated, diagonal(BOUND, 3.0))


@given(boundaries, st.floats(1.1, 5))
def test_turned_boundaries_are_no_linear_space(boundary, factor):
    """§6.5.1: a multiple beyond ±1 leaves the space as soon as an edge is level or upright."""
    turned = rotated(boundary)
    steepest = np.max(np.abs(np.diff(turned.ordinate) / np.diff(turned.abscissa)))
    assume(np.min(np.diff(turned.abscissa)) > 1e-6)
    if factor * steepest > 1.0 + 1e-6:
        assume((factor * steepest - 1) * np.min(np.diff(turned.abscissa)) > 1e-6)
        with pytest.raises(UsageError, match="B̃P3"):
            RotatedBoundary(turned.abscissa, factor * turned.ordinate, BOUND)
    else:
        RotatedBoundary(turned.abscissa, factor * turned.ordinate, BOUND)


def test_turned_boundaries_counterexample_the_zero_element_alone_can_be_multiplied():
    zero = rotated(anhysteretic(BOUND))
    assert rotated_distance(RotatedBoundary(zero.abscissa, 100 * zero.ordinate, BOUND), zero) == 0


# --- the metric ----------------------------------------------------------------------------------------------


def check_metric(d, a, b, c) -> None:
    """Not negative, zero exactly for equal states, symmetric, and no way round is shorter."""
    assert d(a, b) >= 0
    assert d(a, a) == 0
    assert d(a, b) > 0 or np.max(np.abs(rotated(a)(X) - rotated(b)(X))) <= 1e-6
    assert d(a, b) == pytest.approx(d(b, a), abs=ROUNDING)
    assert d(a, c) <= d(a, b) + d(b, c) + ROUNDING


@given(boundaries, boundaries, boundaries)
def test_area_is_a_metric(a, b, c):
    check_metric(distance, a, b, c)


def signed(a, b):
    return float(np.trapezoid(rotated(a)(X) - rotated(b)(X), X))


def by_input(a, b):
    return abs(a.u - b.u)


APART = [diagonal(BOUND, centre) for centre in (-2.0, 0.0, 2.0)]
LOOP = H_left(InputSignal((0, 1, 2), (0, 8, -2)), 2, BOUND)


@pytest.mark.parametrize(
    ("d", "states"),
    [(lambda a, b: distance(a, b) ** 2, APART), (signed, APART), (by_input, [LOOP, *APART[:2]])],
    ids=[
        "squared: shorter the long way round",
        "signed: not symmetric",
        "|u₁ − u₂|: takes two states for one",
    ],
)
def test_area_counterexample_other_distances_are_no_metrics(d, states):
    check_metric(distance, *states)
    with pytest.raises(AssertionError):
        check_metric(d, *states)


def check_6_11(d, moves, others) -> None:
    """The area between two states, relay by relay: those up in one and down in the other."""
    nu = area_relays().nu
    different = drawn_by_relays(moves) != drawn_by_relays(others)
    states = [H_left(InputSignal(range(len(m) + 1), (0.0, *m)), len(m), BOUND) for m in (moves, others)]
    assert d(*states) == pytest.approx(float(np.sum(nu[different])), abs=1e-9)


@given(st.lists(whole, max_size=8), st.lists(whole, max_size=8))
def test_eq_6_11_is_the_area_of_the_relays_that_differ(moves, others):
    check_6_11(distance, moves, others)


@pytest.mark.parametrize("factor", [2.0, ROOT])
def test_eq_6_11_counterexample_coordinates_that_are_turned_and_stretched(factor):
    with pytest.raises(AssertionError):
        check_6_11(lambda a, b: factor * distance(a, b), [8.0, -5.0, 3.0], [-6.0, 2.0])


@given(boundaries, boundaries)
def test_eq_6_11_is_a_riemann_sum(a, b):
    fine = np.linspace(-ROOT * BOUND, 0.0, 20_001)
    middle = 0.5 * (fine[1:] + fine[:-1])
    riemann = float(np.sum(np.abs(rotated(a)(middle) - rotated(b)(middle)) * np.diff(fine)))
    assert distance(a, b) == pytest.approx(riemann, abs=2e-5)


def test_states_of_two_spaces_have_no_distance():
    with pytest.raises(UsageError, match="different state spaces"):
        distance(anhysteretic(1.0), anhysteretic(2.0))


def check_bounded(d, bound_of_d: float, a, b) -> None:
    assert d(a, b) <= bound_of_d


@given(boundaries, boundaries)
def test_boundedness_def_6_7_d_is_at_most_twice_u_squared(a, b):
    check_bounded(distance, 2 * BOUND**2 * (1 + 1e-12), a, b)


def test_boundedness_counterexample_a_smaller_bound_fails_at_the_two_saturations():
    """2û² is attained: half as much, or anything less, is no bound."""
    saturated = diagonal(BOUND, -BOUND), diagonal(BOUND, BOUND)
    assert distance(*saturated) == pytest.approx(2 * BOUND**2, rel=1e-12)
    with pytest.raises(AssertionError):
        check_bounded(distance, 1.999 * BOUND**2, *saturated)


# --- completeness ------------------------------------------------------------------------------------------


def check_lemma_6_5(turned, epsilon: float) -> None:
    """Equicontinuity (Def. 6.10): δ = ε serves every function and every point alike."""
    h = turned(X)
    for shift in range(1, X.size):
        if X[shift] - X[0] >= epsilon:
            break
        assert np.all(np.abs(h[shift:] - h[:-shift]) < epsilon)


@given(boundaries, st.floats(0.05, 5.0))
def test_lemma_6_5_equicontinuity(boundary, epsilon):
    check_lemma_6_5(rotated(boundary), epsilon)


def test_lemma_6_5_counterexample_continuous_functions_that_need_ever_smaller_delta():
    check_lemma_6_5(lambda x: np.sin(x), 0.5)
    with pytest.raises(AssertionError):
        check_lemma_6_5(lambda x: np.sin(16 * x), 0.5)


def check_uniform(first, second, d: float) -> None:
    """max|B̃₁ − B̃₂| ≤ 2√d̃: a difference of height h, with slopes up to 2, has a triangle of area h²/4 under it."""
    assert np.max(np.abs(first(X) - second(X))) <= 2 * math.sqrt(d) + 1e-6


@given(boundaries, boundaries)
def test_theorem_6_6_what_it_is_used_for_convergence_in_area_is_uniform(a, b):
    check_uniform(rotated(a), rotated(b), distance(a, b))


def test_theorem_6_6_counterexample_spikes_vanish_in_area_and_not_uniformly():
    def spike(x):
        return np.maximum(0.0, 1 - 20 * np.abs(x + 5))

    with pytest.raises(AssertionError):
        check_uniform(spike, lambda x: 0 * x, float(np.trapezoid(spike(X), X)))


def check_cauchy(states, first: float) -> None:
    """Def. 6.8, with a rate: from the n-th term on, all stay within first/2ⁿ of it."""
    for n, state in enumerate(states):
        assert all(distance(state, later) <= first / 2**n + 1e-6 for later in states[n:])


def between(a: Boundary, b: Boundary, share: float) -> Boundary:
    """The state part of the way from a to b, turned: a mean of functions with slope ≤ 1 has slope ≤ 1."""
    x = np.unique(np.concatenate([rotated(a).abscissa, rotated(b).abscissa]))
    x = x[np.r_[True, np.diff(x) > 1e-9]]
    x[-1] = 0.0
    return RotatedBoundary(x, (1 - share) * rotated(a)(x) + share * rotated(b)(x), BOUND).unrotated()


@given(boundaries, boundaries)
def test_theorem_6_7_cauchy_sequences_converge_in_the_space(a, b):
    """States halfway and halfway again from a to b: Cauchy, every term in ℬ, and so is the limit, b."""
    states = [between(a, b, 1 - 0.5**n) for n in range(8)]
    check_cauchy(states, distance(a, b))
    assert distance(states[-1], b) <= distance(a, b) / 2**7 + 1e-6
    check_claim_6_3(rotated(b))


def test_theorem_6_7_counterexample_a_sequence_that_does_not_settle_is_not_cauchy():
    with pytest.raises(AssertionError):
        check_cauchy([diagonal(BOUND, (-1.0) ** n) for n in range(8)], distance(*APART[:2]) * 10)


@pytest.mark.parametrize("limit", [diagonal(BOUND, 4.0), diagonal(BOUND, -7.0)])
def test_theorem_6_7_counterexample_staircases_alone_are_not_complete(limit):
    """States that inputs draw, Cauchy, with a limit that no input draws: without slopes ℬ has holes (§6.2.3)."""
    states = [staircase(limit, within=40.0 / 2.0**n) for n in range(8)]
    for state in states:
        G_inverse(state)
    check_cauchy(states, first=80.0)
    assert distance(states[-1], limit) < 0.4
    with pytest.raises(UsageError, match="no input generates"):
        G_inverse(limit)


def test_theorem_6_7_counterexample_functions_that_may_be_steep_leave_the_space_in_the_limit():
    """Continuous functions alone, ever steeper about −5: Cauchy in L₁, with a jump for a limit."""

    def steep(n):
        return np.clip(n * (X + 5), -1, 1) * np.minimum(1, (X - X[0]) / 2)

    pairs = [(steep(2.0**n), steep(2.0 ** (n + 1))) for n in range(6)]
    steps = [float(np.trapezoid(np.abs(b - a), X)) for a, b in pairs]
    assert all(late < 0.7 * early for early, late in zip(steps, steps[1:]))
    RotatedBoundary(X, steep(1.0), BOUND)
    with pytest.raises(UsageError, match="B̃P3"):
        RotatedBoundary(X, steep(2.0**6), BOUND)


def test_theorem_6_7_decaying_oscillations_converge_to_the_zero_state():
    """§3.2.6: a sinusoid that decays ever more slowly approximates α = −β; here in the metric of the space."""
    rest = []
    for n in (8, 16, 32, 64):
        oscillations = [10.0 * (-1) ** k * (1 - k / n) for k in range(n + 1)]
        state = H_left(InputSignal(range(n + 2), (0.0, *oscillations)), n + 1, BOUND)
        rest.append(distance(state, anhysteretic(BOUND)))
    assert all(late == pytest.approx(early / 2, rel=0.1) for early, late in zip(rest, rest[1:]))
