"""§6.4.3: the read-out r(B) against the operator, the relays and quadrature; and P₊B, P₋B.

For staircases and diagonal states r is exact to rounding on surfaces, tables and relay measures; on other
slopes it converges. Read-outs made wrong on purpose must fail the same checks.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from preisach.relay_reference import Printed, cells, lower_half
from smarig.core.errors import UsageError
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.operator import Preisach
from smarig.theory.state_space.boundary import Boundary, anhysteretic, diagonal
from smarig.theory.state_space.input_signal import InputSignal
from smarig.theory.state_space.maps import H_left
from smarig.theory.state_space.operator_state import boundary_of
from smarig.theory.state_space.reachability import staircase
from smarig.theory.state_space.read_out import is_up, read_out
from theory.state_space.made_operators import SYSTEMS, histories, initials, measure, operator_after


def check_against_the_operator(reading, op: Preisach) -> None:
    h = op.hysteresis
    scale = max(abs(h.everett(h.upper, h.lower)), 1.0)
    assert reading(boundary_of(op.state, h), h) == pytest.approx(op.y, abs=1e-12 * scale)


@settings(max_examples=150)
@given(st.sampled_from(sorted(SYSTEMS)), initials, histories)
def test_read_out_is_the_output_of_the_operator(name, initial, moves):
    check_against_the_operator(read_out, operator_after(name, initial, moves))


def minus_for_plus(boundary, h):
    """P₊ and P₋ exchanged."""
    return 2 * h.y_lower + h.everett(h.upper, h.lower) - read_out(boundary, h)


def corners_exchanged(boundary, h):
    """F(α, β₀) − F(α, β₁) with the corners of the upright edges: (α below, β) for (α above, β)."""
    edges = zip(boundary.points, boundary.points[1:])
    return h.y_lower + sum(h.everett(a1, b0) - h.everett(a1, b1) for (b0, _), (b1, a1) in edges if b0 != b1)


def last_edge_forgotten(boundary, h):
    u = min(boundary.points[-2])
    return read_out(Boundary((*boundary.points[:-1], (u, u)), boundary.bound), h)


@pytest.mark.parametrize("broken", [minus_for_plus, last_edge_forgotten])
@pytest.mark.parametrize("name", ["surface", "table", "measure"])
def test_read_out_counterexample_wrong_readings_are_not_the_output(name, broken):
    with pytest.raises(AssertionError):
        check_against_the_operator(
            broken, operator_after(name, "negative", [150.0, -100.0, 80.0, -50.0, 40.0])
        )


def test_read_out_counterexample_on_a_slope_the_corners_do_not_do():
    """Signed sums of F hold on level edges only; B* must be integrated (theory §1)."""
    op = operator_after("surface", 0.0, [100.0, -20.0])
    check_against_the_operator(read_out, op)
    with pytest.raises(AssertionError):
        check_against_the_operator(corners_exchanged, op)


@pytest.mark.parametrize("name", ["two_c", "two_p", "two_e"])
def test_read_out_is_the_sum_of_the_relays(name):
    """Against relays switched one by one, with masses from the surface as printed."""
    levels = np.linspace(-185.0, 185.0, 21)
    printed = Printed(name)
    relays = cells(levels, printed.y, 0.0, lower_half(printed.y_alpha_beta))
    rng = np.random.default_rng(7)
    moves = levels[rng.integers(0, 21, 40)]
    outputs = relays.drive(moves, printed.y_lower)
    u = InputSignal(range(41), (0.0, *moves))
    here = [read_out(H_left(u, t, 185.0), thesis_surface(name)) for t in range(1, 41)]
    assert np.ptp(here) > 10
    assert np.max(np.abs(here - outputs)) <= 1e-12 * printed.range


def check_regions(up_any, op: Preisach) -> None:
    """∬_{P₊B} μ − ∬_{P₋B} μ, literally; relays on the very boundary may be either."""
    h = op.hysteresis
    boundary = boundary_of(op.state, h)
    plus = up_any(boundary, h.alpha + 1e-6, h.beta + 1e-6)
    minus = ~up_any(boundary, h.alpha - 1e-6, h.beta - 1e-6)
    either = ~(plus | minus)
    assert not np.any(plus & minus)
    sure = float(np.sum(h.mass[plus]) - np.sum(h.mass[minus]))
    assert abs(op.y - sure) <= float(np.sum(np.abs(h.mass[either]))) + 1e-9


@given(st.sampled_from(["measure", "measure, more below"]), initials, histories)
def test_P_plus_and_P_minus_are_the_relays_up_and_down(name, initial, moves):
    check_regions(is_up, operator_after(name, initial, moves))


def test_P_plus_counterexample_the_other_side_is_not_the_output():
    with pytest.raises(AssertionError):
        check_regions(lambda *where: ~is_up(*where), operator_after("measure", "negative", [151.0, -101.0]))


@pytest.mark.parametrize("name", ["surface", "table", "measure"])
@pytest.mark.parametrize("centre", [-185.0, -60.0, 0.0, 35.0, 185.0])
def test_read_out_of_the_diagonal_states_is_psi(name, centre):
    """ψ(ℓ) = r(B_ℓ) (§8.3), from y₋ to y₊."""
    h = SYSTEMS[name]
    y = read_out(diagonal(185.0, centre), h)
    assert y == pytest.approx(Preisach(h).go_to_diagonal(centre), abs=1e-11)
    if abs(centre) == 185.0:
        end = h.y_lower + (h.everett(185.0, -185.0) if centre > 0 else 0.0)
        assert y == pytest.approx(end, abs=1e-9)


@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize("centre", [-399.0, -210.0, 210.0, 399.0])
def test_read_out_of_diagonal_states_beyond_the_range_is_saturation(name, centre):
    """A boundary may be drawn for more than the hysteresis reaches: there are no relays there."""
    h = SYSTEMS[name]
    oscillation = h.everett(h.upper, h.lower)
    saturated = h.y_lower + (oscillation if centre > 0 else 0.0)
    assert read_out(diagonal(400.0, centre), h) == pytest.approx(
        saturated, abs=1e-12 * max(abs(oscillation), 1.0)
    )


# --- slopes no input draws ------------------------------------------------------------------------------


STEEP = Boundary(((-185, 185), (-150, 40), (-20, 30), (10, 10)), 185.0)


def column_integral(h, boundary: Boundary) -> float:
    """y₋ + ∫ ∂_βy(B(β), β) dβ by adaptive quadrature, column by column."""
    total = h.y_lower
    for (b0, a0), (b1, a1) in zip(boundary.points, boundary.points[1:]):
        total += quad(
            lambda b, b0=b0, a0=a0, b1=b1, a1=a1: float(
                h.strip_beta(a0 + (b - b0) / (b1 - b0) * (a1 - a0), b)
            ),
            b0,
            b1,
            epsabs=1e-11,
            epsrel=1e-11,
            limit=200,
        )[0]
    return total


@pytest.mark.parametrize("name", ["two_c", "two_p", "two_e"])
def test_read_out_on_other_slopes_is_the_integral_of_its_columns(name):
    h = thesis_surface(name)
    assert read_out(STEEP, h) == pytest.approx(column_integral(h, STEEP), abs=1e-6 * 35)


def test_read_out_counterexample_a_curve_half_a_kelvin_higher_has_another_output():
    h = thesis_surface("two_c")
    higher = Boundary(((-185, 185), (-150, 40.5), (-20, 30.5), (10.25, 10.25)), 185.0)
    assert read_out(higher, h) != pytest.approx(column_integral(h, STEEP), abs=1e-6 * 35)


def test_read_out_on_other_slopes_counts_single_relays():
    h = measure(-185, 185, 6)
    expected = float(np.sum(np.where(is_up(STEEP, h.alpha + 1e-6, h.beta + 1e-6), h.mass, -h.mass)))
    assert read_out(STEEP, h) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("name", ["surface", "table"])
def test_read_out_is_continuous_in_the_area_metric(name):
    """Staircases ever closer to a curve have outputs ever closer to its output."""
    h = SYSTEMS[name]
    gaps = [
        abs(read_out(staircase(STEEP, within), h) - read_out(STEEP, h)) for within in (2000.0, 200.0, 2.0)
    ]
    assert gaps[0] > gaps[2]
    assert gaps[2] < 1e-3


def test_read_out_needs_a_boundary_that_covers_the_hysteresis():
    with pytest.raises(UsageError, match="û = 185"):
        read_out(anhysteretic(100.0), thesis_surface("two_c"))
