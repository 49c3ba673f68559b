"""Chapter 4 for the six surfaces of Table 5.1: attained values, proved bounds, and the statements of
theory.md."""

import json
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from preisach.relay_reference import Printed, cells
from smarig.core.errors import UsageError
from smarig.preisach.hysteresis.fod_surface import FodSurface
from smarig.preisach.hysteresis.forc_curve import ForcCurve
from smarig.preisach.hysteresis.forc_table import ForcTable
from smarig.preisach.hysteresis.gorbet_1997 import THESIS_SURFACES, thesis_surface
from smarig.preisach.hysteresis.mirrored import Mirrored
from smarig.preisach.interval import Interval
from smarig.preisach.operator import Preisach
from smarig.theory.butterfly import butterfly_relays, butterfly_table
from smarig.theory.properties import enclosure, properties
from smarig.theory.properties import strip_integrals as strips
from smarig.theory.properties.branch_and_bound import least
from smarig.theory.properties.classes import classes
from smarig.theory.properties.continuity import lipschitz, modulus
from smarig.theory.properties.monotone import crossing_ascending, crossing_descending, monotone
from smarig.theory.properties.sweep_changes import largest_change, largest_setback
from smarig.theory.properties.triangle_grid import TriangleGrid
from smarig.theory.properties.variation import uncertainty
from theory.properties.planes import counterexample

MU_MIN = {"one_p": -6.9e-4, "one_e": -1.9e-3, "two_p": -2.5e-4, "two_e": -1.2e-4}  # theory.md §4
names = st.sampled_from(THESIS_SURFACES)
unit = st.floats(0, 1, width=32)


def points(s: FodSurface, seed: int, n: int = 40_000):
    """Random points of P_r, its edges included."""
    rng = np.random.default_rng(seed)
    alpha = rng.uniform(s.lower, s.upper, n)
    alpha[: n // 10] = s.upper
    beta = s.lower + rng.uniform(0, 1, n) * (alpha - s.lower)
    beta[: n // 5 : 2], beta[1 : n // 5 : 2] = s.lower, alpha[1 : n // 5 : 2]
    return alpha, beta


# --- classes, slopes, crossings -------------------------------------------------------------------------


@pytest.mark.parametrize("name", THESIS_SURFACES)
def test_table_5_2_with_proof(name):
    """M_PC / M_P as Table 5.2 has them; the least μ as theory.md §4 has it; no point lies beyond the bounds."""
    s, c = thesis_surface(name), classes(thesis_surface(name))
    printed = Printed(name)
    alpha, beta = points(s, 1)
    mu = printed.y_alpha_beta(alpha, beta) / 2
    assert c.M_PC
    assert name.endswith("_c") == c.M_P == c.positive
    assert c.mu_min.bound <= c.mu_min.value <= mu.min() + 1e-6 * mu.max()
    assert mu.min() >= c.mu_min.bound
    assert mu.max() <= c.mu_max.bound
    assert printed.y_alpha_beta(*map(np.array, c.mu_min.at)) / 2 == pytest.approx(c.mu_min.value, rel=1e-9)
    assert c.mu_max.bound - c.mu_max.value <= 1.1e-4 * c.mu_max.value
    assert c.mu_min.value - c.mu_min.bound <= 1.1e-6 * c.mu_max.value
    if name in MU_MIN:
        assert c.mu_min.value == pytest.approx(MU_MIN[name], rel=0.05)
    else:
        assert c.mu_min.bound > 0
    g = printed.y_beta(alpha, alpha)
    assert 0 <= c.g_min.bound <= g.min()
    assert g.max() <= c.g_max.bound <= 1.01 * c.g_max.value


@pytest.mark.parametrize("name", THESIS_SURFACES)
def test_slopes_with_proof(name):
    """Falling branches are monotone for all six, rising ones for all but two_p (theory.md §1)."""
    s, m = thesis_surface(name), monotone(thesis_surface(name))
    alpha, beta = points(s, 2)
    assert s.strip_alpha(alpha, beta).min() >= m.rising.bound
    assert s.strip_beta(alpha, beta).min() >= m.falling.bound >= 0
    assert m.holds == (name != "two_p")
    steepest = s.strip_alpha(alpha, beta).max()
    assert m.rising.value - m.rising.bound <= 2e-6 * max(steepest, abs(m.rising.value))
    if name == "two_p":
        assert m.rising.value == pytest.approx(-0.0367, abs=5e-5)
        assert 0.55 <= m.setback <= 0.57
    else:
        assert m.setback == 0.0


@pytest.mark.parametrize("name", THESIS_SURFACES)
def test_crossing_curves_of_the_thesis(name):
    """Only surfaces with negative regions have curves that cross, and each crossing is one of printed curves."""
    s, printed = thesis_surface(name), Printed(name)
    down, up = crossing_descending(s), crossing_ascending(s)
    if name.endswith("_c"):
        assert down is None
        assert up is None
        return
    assert down is not None
    assert printed.y(down.lower, down.at) - printed.y(down.higher, down.at) == pytest.approx(
        down.depth, rel=1e-9
    )
    assert down.lower < down.higher
    if up is not None:
        at = [Preisach(s).simulate([s.upper, turn, up.at])[-1] for turn in (up.lower, up.higher)]
        assert at[1] - at[0] == pytest.approx(up.depth, rel=1e-9)


def test_bounds_can_fail():
    """A search on a coarse grid alone misses the least μ; what is proved does not."""
    s = thesis_surface("one_e")
    a, b = np.meshgrid(*[np.linspace(s.lower, s.upper, 12)] * 2)
    coarse = s.density(a, b)[b <= a].min()
    assert coarse > 0.9 * classes(s).mu_min.value
    assert s.density(*points(s, 3)).min() < coarse


@settings(max_examples=40)
@given(names, unit, unit, st.floats(0, 0.5), unit, unit)
def test_enclosures_hold_their_boxes(name, at, down, size, p, q):
    """μ, g and both slopes at any point of a box lie in the interval of the box."""
    s = thesis_surface(name)
    span = s.upper - s.lower
    a0 = s.lower + at * span
    b0 = s.lower + down * span
    a1, b1 = min(a0 + size * span, s.upper), min(b0 + size * span, s.upper)
    alpha, beta = (Interval(np.array([x]), np.array([y])) for x, y in ((a0, a1), (b0, b1)))
    a, b = np.array([a0 + p * (a1 - a0)]), np.array([b0 + q * (b1 - b0)])
    for enclosed, value in (
        (enclosure.density(s, alpha, beta), s.density(a, b)),
        (enclosure.rise(s, alpha, beta), s.strip_alpha(a, b)),
        (enclosure.fall(s, alpha, beta), s.strip_beta(a, b)),
        (enclosure.reversible(s, beta), s.reversible(b)),
    ):
        slack = 1e-12 * enclosed.size
        assert np.all(enclosed.low - slack <= value)
        assert np.all(value <= enclosed.high + slack)


def test_enclosures_see_the_turn_of_a_parabola():
    """f of one_p turns at α = 119.6: in a box about it, the values of f at the ends do not bound those
    inside."""
    s = thesis_surface("one_p")
    alpha = Interval(np.array([69.6]), np.array([169.6]))
    for b in (0.0, 20.0, 60.0):
        beta = Interval(np.array([b]), np.array([b]))
        held, slopes = enclosure.fall(s, alpha, beta), s.strip_beta(np.linspace(69.6, 169.6, 99), b)
        assert held.low[0] <= slopes.min()
        assert slopes.max() <= held.high[0]


def test_a_bound_holds():
    """The bound is the enclosures', not the best value found: also when they never close in."""

    def one(a, b):
        return np.ones(a.shape)

    def from_below(a, b):
        return Interval(1 - a.width, np.ones(a.width.shape))

    closing = least(one, from_below, 0.0, 1.0, tolerance=0.01)
    assert closing.value == 1.0
    assert 0.99 <= closing.bound < 1.0
    never = least(one, lambda a, b: Interval(0 * a.low, 1 + 0 * a.low), 0.0, 1.0)
    assert (never.value, never.bound) == (1.0, 0.0)


def test_enclosures_can_fail():
    """An interval from the corners of a box alone does not hold it."""

    def corners(case):
        name, at, down, size = case
        s = thesis_surface(name)
        span = s.upper - s.lower
        a, b = s.lower + (at + np.array([0, size])) * span, s.lower + (down + np.array([0, size])) * span
        middle = s.density(a.mean(), b.mean())
        at_corners = s.density(a[:, None], b)
        return not at_corners.min() - 1e-9 <= middle <= at_corners.max() + 1e-9

    counterexample(st.tuples(names, unit, unit, st.floats(0.01, 0.5)), corners)


# --- changes ---------------------------------------------------------------------------------------------


@cache
def limits(name: str, xi: float) -> tuple[float, float, float]:
    """Every proved limit of a monotone input change ξ."""
    s = thesis_surface(name)
    return largest_change(s, xi, levels=32).bound, strips.bound(s, xi), constant(name) * xi


@cache
def constant(name: str) -> float:
    return lipschitz(thesis_surface(name))


@cache
def widest(name: str, xi: float) -> float:
    return modulus(thesis_surface(name), xi, levels=64).bound


@pytest.mark.long("takes a second")
@settings(max_examples=40)
@given(names, st.lists(st.integers(0, 32), min_size=2, max_size=8))
def test_no_sweep_exceeds_its_bound(name, steps):
    """The relays of the printed surface, driven anywhere: every move within the bounds of chapter 4."""
    s, printed = thesis_surface(name), Printed(name)
    levels = np.linspace(s.lower, s.upper, 33)
    y = cells(levels, printed.y, None).drive(levels[steps], printed.y_lower)
    du, dy = abs(float(levels[steps[-1]] - levels[steps[-2]])), abs(y[-1] - y[-2])
    slack = 1e-9 * printed.range
    assert dy <= min(limits(name, du)) + slack


@pytest.mark.parametrize("name", ["two_c", "one_e", "two_p"])
def test_largest_change_closes_in(name):
    """What finer grids attain stays below what coarser ones prove; the gap falls with the square of the cell."""
    s = thesis_surface(name)
    xi = (s.upper - s.lower) / 4
    coarse, fine = largest_change(s, xi, levels=32), largest_change(s, xi, levels=160)
    assert coarse.attained - 1e-9 <= fine.attained <= coarse.bound
    assert fine.bound <= coarse.bound
    doubt = [uncertainty(TriangleGrid.of(s, n)) for n in (64, 128, 256)]
    assert doubt[0] / doubt[1] > 3.0
    assert doubt[1] / doubt[2] > 3.5


def golden_maximum(f, low: float, high: float) -> float:
    """The largest value of a unimodal function, by golden section."""
    share = (np.sqrt(5) - 1) / 2
    a, b = high - share * (high - low), low + share * (high - low)
    for _ in range(70):
        if f(a) >= f(b):
            low, high, a, b = low, b, b - share * (b - low), a
        else:
            low, high, a, b = a, high, b, a + share * (high - a)
    return max(f(a), f(b))


@pytest.mark.parametrize("name", THESIS_SURFACES)
def test_K_is_the_largest_strip_to_rounding(name):
    """Against the printed surface, searched densely and refined: within 1e-12 for narrow and wide strips."""
    s, printed = thesis_surface(name), Printed(name)
    for xi in np.array([0.004, 1 / 16, 0.1234567, 1 / 4, 0.61803, 0.95]) * (s.upper - s.lower):
        lam = np.linspace(s.lower, s.upper - xi, 4001)
        best = 0.0
        for strip in (
            lambda x, xi=xi: printed.y(x + xi, x + xi) - printed.y(x, x),  # a rise along the major loop
            lambda x, xi=xi: printed.y(s.upper, x + xi) - printed.y(s.upper, x),  # a fall
        ):
            k = int(strip(lam).argmax())
            best = max(best, golden_maximum(strip, lam[max(k - 1, 0)], lam[min(k + 1, 4000)]))
        assert strips.K(s, xi) == pytest.approx(best, rel=1e-12)


def test_K_of_a_signed_surface_is_exceeded():
    """two_p: memory makes a change larger than K, so the strip's modulus is no bound."""
    s = thesis_surface("two_p")
    assert largest_change(s, 92.5).attained > 1.005 * strips.K(s, 92.5)
    assert largest_setback(s) > 0.5


@pytest.mark.long("takes two seconds")
@settings(max_examples=30)
@given(names, st.lists(unit, min_size=2, max_size=6), st.sampled_from([1 / 16, 1 / 4]), st.booleans())
def test_inputs_that_stay_together_keep_outputs_together(name, shares, part, up):
    s = thesis_surface(name)
    xi = part * (s.upper - s.lower)
    u = s.lower + np.array([*shares]) * (s.upper - s.lower)
    v = np.clip(u + (xi if up else -xi) * np.cos(np.arange(u.size)), s.lower, s.upper)
    difference = np.abs(Preisach(s).simulate(u) - Preisach(s).simulate(v)).max()
    assert difference <= widest(name, xi) <= constant(name) * xi


# --- the answer as a whole --------------------------------------------------------------------------------


@pytest.mark.long("takes a second")
def test_properties_in_one_answer():
    p = properties(thesis_surface("two_p"))
    assert (p.kind, p.lower, p.upper) == ("surface", -185.0, 185.0)
    assert p.y_upper == pytest.approx(18.1055)
    assert [c.xi for c in p.changes] == [23.125, 46.25, 92.5, 185.0, 370.0]
    for c in p.changes:
        assert c.largest.attained >= c.K - 1e-12
        assert c.largest.attained <= c.largest.bound <= p.lipschitz * c.xi
        assert c.largest.attained <= c.modulus.attained <= c.modulus.bound <= p.lipschitz * c.xi
    text = repr(p)
    assert "M_PC yes, M_P no" in text
    assert "-0.000251 at (185, 3.659)" in text
    assert "output follows input no, up to 0.562 deg against it" in text
    assert "output -16.5234 … 18.1055 deg" in text


def test_properties_as_json():
    """Plain values, nothing that JSON lacks: relays have no C, a hysteresis without g no g."""
    plain = properties(butterfly_relays(8)).to_json()
    again = json.loads(json.dumps(plain, allow_nan=False))
    assert again == plain
    assert plain["lipschitz"] is None
    assert plain["classes"]["g_min"]["value"] is None
    assert plain["classes"]["M_P"] is False
    assert plain["monotone"]["holds"] is False
    assert len(plain["changes"]) == 5


@pytest.mark.long("takes two seconds")
def test_the_mirror_turns_places_and_keeps_sizes():
    s = thesis_surface("two_p")
    here, there = properties(s), properties(Mirrored(s))
    assert there.monotone.falling.value == here.monotone.rising.value
    assert there.classes.mu_min.at == (-here.classes.mu_min.at[1], -here.classes.mu_min.at[0])
    assert there.lipschitz == here.lipschitz
    assert here.fod_crossing
    assert there.foa_crossing
    assert there.foa_crossing.depth == pytest.approx(here.fod_crossing.depth)
    for a, b in zip(here.changes, there.changes):
        assert b.largest.attained == pytest.approx(a.largest.attained)
        assert b.modulus.bound == pytest.approx(a.modulus.bound)


@pytest.mark.long
def test_sampled_hystereses_have_no_bounds():
    """A hysteresis known only by its values is evaluated on a grid and has no bounds."""
    down = np.linspace(1.0, 0.0, 9)
    forc = ForcTable.from_curves([ForcCurve(a, a * down, a**2 * down) for a in (1.0, 2.0, 3.0)])
    p = properties(forc)
    assert p.kind == "sampled"
    assert np.isnan(p.lipschitz)
    assert all(np.isnan([c.bound, c.largest.bound, c.modulus.bound]).all() for c in p.changes[:-1])
    assert pytest.approx(9.0) == p.changes[-1].K
    assert "?" in repr(p)
    json.dumps(p.to_json(), allow_nan=False)


# --- butterfly ---------------------------------------------------------------------------------------------


def test_the_butterfly_has_two_wings():
    """Fig. 7.5: a falling field first lowers the strain, then raises it; the rising branch is the mirror image."""
    table = butterfly_table(levels=24, upper=2.0, coercive=0.25)
    op = Preisach(table)
    u = np.linspace(-2.0, 2.0, 97)
    rising, falling = op.simulate(u), op.simulate(u[::-1], "positive")
    assert rising == pytest.approx(falling, abs=1e-12)  # sampled the other way round: y(−u)
    lowest = int(rising.argmin())
    assert rising[lowest] == pytest.approx(-1.0)
    assert 0.2 < u[lowest] < 0.8
    assert np.all(np.diff(rising[: lowest + 1]) <= 1e-12)
    assert np.all(np.diff(rising[lowest:]) >= -1e-12)
    assert abs(op.reset("positive") - op.reset("negative")) < 1e-12
    c = classes(table)
    assert c.M_PC
    assert not c.M_P
    assert c.mu_min.value == pytest.approx(-c.mu_max.value, rel=1e-12)
    assert not monotone(table).holds
    assert crossing_descending(table) is not None


def test_the_butterfly_is_made_of_relays():
    """Table and relays agree on the levels; a butterfly with positive relays only has no second wing."""
    table, relays = butterfly_table(16), butterfly_relays(16)
    u = np.random.default_rng(5).choice(table.nodes, 200)
    assert Preisach(table).simulate(u) == pytest.approx(Preisach(relays).simulate(u), abs=1e-12)
    unsigned = Preisach.from_measure(relays.alpha, relays.beta, np.abs(relays.mass))
    assert np.all(np.diff(unsigned.simulate(table.nodes)) >= -1e-12)


@pytest.mark.parametrize("wrong", [{"levels": 3}, {"upper": 0.0}, {"coercive": 1.0}])
def test_what_is_no_butterfly_is_refused(wrong):
    with pytest.raises(UsageError, match="A butterfly needs at least 4 levels"):
        butterfly_table(**wrong)
