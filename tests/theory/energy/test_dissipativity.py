"""Results beyond chapter 7: the loop-area criterion, the certificate, the available storage, and their
refusals.

The reference for the criterion is ``relay_energy.Game``: every possible input on a few relays, without the
notion of loops. The reference for areas is the forward model along finely sampled loops.
"""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from preisach.relay_reference import Printed
from smarig.core.errors import UsageError
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.hysteresis.gorbet_1997 import THESIS_SURFACES, thesis_surface
from smarig.preisach.hysteresis.mirrored import Mirrored
from smarig.preisach.hysteresis.relay_measure import RelayMeasure
from smarig.preisach.interval import Interval, shift_bounds
from smarig.preisach.operator import Preisach
from smarig.theory.butterfly import butterfly_relays, butterfly_table
from smarig.theory.energy import (
    available_storage,
    certify,
    confirm,
    energy_balance,
    loop_area,
    recoverable_energy,
    work,
)
from smarig.theory.energy.loop_area_bounds import (
    AreaPolynomial,
    DensityCells,
    area_bound,
    density_bounds,
    negative_small_loop,
)
from smarig.theory.energy.storage_function import recoverable_energy_is_storage
from theory.energy.relay_energy import LEVELS, Game, histories, relays
from theory.energy.test_chapter_7 import integral_of_u_dy, run

PASS = ("one_c", "one_e", "two_c", "two_e")
SMALL = LEVELS[[0, 1, 3, 5, 6]]


@cache
def certificate(name: str):
    """Of a surface of Table 5.1; computed once."""
    return certify(thesis_surface(name))


def measure_of(values) -> RelayMeasure:
    return RelayMeasure.from_arrays(*values)


def table(seed: int, n: int = 7) -> FodTable:
    """A signed random table on an uneven partition."""
    rng = np.random.default_rng(seed)
    nodes = np.cumsum(rng.uniform(0.5, 2, n)) - 4
    y = np.where(np.tri(n, dtype=bool), np.cumsum(rng.normal(0.4, 0.5, (n, n)), axis=1), np.nan)
    return FodTable.from_arrays(nodes, nodes, y)


# --- the criterion ------------------------------------------------------------------------------------


@given(relays(SMALL))
@settings(max_examples=100)
def test_dissipative_exactly_when_no_input_whatever_takes_energy_for_ever(values):
    game = Game.of(*values, SMALL)
    assert certify(measure_of(values)).dissipative == (game.best() is not None)


def test_the_criterion_is_neither_the_sign_of_the_measure_nor_the_major_loop():
    """A negative relay may be dissipative; a lossy major loop may hide one that is not."""
    alpha, beta = [0.5, 3.0], [-1.0, -3.0]
    inner_pays = (alpha, beta, [1.0, -0.125])
    inner_gives = (alpha, beta, [-0.125, 1.0])
    assert certify(measure_of(inner_pays)).dissipative
    assert Game.of(*inner_pays, LEVELS).best() is not None
    assert not certify(measure_of(inner_gives)).dissipative
    assert float(loop_area(measure_of(inner_gives), 3.0, -3.0)) > 0
    assert Game.of(*inner_gives, LEVELS).best() is None


@given(relays(SMALL), histories(SMALL, 8))
@settings(max_examples=100)
def test_available_storage_is_the_most_any_input_takes_from_the_state(values, history):
    operator, reference = run(values, history)
    game = Game.of(*values, SMALL)
    best = game.best()
    found = available_storage(operator.hysteresis, operator.state)
    assert found.exact
    if best is None:
        assert found.value == math.inf
    else:
        assert found.value == pytest.approx(best[game.start[game.key(reference)]], abs=1e-9)


@given(relays(low=0.0), histories())
def test_available_storage_is_the_recoverable_energy_for_positive_measures(values, history):
    operator, _ = run(values, history)
    stored = recoverable_energy(operator.hysteresis, operator.state)
    assert available_storage(operator.hysteresis, operator.state).value == pytest.approx(stored, abs=1e-9)


def test_available_storage_notices_a_negative_measure():
    """With a negative relay more than Q_r can be had: a bias that Q_r does not show."""
    operator, _ = run(([0.5, 3.0], [-1.0, -3.0], [1.0, -0.125]), [0.5, 0.0])
    assert recoverable_energy(operator.hysteresis, operator.state) == 0.0
    assert available_storage(operator.hysteresis, operator.state).value == pytest.approx(0.75)  # rise to 3


# --- loop areas ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", THESIS_SURFACES)
def test_loop_area_is_the_closed_integral_of_the_forward_model(name):
    s, rng = thesis_surface(name), np.random.default_rng(1)
    for low, high in np.sort(rng.uniform(s.lower, s.upper, (6, 2))).tolist():
        down, up = np.linspace(high, low, 2001), np.linspace(low, high, 2001)
        y = Preisach(s).simulate(np.concatenate([[high, low], up, down]))[1:]
        area = integral_of_u_dy(np.concatenate([[low], up, down]), y)
        assert float(loop_area(s, high, low)) == pytest.approx(area, rel=1e-5, abs=1e-3)


@given(relays(), st.sampled_from(LEVELS[:3].tolist()), st.sampled_from(LEVELS[3:].tolist()))
def test_loop_area_of_relays_is_the_sum_of_theirs(values, low, high):
    alpha, beta, mass = values
    inside = (alpha <= high) & (beta >= low)
    expected = 2 * (mass * (alpha - beta))[inside].sum()
    assert float(loop_area(measure_of(values), high, low)) == pytest.approx(expected, abs=1e-11)


def test_loop_area_does_not_see_the_reversible_part_and_notices_when_it_should():
    """A table with its diagonal slope doubled loses the same; one with its density doubled does not."""
    t = table(3)
    u, y = t.nodes, t.values
    more_g, more_mu = y + 0.7 * u, 2 * y
    areas = [loop_area(FodTable(u, v), u[1:, None], u[0]).ravel() for v in (y, more_g, more_mu)]
    assert np.allclose(areas[0], areas[1], atol=1e-12)
    assert np.allclose(2 * areas[0], areas[2], atol=1e-12)
    assert np.abs(areas[0]).max() > 0.1


# --- certificates -------------------------------------------------------------------------------------

EXPECTED = {  # theory.md §6: the loop and its area
    "one_p": (104.8, 59.3, -0.0459),
    "two_p": (185.0, 83.5, -1.248),
}


@pytest.mark.parametrize("name", THESIS_SURFACES)
def test_the_six_surfaces_agree_with_theory(name):
    c = certificate(name)
    assert c.dissipative == (name in PASS)
    if name in EXPECTED:
        assert (*c.at, c.area) == pytest.approx(EXPECTED[name], rel=2e-3)
        assert 1.06 * c.area < c.lower_bound < c.area
    else:
        assert c.area == 0.0 <= c.lower_bound


@pytest.mark.parametrize("name", THESIS_SURFACES)
def test_no_sampled_loop_lies_below_the_verified_bound(name):
    s, rng = thesis_surface(name), np.random.default_rng(5)
    low, high = np.sort(rng.uniform(s.lower, s.upper, (4000, 2)), axis=1).T
    areas = loop_area(s, high, low)
    assert areas.min() >= certificate(name).lower_bound - 1e-9
    assert areas.min() >= area_bound(s, 32, 0.0).low - 1e-9


def test_the_bound_closes_in_on_the_minimum():
    """… with the square of the cell; a bound that did not would not be tight, one above would be wrong."""
    s, least = thesis_surface("two_p"), certificate("two_p").area
    gaps = [least - area_bound(s, n, 0.0).low for n in (64, 128, 256)]
    assert gaps[0] > 3 * gaps[1] > 9 * gaps[2] > 0


@pytest.mark.parametrize("name", THESIS_SURFACES)
def test_density_bounds_hold_the_printed_density(name):
    """Against the reference that differentiates (5.5) as printed; a box of no size must give it exactly."""
    s, printed, rng = thesis_surface(name), Printed(name), np.random.default_rng(6)
    a = np.sort(rng.uniform(s.lower, s.upper, (500, 2)), axis=1)
    b = np.sort(rng.uniform(s.lower, a[:, :1], (500, 2)), axis=1)
    bounds = density_bounds(s, a[:, 0], a[:, 1], b[:, 0], b[:, 1])
    inside = np.array([printed.y_alpha_beta(a @ [1 - t, t], b @ [1 - v, v]) for t, v in rng.random((40, 2))])
    assert np.all(inside >= bounds.low - 1e-12)
    assert np.all(inside <= bounds.high + 1e-12)
    point = density_bounds(s, a[:, 0], a[:, 0], b[:, 0], b[:, 0])
    assert np.allclose([point.low, point.high], printed.y_alpha_beta(a[:, 0], b[:, 0]), rtol=1e-7, atol=1e-13)


def test_a_negative_diagonal_is_never_missed():
    """μ(u, u) < 0 makes every small loop about u negative, however small its area."""
    bound, (high, low) = negative_small_loop(thesis_surface("one_p"))
    assert float(loop_area(thesis_surface("one_p"), high, low)) <= bound < 0
    assert negative_small_loop(thesis_surface("one_e")) is None
    barely = replace(thesis_surface("one_p"), x=(0.0439, -44.166, 0.0996, -0.001039425, 0.2392, -36.3101))
    found = certify(barely)  # every area it has is rounding
    assert found.dissipative is False
    assert -found.tolerance < found.area < 0


@pytest.mark.parametrize("seed", range(8))
def test_the_minimum_of_a_table_is_exact(seed):
    t = table(seed)
    c, rng = certify(t), np.random.default_rng(seed)
    low, high = np.sort(rng.uniform(t.lower, t.upper, (20000, 2)), axis=1).T
    areas = loop_area(t, high, low)
    assert c.area <= areas.min() + 1e-12
    assert c.area == pytest.approx(float(loop_area(t, *c.at)), abs=1e-12)
    assert areas.min() - c.area < 0.05 * abs(c.area) + 1e-9


def test_the_minimum_of_a_table_is_not_at_its_nodes():
    """What a search of the nodes alone would miss."""
    missed = 0
    for seed in range(8):
        t = table(seed)
        i, j = np.tril_indices(t.nodes.size)
        missed += certify(t).area < loop_area(t, t.nodes[i], t.nodes[j]).min() - 1e-6
    assert missed >= 1


@pytest.mark.parametrize("name", THESIS_SURFACES)
def test_a_table_of_a_surface_gets_the_verdict_of_the_surface(name):
    s = thesis_surface(name)
    u = np.linspace(s.lower, s.upper, 41)
    a, b = np.meshgrid(u, u, indexing="ij")
    t = FodTable.from_arrays(u, u, np.where(a >= b, s.y(a, b), np.nan))
    assert certify(t).dissipative == (name in PASS)


def test_the_mirror_image_gives_back_as_much():
    image, own = certify(Mirrored(thesis_surface("two_p"))), certificate("two_p")
    assert (image.area, image.at) == (own.area, (-own.at[1], -own.at[0]))
    assert float(loop_area(Mirrored(thesis_surface("two_p")), *image.at)) == pytest.approx(image.area)


def test_a_kind_that_cannot_be_decided_is_refused():
    odd = type("Sampled", (), {"lower": 0.0, "upper": 1.0})()
    with pytest.raises(UsageError, match="Dissipativity of a Sampled cannot be decided exactly"):
        certify(odd)
    with pytest.raises(UsageError, match="storage function of a FodTable cannot be decided"):
        recoverable_energy_is_storage(table(0))


@pytest.mark.parametrize(
    "loop", [(10.0, 50.0), (np.nan, 1.0), (1.0, np.nan), (np.inf, 0.0), (185.001, 0.0), (0.0, -400.0)]
)
def test_a_loop_outside_the_triangle_has_no_area(loop):
    with pytest.raises(UsageError, match="A loop needs -185 ≤ m ≤ M ≤ 185, got m = "):
        loop_area(thesis_surface("two_e"), *loop)
    with pytest.raises(UsageError, match="A loop needs .* got m = 0.0 and M = 200.0"):
        loop_area(thesis_surface("two_e"), [100.0, 200.0], 0.0)


def test_what_is_no_loop_is_refused():
    for ends in (("high", 0.0), ([1.0, 2.0, 3.0], [0.0, 1.0])):
        with pytest.raises(UsageError, match="ends of loops must be numbers"):
            loop_area(thesis_surface("two_e"), *ends)
    for loop in ((10.0, 50.0), (50.0, 50.0), (np.nan, 1.0)):
        with pytest.raises(UsageError, match=r"A loop \(M, m\) needs M > m"):
            confirm(thesis_surface("two_p"), loop)
    with pytest.raises(UsageError, match=r"A loop is two numbers \(M, m\), got 5"):
        confirm(thesis_surface("two_p"), 5)


@pytest.mark.parametrize("levels", [0, 1, -1, 1.5, np.nan, "many", None, 10**9], ids=str)
def test_levels_that_are_no_number_of_levels_are_refused(levels):
    with pytest.raises(UsageError, match="number of levels must be a whole number from 2 to 2000"):
        available_storage(thesis_surface("two_e"), levels=levels)


@pytest.mark.parametrize("cells", [0, 1.5, "many"], ids=str)
def test_cells_that_are_no_number_of_cells_are_refused(cells):
    with pytest.raises(UsageError, match="number of cells must be a whole number"):
        recoverable_energy_is_storage(thesis_surface("two_e"), cells)


def test_a_certificate_names_its_units_where_they_are_known():
    assert "↔ 185 K gives back 1.248 deg·K in" in certificate("two_p").text
    assert "at least 0 mm·K)" in certificate("one_e").text
    undecided = replace(certificate("one_e"), dissipative=None, lower_bound=-2.0, area=-1.0)
    assert undecided.text == "Undecided: all loop areas exceed -2 mm·K; the smallest one found is -1 mm·K."
    unknown = certify(replace(thesis_surface("two_p"), unit=""))
    assert unknown.text == certificate("two_p").text.replace(" deg·K", "").replace(" K", "")


# --- confirmation by the forward model ----------------------------------------------------------------


def test_a_negative_loop_repays_its_approach_in_the_forward_model():
    s = thesis_surface("two_p")
    found = confirm(s, certificate("two_p").at, "anhysteretic")
    assert found.confirmed
    assert found.approach > 1000
    assert found.cycles == math.ceil(found.approach / -found.per_cycle)
    balance = energy_balance(s, found.inputs(), "anhysteretic")
    assert balance.supplied[-1] == pytest.approx(found.balance, abs=1e-6)
    assert np.all(balance.supplied[2:-1:2] >= 0)  # at M, not one cycle earlier


@given(relays(SMALL))
def test_every_certified_violation_is_confirmed_and_nothing_else(values):
    h = measure_of(values)
    c = certify(h)
    if c.dissipative:
        with pytest.raises(UsageError, match="returns no energy"):
            confirm(h, (float(SMALL[-1]), float(SMALL[0])))
    else:
        assert confirm(h, c.at).confirmed


def test_a_loop_that_pays_too_little_is_refused():
    with pytest.raises(UsageError, match="would need more than 200000 cycles"):
        confirm(thesis_surface("one_p"), (85.0, 82.0))


def test_the_butterfly_gives_energy_back_on_its_negative_wing():
    for h in (butterfly_table(), butterfly_relays()):
        c = certify(h)
        assert not c.dissipative
        assert confirm(h, c.at).confirmed
        assert float(loop_area(h, 1.0, 0.0)) > 0.05 > -0.05 > float(loop_area(h, 0.0, -1.0))
        assert float(loop_area(h, 1.0, -1.0)) == pytest.approx(0.0, abs=1e-12)  # odd: the wings cancel


# --- Q_r as a storage function without μ ≥ 0 ----------------------------------------------------------


@pytest.mark.long("takes two seconds")
@given(relays(SMALL, low=-0.25), histories(SMALL), histories(SMALL))
@settings(max_examples=150)
def test_where_q_r_is_verified_a_storage_function_it_is_the_available_storage(values, history, then):
    operator, _ = run(values, history)
    h = operator.hysteresis
    if recoverable_energy_is_storage(h):
        stored = recoverable_energy(h, operator.state)
        assert stored >= -1e-9
        assert energy_balance(h, then, operator.state).holds
        assert available_storage(h, operator.state).value == pytest.approx(stored, abs=1e-9)


def test_q_r_is_verified_for_a_measure_with_a_negative_relay_and_not_for_every_dissipative_one():
    alpha, beta = [2.0, 2.0, 1.0, 1.0], [1.0, 0.5, 0.5, -1.0]
    assert recoverable_energy_is_storage(measure_of((alpha, beta, [1.0, -0.25, 0.5, 0.5])))
    alpha, beta = [0.5, 3.0], [-1.0, -3.0]
    assert certify(measure_of((alpha, beta, [1.0, -0.125]))).dissipative
    assert not recoverable_energy_is_storage(measure_of((alpha, beta, [1.0, -0.125])))


@pytest.mark.parametrize("name", THESIS_SURFACES)
def test_the_e_surfaces_are_passive_with_zero_bias_although_partly_negative(name):
    s = thesis_surface(name)
    assert recoverable_energy_is_storage(s) == (name in PASS)
    if name in PASS:
        rng = np.random.default_rng(8)
        operator = Preisach(s)
        for u in rng.uniform(s.lower, s.upper, 7):
            operator.step(float(u))
        stored = recoverable_energy(s, operator.state)
        assert stored > 0
        assert available_storage(s, operator.state, 33).value == pytest.approx(stored, rel=1e-10)
        assert available_storage(s, "anhysteretic", 33).value == pytest.approx(0.0, abs=1e-9)


# --- the parts, where a whole might forgive them ------------------------------------------------------


@pytest.mark.long("takes a second")
def test_available_storage_beyond_any_single_sweep():
    """Dense signed measures: from some states only an input that turns gets everything out."""
    i, j = np.tril_indices(SMALL.size, -1)
    turned = 0
    for seed in range(25):
        rng = np.random.default_rng(seed)
        mass = rng.normal(0.2, 0.6, i.size)
        while not certify(h := measure_of((SMALL[i], SMALL[j], mass))).dissipative:
            mass = np.where(mass < 0, 0.8 * mass, mass)
        game = Game.of(SMALL[i], SMALL[j], mass, SMALL)
        best = game.best()
        for history in rng.choice(SMALL, (4, 5)):
            operator, reference = run((SMALL[i], SMALL[j], mass), history.tolist())
            value = available_storage(h, operator.state).value
            assert value == pytest.approx(best[game.start[game.key(reference)]], abs=1e-9)
            turned += value > max(0.0, *(-work(h, operator.state, u) for u in SMALL.tolist())) + 1e-6
    assert turned >= 1


def test_strip_bounds_lie_below_every_strip_and_touch_a_constant_density():
    """Cells of constant signed density, where the strip moment is a sum over cells: no M, m below the bound."""
    rng = np.random.default_rng(9)
    n, h = 6, 0.5
    levels = np.arange(n + 1) * h
    low = np.tril(rng.normal(0, 1, (n, n)))
    gap = levels[:-1, None] - levels[:-1]
    near, far = h * np.maximum(gap - h / 2, 0), h * np.maximum(gap + h / 2, 0)
    cut = DensityCells(levels, low)
    across, along = cut.across(near, far), cut.along(near, far)
    fine = (np.arange(n * 40) + 0.5) * h / 40
    cell = np.arange(n * 40) // 40
    touched = 0
    for i, j in zip(*np.tril_indices(n, -1)):
        for s, t in rng.random((40, 2)) * h:
            top, bottom = levels[i] + s, levels[j] + t
            inside = (fine > bottom) & (fine < top)
            over = float((low[i, cell] * (top - fine))[inside].sum() * h / 40)
            beside = float((low[cell, j] * (fine - bottom))[inside].sum() * h / 40)
            assert over >= across[i, j] - 0.06
            assert beside >= along[i, j] - 0.06
            touched += over < across[i, j] + 0.5
    assert touched > 50


def test_strip_bounds_know_the_longer_lever_of_a_negative_cell():
    """One negative cell, crossed entirely: the bound takes the farthest M; ended in: it counts in full."""
    low = np.zeros((3, 3))
    low[2, 0] = -1.0
    near, far = np.full((3, 3), 1.0), np.full((3, 3), 2.0)
    bounds = DensityCells(np.arange(4.0), low)
    assert bounds.across(near, far)[2].tolist() == [-2.0, 0.0, 0.0]
    low[2, 0], low[2, 1] = 0.0, -1.0
    assert DensityCells(np.arange(4.0), low).across(near, far)[2].tolist() == [-2.0, -2.0, 0.0]


def test_the_shift_of_a_parabola_is_bounded_over_its_vertex():
    s = thesis_surface("two_p")
    a0, a1 = np.array([100.0, 140.0]), np.array([180.0, 150.0])
    f, slope = shift_bounds(s, Interval(a0, a1))
    inside, rates = s.shift(np.linspace(a0, a1, 101))
    assert np.all((inside >= f.low - 1e-12) & (inside <= f.high + 1e-12))
    assert np.all((rates >= slope.low - 1e-12) & (rates <= slope.high + 1e-12))


@pytest.mark.parametrize("seed", range(60))
def test_the_minimum_of_one_cell_is_found_inside_on_edges_and_at_corners(seed):
    rng = np.random.default_rng(seed)
    cell = AreaPolynomial(
        0.0, tuple(rng.normal(0, 1, 2)), tuple(rng.normal(0, 1, 2)), rng.normal(0, 2), rng.random()
    )
    if seed % 2:  # convex along both axes, downhill from the corner: the minimum is inside or on an edge
        a, b = rng.uniform(0.5, 2, (2, 2))
        cell = AreaPolynomial(0.0, (-a[0], a[1] + 0.5), (-b[0], b[1] + 0.5), rng.uniform(-0.4, 0.4), 0.3)
    least, s, t = cell.minimum(1.3, 0.9)
    dense = min(cell(x, y) for x in np.linspace(0, 1.3, 61) for y in np.linspace(0, 0.9, 61))
    assert least == cell(s, t)
    assert dense - 0.01 <= least <= dense + 1e-12


def test_available_storage_of_a_fall_that_is_followed_by_a_smaller_rise():
    """The fall takes 1.5 out of the negative relay and charges another with 0.75; a rise to −1.5 halves that."""
    alpha, beta, mass = [2.0, -1.5, 2.0], [-3.0, -3.0, 0.0], [-0.25, 0.125, 1.0]
    h = measure_of((alpha, beta, mass))
    assert certify(h).dissipative
    assert available_storage(h, "positive").value == pytest.approx(1.5 - 0.75 + 0.375)
    assert -work(h, Preisach(h, "positive").state, -3.0) == pytest.approx(0.75)
