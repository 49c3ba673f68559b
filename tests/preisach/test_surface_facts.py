"""Statements of the thesis and of theory §1 about the six surfaces of Table 5.1, figure by figure."""

import numpy as np
import pytest
from scipy.integrate import quad

from preisach.relay_reference import NODES, TABLE_5_1, WEIGHTS, Printed
from smarig.core.errors import UsageError
from smarig.preisach.hysteresis.fod_surface import FodSurface
from smarig.preisach.hysteresis.gorbet_1997 import THESIS_PARTITIONS, THESIS_SURFACES, thesis_surface
from smarig.preisach.operator import Preisach
from smarig.theory.energy import available_storage, certify
from smarig.theory.properties import properties


def grid(name: str, n: int = 371) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """α, β, and where α ≥ β."""
    s = thesis_surface(name)
    a, b = np.meshgrid(*[np.linspace(s.lower, s.upper, n)] * 2, indexing="ij")
    return a, b, a >= b


def test_the_built_in_sets_are_the_printed_table():
    assert set(THESIS_SURFACES) == set(TABLE_5_1)
    for name, (x, _, (lower, upper), (y_lower, y_upper)) in TABLE_5_1.items():
        s = thesis_surface(name)
        assert (s.x, s.lower, s.upper, s.y_lower, s.y_upper) == (x, lower, upper, y_lower, y_upper)


def test_partitions_are_the_currents_of_the_protocol():
    """One-wire: 174.1 I² for I = 0 … 1 A by 0.1; two-wire: symmetric about zero (theory §3)."""
    assert np.allclose(
        THESIS_PARTITIONS["one_wire"], 174.1 * np.linspace(0, 1, 11) ** 2, atol=0.06
    )  # 27.856 is printed 27.8
    assert np.array_equal(THESIS_PARTITIONS["two_wire"], -np.array(THESIS_PARTITIONS["two_wire"])[::-1])


@pytest.mark.parametrize("name", THESIS_SURFACES)
def test_values_and_derivatives_are_the_printed_formula(name: str):
    s, printed = thesis_surface(name), Printed(name)
    a, b, inside = grid(name, 60)
    scale = printed.range
    assert np.allclose(s.y(a, b)[inside], printed.y(a, b)[inside], rtol=0, atol=1e-13 * scale)
    assert np.allclose(s.strip_beta(a, b)[inside], printed.y_beta(a, b)[inside], rtol=0, atol=1e-14 * scale)
    assert np.allclose(
        2 * s.density(a, b)[inside], printed.y_alpha_beta(a, b)[inside], rtol=0, atol=1e-15 * scale
    )
    step = 1e-30
    slope_alpha = printed.y(a + step * 1j, b).imag / step
    on_diagonal = printed.y(a + step * 1j, a + step * 1j).imag / step
    assert np.allclose(s.slope_alpha(a, b)[inside], slope_alpha[inside], rtol=0, atol=1e-13 * scale)
    assert np.allclose(
        s.strip_alpha(a, b)[inside], (on_diagonal - slope_alpha)[inside], rtol=0, atol=1e-13 * scale
    )


@pytest.mark.parametrize("name", THESIS_SURFACES)
def test_ends_are_exact(name: str):
    """ỹ(ū, ū) matches the measured output to the last bit but one, ỹ(α, u̲) to the last (§5.4)."""
    s = thesis_surface(name)
    assert float(s.y(s.upper, s.upper)) == pytest.approx(s.y_upper, rel=2.3e-16, abs=0)
    assert np.all(s.y(np.linspace(s.lower, s.upper, 99), s.lower) == s.y_lower)


@pytest.mark.parametrize(
    ("name", "percent"), list(zip(THESIS_SURFACES, [28.8, 33.7, 8.2, 26.2, 13.1, 12.6], strict=True))
)
def test_share_of_the_reversible_part(name: str, percent: float):
    s, printed = thesis_surface(name), Printed(name)
    carried, _ = quad(lambda b: float(s.reversible(b)), s.lower, s.upper, limit=200)
    by_print, _ = quad(lambda b: float(printed.y_beta(b, b)), s.lower, s.upper, limit=200)
    assert carried == pytest.approx(by_print, rel=1e-9)
    assert 100 * carried / printed.range == pytest.approx(percent, abs=0.05)
    assert np.all(s.reversible(np.linspace(s.lower, s.upper, 500)) >= 0)  # 0 only below the last bit of y


@pytest.mark.parametrize("name", THESIS_SURFACES)
def test_density_and_reversible_part_reach_saturation_together(name: str):
    """2∬μ + ∫g = y₊ − y₋; μ alone falls short by g's share (erratum 8)."""
    s = thesis_surface(name)
    edges = np.linspace(s.lower, s.upper, 41)
    half, middle = np.diff(edges)[0] / 2, (edges[1:] + edges[:-1]) / 2
    a = (middle[:, None] + half * NODES).ravel()
    w = np.tile(half * WEIGHTS, middle.size)
    panels = [s.lower + (a - s.lower)[:, None] * (k + (NODES + 1) / 2) / 8 for k in range(8)]
    irreversible = sum(2 * (s.density(a[:, None], b) @ WEIGHTS) * (a - s.lower) / 16 @ w for b in panels)
    reversible = float(s.reversible(a) @ w)
    assert irreversible + reversible == pytest.approx(s.y_upper - s.y_lower, rel=1e-9)
    assert reversible > 0.08 * (s.y_upper - s.y_lower)


@pytest.mark.parametrize("name", ["one_c", "two_c"])
def test_closed_form_of_the_constant_density(name: str):
    """μ̃_c with its last factor as erratum 3 corrects it; non-negative because x₂ > 0."""
    s = thesis_surface(name)
    a, b, inside = grid(name, 80)
    x2, x3, x4, x5 = s.x
    e_lower, e_b, e_a = np.exp(-x4 * (s.lower + x5)), np.exp(-x4 * (b + x5)), np.exp(-x2 * (a + x3))
    c1 = (s.y_upper - s.y_lower) / Printed(name).s(s.upper, s.upper) / (1 + e_lower)
    mu = c1 / 2 * x2 * x4 * e_a * e_b * (1 + e_lower) / ((1 + e_a) ** 2 * (1 + e_b) ** 2)
    assert np.allclose(s.density(a, b)[inside], mu[inside], rtol=1e-12, atol=1e-15 * Printed(name).range)
    assert s.density(a, b)[inside].min() > 0


@pytest.mark.parametrize(
    ("name", "least"), [("one_p", -6.9e-4), ("one_e", -1.9e-3), ("two_p", -2.5e-4), ("two_e", -1.2e-4)]
)
def test_the_best_fits_are_not_positive(name: str, least: float):
    """Table 5.2: only the c surfaces are in M_P."""
    a, b, inside = grid(name)
    assert thesis_surface(name).density(a, b)[inside].min() == pytest.approx(least, rel=0.05)


# --- branches, as the operator draws them -----------------------------------------------------------


def falling_branches(name: str) -> np.ndarray:
    """FOD curves, rows: up from negative saturation to α, then down in steps to u₋; NaN elsewhere."""
    s = thesis_surface(name)
    levels = np.linspace(s.lower, s.upper, 186)
    op = Preisach(s)
    curves = np.full((levels.size, levels.size), np.nan)
    for i in range(1, levels.size):
        curves[i, : i + 1] = op.simulate(levels[: i + 1][::-1])[::-1]
    return curves


def rising_branches(name: str) -> np.ndarray:
    """FOA curves, rows: down from positive saturation to β, then up in steps to u₊; NaN elsewhere."""
    s = thesis_surface(name)
    levels = np.linspace(s.lower, s.upper, 186)
    op = Preisach(s)
    curves = np.full((levels.size, levels.size), np.nan)
    for j in range(levels.size):
        curves[j, j:] = op.simulate(levels[j:], "positive")
    return curves


@pytest.mark.parametrize("name", THESIS_SURFACES)
def test_falling_branches_are_monotone(name: str):
    curves = falling_branches(name)
    assert np.nanmin(np.diff(curves, axis=1)) >= -1e-14


@pytest.mark.parametrize("name", [n for n in THESIS_SURFACES if n != "two_p"])
def test_rising_branches_are_monotone(name: str):
    curves = rising_branches(name)
    assert np.nanmin(np.diff(curves, axis=1)) >= -1e-14


def test_rising_branches_of_the_two_wire_parabola_go_back():
    """Slope down to −0.037 °/K, up to 0.55° against Assumption 2.1."""
    curves, step_K = rising_branches("two_p"), 2.0
    assert np.nanmin(np.diff(curves, axis=1)) / step_K == pytest.approx(-0.036, abs=0.001)  # mean over 2 K
    a, b, inside = grid("two_p")
    assert thesis_surface("two_p").strip_alpha(a, b)[inside].min() == pytest.approx(-0.037, abs=0.0005)
    known = np.where(np.isnan(curves), -np.inf, curves)
    lost = np.nanmax(np.maximum.accumulate(known, axis=1) - curves)
    assert lost == pytest.approx(0.55, abs=0.01)


@pytest.mark.parametrize(("name", "psi_0"), [("two_c", 2.65), ("two_p", 0.75), ("two_e", 1.59)])
def test_anhysteretic_output_is_not_zero(name: str, psi_0: float):
    """ψ(0) = r(B*), by adaptive quadrature of the printed formula and as theory §1 states it."""
    printed = Printed(name)
    by_print, _ = quad(lambda b: float(printed.y_beta(-b, b)), printed.lower, 0.0, epsabs=1e-12)
    here = Preisach(thesis_surface(name), "anhysteretic").y
    assert here == pytest.approx(printed.y_lower + by_print, abs=1e-11)
    assert here == pytest.approx(psi_0, abs=0.005)


@pytest.mark.parametrize("name", THESIS_SURFACES)
def test_psi_is_onto(name: str):
    """ψ(ℓ) = r(B_ℓ) runs from y₋ to y₊ (Thm 8.5); beyond the range ℓ is clipped."""
    s = thesis_surface(name)
    op = Preisach(s)
    assert op.go_to_diagonal(s.lower) == pytest.approx(s.y_lower, abs=1e-12)
    assert op.go_to_diagonal(s.upper) == pytest.approx(s.y_upper, abs=1e-11)
    assert op.go_to_diagonal(s.upper + 50) == op.go_to_diagonal(s.upper)


def test_psi_of_the_one_wire_parabola_is_not_monotone():
    s = thesis_surface("one_p")
    psi = [Preisach(s).go_to_diagonal(ell) for ell in np.linspace(s.lower, s.upper, 80)]
    assert np.min(np.diff(psi)) < 0


@pytest.mark.parametrize("name", ["one_c", "one_p", "one_e"])
def test_one_wire_anhysteretic_state_is_negative_saturation(name: str):
    s = thesis_surface(name)
    inputs = np.random.default_rng(1).uniform(s.lower, s.upper, 400)
    op = Preisach(s)
    cold, anhysteretic = op.simulate(inputs), op.simulate(inputs, "anhysteretic")
    assert np.max(np.abs(cold - anhysteretic)) <= 1e-12 * (s.y_upper - s.y_lower)


# --- what a surface refuses --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"form": "cubic"}, "Surface form 'cubic' must be one of constant, parabolic, exponential."),
        ({"x": (1.0, 2.0)}, r"A constant surface has parameters x2, x3, x4, x5; got 2."),
        ({"upper": 0.0}, r"Surface range is empty: lower 0.0 ≥ upper 0.0."),
        ({"x": ("steep", 1.0, 1.0, 1.0)}, r"A constant surface has a parameter that is not a finite number"),
        ({"x": (None, 1.0, 1.0, 1.0)}, r"A constant surface has a parameter that is not a finite number"),
    ],
)
def test_a_surface_that_is_none_is_refused(change: dict, sentence: str):
    good = {"form": "constant", "x": (0.05, -47.0, 0.1, -24.0), "lower": 0.0, "upper": 174.1, "y_lower": 0.0}
    with pytest.raises(UsageError, match=sentence.replace("(", r"\(")):
        FodSurface(**{**good, "y_upper": 12.5, **change})


@pytest.mark.parametrize("x", [(0.0,) * 4, (0.05, -47.0, 0.0, -24.0), (0.05, -47.0, 0.1, -1e5)])
@pytest.mark.parametrize("use", [Preisach, properties, certify, available_storage])
def test_a_shape_without_height_has_no_amplitude(x, use):
    with pytest.raises(UsageError, match=r"has no amplitude: its shape s\(u₊, u₊\) is zero"):
        use(FodSurface("constant", x, 0.0, 100.0, 0.0, 10.0))


@pytest.mark.long("takes a second")
def test_an_output_that_never_moves_is_a_hysteresis_all_the_same():
    still = FodSurface("constant", (0.05, -47.0, 0.1, -24.0), 0.0, 100.0, 3.0, 3.0)
    assert Preisach(still).simulate([50.0, 20.0, 70.0]).tolist() == [3.0, 3.0, 3.0]
    assert Preisach(still).inverse(3.0) == 0.0
    assert properties(still).classes.positive
    assert certify(still).dissipative


def test_an_unknown_surface_is_refused_with_the_nearest_name():
    with pytest.raises(UsageError, match="No surface 'one_w'; did you mean one_"):
        thesis_surface("one_w")
