"""§6.2.3: what a boundary is. Every curve the package makes obeys Definition 6.2; what does not is refused.

Def. 6.2 (BP1), (BP2), (BP3); the zero element B*; erratum 10 (B_ℓ and the edge of P_r), erratum 12 (zero
input in B* gives zero output only for a symmetric measure).
"""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from smarig.core.errors import UsageError
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.hysteresis.relay_measure import RelayMeasure
from smarig.theory.state_space.boundary import Boundary, anhysteretic, diagonal, rotated
from smarig.theory.state_space.maps import G
from smarig.theory.state_space.memory_sequence import MemorySequence
from smarig.theory.state_space.reachability import staircase
from smarig.theory.state_space.read_out import is_up, read_out
from smarig.theory.state_space.transition import sweep
from theory.state_space.made import BOUND, boundaries, curves, values


def broken_property(points) -> str | None:
    """Definition 6.2 read off a polyline, with its end on α = β."""
    if not all(-BOUND <= beta <= alpha <= BOUND for beta, alpha in points):
        return "(BP1)"
    if tuple(points[0]) != (-BOUND, BOUND):
        return "(BP2)"
    if any(b1 < b0 or a1 > a0 for (b0, a0), (b1, a1) in pairwise(points)):
        return "(BP3)"
    return None if points[-1][0] == points[-1][1] else "end on α = β"


@given(boundaries, values)
def test_def_6_2_every_boundary_made_here_has_bp1_to_bp3(boundary, u):
    made = [boundary, sweep(boundary, u), staircase(boundary, within=2.0), rotated(boundary).unrotated()]
    assert [broken_property(b.points) for b in made] == [None] * 4


@pytest.mark.parametrize(
    ("broken", "points"),
    [
        ("(BP1)", [(-10, 10), (-4, 3), (2, 3), (2, -1), (-1, -1)]),
        ("(BP1)", [(-10, 10), (-10, 12), (3, 3)]),
        ("(BP1)", [(-10, 10), (-11, 4), (4, 4)]),
        ("(BP1)", [(-10, 10), (-10, float("nan")), (4, 4)]),
        ("(BP2)", [(-4, 4), (2, 4), (2, 2)]),
        ("(BP2)", [(-6, 10), (2, 2)]),
        ("(BP3)", [(-10, 10), (-8, 2), (-3, 5), (3, 3)]),
        ("(BP3)", [(-10, 10), (-2, 6), (-5, 4), (3, 3)]),
        ("end on α = β", [(-10, 10), (-2, 6), (1, 4)]),
    ],
)
def test_def_6_2_counterexamples_are_refused(broken, points):
    assert broken_property(points) == broken
    with pytest.raises(UsageError) as refusal:
        Boundary(tuple(points), BOUND)
    assert broken in str(refusal.value)


@given(curves(least=4), st.data())
def test_def_6_2_bp3_counterexample_a_curve_with_two_points_exchanged_is_refused(boundary, data):
    """A boundary that increases somewhere: any two of its different points the other way round."""
    points = list(boundary.points)
    assume(len(points) > 3)
    i = data.draw(st.integers(1, len(points) - 3))
    points[i], points[i + 1] = points[i + 1], points[i]
    with pytest.raises(UsageError, match="BP3"):
        Boundary(tuple(points), BOUND)


@given(boundaries, st.floats(0, 1))
def test_def_6_2_a_boundary_is_its_curve_and_not_its_points(boundary, share):
    """Points added inside level and upright edges change nothing."""
    more = []
    for (b0, a0), (b1, a1) in pairwise(boundary.points):
        more.append((b0, a0))
        if b0 == b1 or a0 == a1:
            inside = (min(b0 + share * (b1 - b0), b1), max(a0 + share * (a1 - a0), a1))
            more += [inside, inside]
    assert Boundary((*more, boundary.points[-1]), BOUND) == boundary


def test_def_6_2_counterexample_a_point_off_the_edge_is_another_boundary():
    assert Boundary(((-10, 10), (-10, 4), (1, 4), (1, 1)), 10) != Boundary(
        ((-10, 10), (-10, 4), (0, 4), (1, 3), (1, 1)), 10
    )


@pytest.mark.parametrize("bound", [0.0, -1.0, float("inf"), float("nan")])
def test_a_bound_that_bounds_nothing_is_refused(bound):
    with pytest.raises(UsageError, match="û"):
        Boundary(((-bound, bound), (0, 0)), bound)


# --- the zero element, the diagonal states ------------------------------------------------------------


def is_zero_state(boundary: Boundary) -> bool:
    return boundary.points == ((-BOUND, BOUND), (0.0, 0.0))


def test_zero_element_is_the_line_alpha_equals_minus_beta():
    assert is_zero_state(anhysteretic(BOUND))
    assert is_zero_state(G(MemorySequence((0.0,), BOUND)))


@pytest.mark.parametrize("other", [diagonal(BOUND, 0.1), sweep(sweep(anhysteretic(BOUND), 1.0), 0.0)])
def test_zero_element_counterexample_other_states_at_zero_or_near_it_are_not_it(other):
    assert not is_zero_state(other)


@given(values, values, values)
def test_erratum_10_completed_diagonal_state_is_the_line_inside_the_triangle(centre, one, other):
    """P₊ of B_ℓ is α + β ≤ 2ℓ, together with what an input that stands at ℓ holds up."""
    alpha, beta = max(one, other), min(one, other)
    assume(abs(alpha + beta - 2 * centre) > 1e-9 and beta > -BOUND and alpha < BOUND)
    expected = alpha + beta < 2 * centre
    assert is_up(diagonal(BOUND, centre), alpha, beta) == expected


@pytest.mark.parametrize("centre", [-9.0, -3.0, 2.0, 10.0])
def test_erratum_10_counterexample_the_line_as_printed_breaks_bp2(centre):
    ends = diagonal(BOUND, centre).points[1:]
    with pytest.raises(UsageError, match="BP2"):
        Boundary(ends, BOUND)


@pytest.mark.parametrize("centre", [10.5, -11.0, float("nan")])
def test_diagonal_state_outside_the_range_is_refused(centre):
    with pytest.raises(UsageError, match="B_ℓ"):
        diagonal(BOUND, centre)


@given(st.lists(st.tuples(values, values, st.floats(-1, 1)), min_size=1, max_size=8))
def test_erratum_12_zero_state_has_zero_output_for_a_measure_symmetric_about_it(relays):
    """Each relay (α, β) with its mirror image (−β, −α) of the same mass."""
    pairs = [(max(a, b), min(a, b), m) for a, b, m in relays if a + b != 0]
    assume(pairs)
    both = np.array([*pairs, *((-beta, -alpha, mass) for alpha, beta, mass in pairs)])
    assert abs(read_out(anhysteretic(BOUND), RelayMeasure.from_arrays(*both.T))) <= 1e-12


@pytest.mark.parametrize(("name", "printed"), [("two_c", 2.65), ("two_p", 0.75), ("two_e", 1.59)])
def test_erratum_12_counterexample_the_thesis_actuator_is_not_symmetric_and_its_zero_state_not_at_zero(
    name, printed
):
    assert read_out(anhysteretic(185.0), thesis_surface(name)) == pytest.approx(printed, abs=0.005)
