"""Isothermal and isobaric characteristics against the printed equations of Brinson (1993)."""

from math import cos, pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from plant.thermomechanical.brinson import TABLE_1, Branches, constants, strain, to_austenite, to_detwinned
from smarig.core import UsageError
from smarig.plant import AUSTENITE, TWINNED_MARTENSITE, Actuator, Material, isobaric_loop, isothermal_loop
from smarig.plant.thermomechanical.kinetics import transformed

EXPANDING = {"austenite_expansion": 11e-6, "martensite_expansion": 6.6e-6}
NITINOL = Material(**(TABLE_1 | EXPANDING))
C = constants(**EXPANDING)


def curve(T, path):
    """(strains, stresses) by the printed equations, for (stress, ξ_S, ξ) along a path."""
    return [strain(C, sigma, T, xi, xi_S) for sigma, xi_S, xi in path], [sigma for sigma, _, _ in path]


def test_superelastic_loop():
    T, path = 60.0, []
    start, finish = C.ss + C.CM * (T - C.Ms), C.sf + C.CM * (T - C.Ms)
    for sigma in np.linspace(0, start - 1, 4):
        path.append((sigma, 0.0, 0.0))
    for sigma in np.linspace(start, finish + 40, 9):
        xi = to_detwinned(C, sigma, T, 0.0)
        path.append((sigma, xi, xi))
    for sigma in np.linspace(finish, 0.0, 15):
        xi = to_austenite(C, sigma, T, 1.0)
        path.append((sigma, xi, xi))
    strains, stresses = curve(T, path)
    found = isothermal_loop(NITINOL, T, strains)
    assert found == pytest.approx(stresses, rel=1e-6, abs=1e-6)
    assert max(x for _, x, _ in path) == 1.0
    assert path[-1][1] == 0.0


def test_partial_loading_unloading_and_reloading_start_from_the_fraction_reached():
    T = 60.0
    start, finish = C.ss + C.CM * (T - C.Ms), C.sf + C.CM * (T - C.Ms)
    top = start + 0.4 * (finish - start)
    reached = to_detwinned(C, top, T, 0.0)
    middle = C.CA * (T - 0.5 * (C.As + C.Af))
    left = to_austenite(C, middle, T, reached)
    again = to_detwinned(C, start + 0.7 * (finish - start), T, left)
    assert 0.1 < left < reached < again < 1.0
    path = [(top, reached, reached), (middle + 100, reached, reached), (middle, left, left)]
    path += [(start, left, left), (start + 0.7 * (finish - start), again, again)]
    strains, stresses = curve(T, path)
    assert isothermal_loop(NITINOL, T, strains) == pytest.approx(stresses, rel=1e-6)


def test_a_retreat_without_reverse_transformation_does_not_count():
    """Within a branch the transformation goes on where it was interrupted."""
    T = 60.0
    stresses = [C.ss + C.CM * (T - C.Ms) + x for x in (10.0, 30.0, 15.0, 30.0, 45.0)]
    fractions = [to_detwinned(C, s, T, 0.0) for s in stresses]
    fractions[2] = fractions[1]
    strains, stresses = curve(T, [(s, x, x) for s, x in zip(stresses, fractions, strict=True)])
    assert isothermal_loop(NITINOL, T, strains) == pytest.approx(stresses, rel=1e-6)


def test_detwinning_leaves_the_residual_strain():
    """Brinson's shape memory: 6.7 % remain after full loading at 12 °C, nothing at 60 °C."""
    T = 12.0
    path = [(s, to_detwinned(C, s, T, 0.0), 1.0) for s in (50.0, 110.0, 135.0, 160.0, 200.0)]
    path += [(s, 1.0, 1.0) for s in (150.0, 0.0)]
    strains, stresses = curve(T, path)
    found = isothermal_loop(NITINOL, T, strains)
    assert found == pytest.approx(stresses, rel=1e-6, abs=1e-6)
    thermal = C.aM * (T - C.T0)
    assert strains[-1] - thermal == pytest.approx(0.067)
    assert isothermal_loop(NITINOL, T, [*strains, 0.03])[-1] == 0.0, "a longer wire is slack"


def test_isobaric_loop_with_a_partial_return():
    """Cold, heated to ξ = ¼ of the way, cooled within the strip, heated again, cooled: eqs. 18 and 20 by branch."""
    sigma = 250.0
    at = {share: C.As + sigma / C.CA + share * (C.Af - C.As) for share in (0.0, 0.3, 0.6, 1.0)}
    down = {share: C.Ms + (sigma - C.ss - share * (C.sf - C.ss)) / C.CM for share in (0.4, 1.0)}
    xi_1 = to_austenite(C, sigma, at[0.6], 1.0)
    xi_2 = to_detwinned(C, sigma, down[0.4], xi_1)
    xi_3 = to_austenite(C, sigma, at[0.3], xi_2)
    path = [(20.0, 1.0), (at[0.3], to_austenite(C, sigma, at[0.3], 1.0)), (at[0.6], xi_1), (down[0.4], xi_2)]
    path += [(at[0.0], xi_2), (at[0.3], xi_3), (at[1.0], 0.0), (down[1.0], 1.0)]
    expected = [strain(C, sigma, T, xi, xi) for T, xi in path]
    found = isobaric_loop(NITINOL, sigma, [T for T, _ in path], TWINNED_MARTENSITE)
    assert found == pytest.approx(expected, rel=1e-6)
    assert xi_1 < xi_3 < xi_2, "no wiping-out: the second heating is not on the curve of the first"


@pytest.mark.parametrize("sigma", [0.0, 60.0, 120.0, 150.0])
def test_cooling_below_the_stress_that_detwins_everything(sigma):
    """Stress takes its share of the austenite, cooling between M_s and M_f the rest, as twinned martensite."""
    xi_S = to_detwinned(C, sigma, 0.0, 0.0)
    expected, temperatures = [], np.linspace(C.Ms, C.Mf, 7)
    for T in temperatures:
        twinned = (1 - xi_S) * (cos(pi / (C.Ms - C.Mf) * (T - C.Mf)) + 1) / 2
        expected.append(strain(C, sigma, T, xi_S + twinned, xi_S))
    found = isobaric_loop(NITINOL, sigma, [80.0, *temperatures], AUSTENITE)[1:]
    assert found == pytest.approx(expected, rel=1e-6)


point = st.tuples(st.floats(0.0, 900.0), st.floats(-40.0, 160.0))
ONE_WIRE = Material.of(Actuator.named("thermomechanical_one_wire").file)


@given(st.lists(point, min_size=1, max_size=12), st.floats(0, 1), st.floats(0, 1))
def test_any_path_keeps_the_fractions_and_equals_the_printed_equations(path, xi_S, share):
    one = constants(**{name: getattr(ONE_WIRE, name) for name in TABLE_1})
    xi_T = (1 - xi_S) * share
    phase, reference = AUSTENITE._replace(detwinned=xi_S, twinned=xi_T), Branches(xi_S, xi_T)
    before = path[0]
    for sigma, T in path:  # one variable at a time: monotone steps
        for corner in ((before[0], T), (sigma, T)):
            phase = transformed(ONE_WIRE, phase, corner[1], corner[0])
            reference.go(one, *corner)
            assert phase.detwinned >= -1e-12
            assert phase.twinned >= -1e-12
            assert phase.martensite <= 1 + 1e-12
            assert phase[:2] == pytest.approx((reference.xi_S, reference.xi_T), abs=1e-9)
        before = (sigma, T)


@given(point, point, st.integers(2, 30))
def test_subdivision_of_a_step_changes_nothing(start, end, parts):
    """Stress falls while temperature rises, or the other way, so that every variable is monotone."""
    (s0, T0), (s1, T1) = start, end
    if (s1 - s0) * (T1 - T0) > 0:
        s0, s1 = s1, s0
    first = transformed(ONE_WIRE, TWINNED_MARTENSITE._replace(twinned=0.4), T0, s0)
    at_once = transformed(ONE_WIRE, first, T1, s1)
    for k in range(1, parts + 1):
        w = k / parts
        first = transformed(ONE_WIRE, first, T0 + w * (T1 - T0), s0 + w * (s1 - s0))
    assert first[:2] == pytest.approx(at_once[:2], abs=1e-9)


def test_loops_between_equal_temperatures_accommodate_to_a_limit():
    """ξ ↦ 1 − g (1 − h ξ): the fixed point is (1 − g)/(1 − g h)."""
    sigma, hot, cool = 250.0, C.As + 250 / C.CA + 0.4 * (C.Af - C.As), C.Ms + (250 - C.ss - 0.3 * 70) / C.CM
    h, g = to_austenite(C, sigma, hot, 1.0), 1 - to_detwinned(C, sigma, cool, 0.0)
    found = isobaric_loop(NITINOL, sigma, [20.0, *[hot, cool] * 40], TWINNED_MARTENSITE)
    limit = (1 - g) / (1 - g * h)
    assert found[-1] == pytest.approx(strain(C, sigma, cool, limit, limit), rel=1e-6)
    assert abs(found[2] - found[-1]) > 0.001


def test_what_is_no_loop_is_refused():
    with pytest.raises(UsageError, match="negative"):
        isobaric_loop(NITINOL, -1.0, [20.0])
    with pytest.raises(UsageError, match="finite"):
        isothermal_loop(NITINOL, 20.0, [0.0, float("nan")])
