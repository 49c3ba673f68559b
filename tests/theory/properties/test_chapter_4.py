"""Chapter 4, number by number, on random measures; every numbered one with an injected violation it must find.

Def. 4.1    test_definition_4_1_classes                     injected: one negative cell, one negative g, atoms
H, V        test_strips_are_sums_of_relays                  injected: μ alone, without g; without the 2
ν           test_masses_of_cells                            (not numbered in the thesis; used by the others)
K           test_K_is_the_largest_change_for_positive_measures   injected: a signed measure with the unsigned bound
|ν|         test_the_signed_bound_holds                     injected: K, the modulus of whole strips
exact       test_the_largest_change_is_exact                injected: the largest change from saturation only
Lemma 4.1   test_lemma_4_1_k_is_continuous                  injected: relays (atoms)
Lemma 4.2   test_lemma_4_2_1, _2, _3                        injected: relays; C without g
Thm 4.3     test_theorem_4_3_continuity                     injected: relays; the printed step K(|u₂ − u₁|)
ω           test_modulus_of_continuity, test_the_modulus_is_met  injected: K for ω; relays of |ν| left out
Thm 4.4     test_theorem_4_4_only_if                        injected: K(ξ) = √ξ, no C
Cor. 4.5    test_corollary_4_5_sobolev                      injected: C without g
Ass. 2.1    test_assumption_2_1                             injected: a negative cell
Prop. 4.6   test_proposition_4_6                            injected: crossing curves; the converse
"""

from itertools import pairwise, product

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from smarig.core.errors import UsageError
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.hysteresis.mirrored import Mirrored
from smarig.preisach.hysteresis.relay_measure import RelayMeasure
from smarig.preisach.operator import Preisach
from smarig.theory.properties import strip_integrals as strips
from smarig.theory.properties.classes import classes
from smarig.theory.properties.continuity import lipschitz, modulus
from smarig.theory.properties.monotone import crossing_ascending, crossing_descending, monotone
from smarig.theory.properties.sweep_changes import largest_change, largest_setback
from smarig.theory.properties.triangle_grid import masses
from theory.properties.planes import (
    Lattice,
    counterexample,
    driven,
    histories,
    lattices,
)

TOLERANCE = 1e-12
shares = st.integers(0, 16).map(lambda k: k / 16)
HALVES, WHOLES = (np.array(list(product(np.arange(n) / k, repeat=5))) for n, k in ((7, 2), (4, 1)))
some_shares = st.integers(1, 16).map(lambda k: k / 16)


def strip_of_relays(lattice: Lattice, low: float, high: float, *, horizontal: bool, diagonal=True) -> float:
    """Σ ν over relays with α in (low, high], or β in [low, high), on points of the lattice; no F, no sweep."""
    relays = lattice.relays(4)
    inside = (
        (relays.alpha > low + 1e-9) & (relays.alpha <= high + 1e-9)
        if horizontal
        else (relays.beta >= low - 1e-9) & (relays.beta < high - 1e-9)
    )
    if not diagonal:
        cell = np.searchsorted(lattice.levels, relays.alpha) == np.searchsorted(
            lattice.levels, relays.beta, side="right"
        )
        inside &= ~cell
    return float(relays.nu[inside].sum())


@st.composite
def strips_on_points(draw, **kind):
    lattice = draw(lattices(**kind))
    points = lattice.points(4).tolist()
    low, high = sorted(draw(st.lists(st.sampled_from(points), min_size=2, max_size=2)))
    return lattice, low, high


# --- Definition 4.1 ------------------------------------------------------------------------------------


@given(lattices())
def test_definition_4_1_classes(lattice):
    """M_PC for every table, M_P when no cell is negative, ν ≥ 0 when no diagonal cell is either; the place."""
    c, w = classes(lattice.table()), np.diff(lattice.levels)
    off = np.tri(w.size, k=-1, dtype=bool)
    assert c.M_PC
    assert bool(np.all(lattice.nu[off] >= 0)) == c.M_P
    assert c.positive == bool(np.all(lattice.nu >= 0))
    assert c.g_min.value == pytest.approx((np.diag(lattice.nu) / w).min(), abs=TOLERANCE)
    i, j = (int(np.searchsorted(lattice.levels, x)) - 1 for x in c.mu_min.at)
    assert lattice.nu[i, j] / (2 * w[i] * w[j]) == pytest.approx(c.mu_min.value, abs=TOLERANCE)
    mirror = classes(Mirrored(lattice.table()))
    assert mirror.mu_min.at == (-c.mu_min.at[1], -c.mu_min.at[0])


@given(lattices())
def test_atoms_have_no_density(lattice):
    """Relays: no class, but the sign of every mass."""
    c = classes(lattice.measure())
    assert not c.M_PC
    assert not c.M_P
    assert c.positive == bool(np.all(lattice.nu >= 0))


def test_definition_4_1_can_fail():
    counterexample(lattices(reversible=False), lambda p: not classes(p.table()).M_P)
    counterexample(lattices(), lambda p: classes(p.table()).M_P and not classes(p.table()).positive)


# --- strips --------------------------------------------------------------------------------------------


@given(strips_on_points())
def test_strips_are_sums_of_relays(case):
    lattice, low, high = case
    table = lattice.table()
    for horizontal, strip in ((True, strips.H), (False, strips.V)):
        expected = strip_of_relays(lattice, low, high, horizontal=horizontal)
        assert float(strip(table, low, high - low)) == pytest.approx(expected, abs=TOLERANCE * lattice.scale)
    assert float(strips.k(table, low, high - low)) == pytest.approx(
        max(strip_of_relays(lattice, low, high, horizontal=h) for h in (True, False)),
        abs=TOLERANCE * lattice.scale,
    )


@given(strips_on_points(), st.sampled_from(["H", "V"]))
def test_strips_are_output_changes_of_sweeps(case, which):
    """H is a rise from negative saturation, V a fall from positive: of relays, thresholds and ties included."""
    lattice, low, high = case
    measure = lattice.measure()
    start, path = ("negative", [low, high]) if which == "H" else ("positive", [high, low])
    y = Preisach(measure).simulate(path, start)
    strip = {"H": strips.H, "V": strips.V}[which](measure, low, high - low)
    assert abs(float(strip)) == pytest.approx(abs(y[1] - y[0]), abs=TOLERANCE * lattice.scale)


def test_strips_can_fail():
    def without_g(case):
        lattice, low, high = case
        mu_alone = strip_of_relays(lattice, low, high, horizontal=True, diagonal=False)
        return abs(float(strips.H(lattice.table(), low, high - low)) - mu_alone) > 0.05

    def without_2(case):
        lattice, low, high = case
        half = strip_of_relays(lattice, low, high, horizontal=True) / 2
        return abs(float(strips.H(lattice.table(), low, high - low)) - half) > 0.05

    counterexample(strips_on_points(), without_g)
    counterexample(strips_on_points(), without_2)


def test_strips_outside_the_range_are_refused():
    table = Lattice(np.arange(3.0), np.ones((2, 2))).table()
    with pytest.raises(UsageError, match=r"must lie inside the input range \[0, 2\]"):
        strips.H(table, 1.5, 1.0)
    for function in (strips.K, strips.bound, largest_change, modulus):
        with pytest.raises(
            UsageError, match="An input change ξ = 3 must lie between 0 and the input range 2"
        ):
            function(table, 3.0)


@given(lattices())
def test_masses_of_cells(lattice):
    """ν cell by cell: of table and relays alike, on finer and mirrored lattices."""
    u, slack = lattice.levels, TOLERANCE * lattice.scale
    assert masses(lattice.table(), u) == pytest.approx(lattice.nu, abs=slack)
    counted = masses(
        lattice.measure(), np.append(u, u[-1] + 1)
    )  # a relay belongs to the cell above its level
    shifted = counted[1:, :-1] + np.diag(np.diag(counted)[:-1])
    assert np.tril(shifted) == pytest.approx(lattice.nu, abs=slack)
    halves = np.add.reduceat(
        np.add.reduceat(masses(lattice.table(), lattice.points(2)), u_starts(u), 0), u_starts(u), 1
    )
    assert halves == pytest.approx(lattice.nu, abs=slack)
    mirrored = masses(Mirrored(lattice.table()), -u[::-1])
    for i, j in np.argwhere(np.tri(len(lattice.nu))):
        assert mirrored[-1 - j, -1 - i] == pytest.approx(lattice.nu[i, j], abs=slack)


def u_starts(levels: np.ndarray) -> np.ndarray:
    """Where each cell begins on a lattice twice as fine."""
    return np.arange(0, 2 * (levels.size - 1), 2)


# --- the largest change of a monotone input change -----------------------------------------------------


@st.composite
def last_moves(draw, **kind):
    """A lattice and a history whose last move is evaluated."""
    lattice = draw(lattices(**kind))
    return lattice, [*draw(histories(lattice, 3)), draw(st.sampled_from(lattice.points(3).tolist()))]


def last_move(case) -> tuple[float, float]:
    """|Δu| and |Δy| of the last move, relay by relay."""
    lattice, inputs = case
    y = lattice.relays(3).drive(inputs, 0.0)
    return abs(inputs[-1] - inputs[-2]), abs(float(y[-1] - y[-2]))


@given(last_moves(signed=False), st.sampled_from(["table", "measure"]))
def test_K_is_the_largest_change_for_positive_measures(case, kind):
    lattice, inputs = case
    if kind == "measure":
        h = lattice.measure()
        y = Preisach(h).simulate(inputs)
        du, dy = abs(inputs[-1] - inputs[-2]), abs(y[-1] - y[-2])
    else:
        h = lattice.table()
        du, dy = last_move(case)
    assert dy <= strips.K(h, du) + TOLERANCE * lattice.scale
    assert largest_change(h, du).attained == pytest.approx(strips.K(h, du), abs=TOLERANCE * lattice.scale)


def test_K_can_fail():
    """A signed measure with the unsigned bound: a sweep over part of a strip does more than the strip."""

    def violated(case):
        du, dy = last_move(case)
        return dy > strips.K(case[0].table(), du) + 0.1

    counterexample(last_moves(), violated)


@given(last_moves())
def test_the_signed_bound_holds(case):
    """|Δy| ≤ largest change ≤ 2∬|μ| + ∫|g| over the widest strip."""
    table, slack = case[0].table(), TOLERANCE * case[0].scale
    du, dy = last_move(case)
    largest = largest_change(table, du)
    assert dy <= largest.attained + slack
    assert largest.attained == largest.bound
    assert largest.bound <= strips.bound(table, du) + slack
    relays = case[0].measure()
    assert largest_change(relays, du).bound <= strips.bound(relays, du) + slack


def test_the_signed_bound_can_fail():
    """The modulus of whole strips, |H| and |V|, is no bound: a chequered measure has none of either."""
    nu = np.zeros((4, 4))
    nu[2:, :2] = [[1.0, -1.0], [-1.0, 1.0]]
    chequered = Lattice(np.arange(5.0), nu)
    lam = np.arange(0.0, 4.0)
    assert not np.any(np.abs([strip(chequered.table(), lam, 1.0) for strip in (strips.H, strips.V)]))

    def more_than_nothing(inputs):
        du, dy = last_move((chequered, [0.0, *inputs]))
        return du <= 1.0 and dy > 0.5

    counterexample(histories(chequered), more_than_nothing)


def drive_all(lattice: Lattice, inputs: np.ndarray) -> np.ndarray:
    """Outputs of the relays of many histories (k, n) at once, each from all relays off."""
    relays = lattice.relays()
    on, u, out = np.zeros((len(inputs), relays.nu.size), dtype=bool), np.full(len(inputs), relays.u), []
    for now in inputs.T:
        on |= (now > u)[:, None] & (relays.alpha <= now[:, None])
        on &= ~((now < u)[:, None] & (relays.beta >= now[:, None]))
        u = now
        out.append(on @ relays.nu)
    return np.array(out).T


def changes_by_brute_force(lattice: Lattice, inputs: np.ndarray) -> dict[float, float]:
    """Largest |Δy| by |Δu| of the last move, over all these histories (k, n)."""
    y = drive_all(lattice, inputs)
    du, dy = np.abs(inputs[:, -1] - inputs[:, -2]), np.abs(y[:, -1] - y[:, -2])
    return {float(x): float(dy[du == x].max()) for x in np.unique(du)}


@settings(max_examples=25)
@given(lattices(sizes=(3, 3), even=True))
@example(Lattice(np.arange(4.0), np.array([[-0.5, 0, 0], [-0.5, 1.0, 0], [0, -0.5, -0.5]])))
def test_the_largest_change_is_exact(lattice):
    """Relays on four thresholds: every history of five inputs on and between them, switched one by one.

    A table may do more than its relays between the nodes, where F(λ + ξ, λ) bends, never less on them.
    """
    relays, slack = lattice.relays(), TOLERANCE * lattice.scale
    measure = RelayMeasure.from_arrays(relays.alpha, relays.beta, relays.nu / 2)
    for xi, found in changes_by_brute_force(lattice, HALVES + lattice.levels[0]).items():
        attained = largest_change(measure, xi).attained
        assert attained >= found - slack
        if xi == int(xi):  # then nothing happens but at and between levels; else at quarters too
            assert attained <= found + slack
    for xi, found in changes_by_brute_force(lattice, WHOLES + lattice.levels[0]).items():
        assert largest_change(lattice.table(), xi).attained >= found - slack


def test_the_largest_change_can_fail():
    """What saturation gives is not the largest change: memory can add to it."""

    def from_saturation(lattice):
        xi = lattice.span / 3
        lam = np.linspace(lattice.levels[0], lattice.levels[-1] - xi, 200)
        straight = max(np.abs(s(lattice.table(), lam, xi)).max() for s in (strips.H, strips.V))
        return largest_change(lattice.table(), xi).attained > straight + 0.1

    counterexample(lattices(), from_saturation)


# --- Lemmas 4.1 and 4.2 --------------------------------------------------------------------------------


@st.composite
def two_strips(draw):
    """A lattice, two strips near one another, by shares of the span."""
    lattice = draw(lattices())
    xi = draw(shares) * lattice.span
    lam = lattice.levels[0] + draw(shares) * (lattice.span - xi)
    return lattice, lam, xi, draw(st.floats(0, 0.02)) * lattice.span


def jump_of_k(h, lam, xi, step) -> float:
    """|k(λ, ξ) − k(λ + δ, ξ − δ)|: both variables move by δ."""
    step = min(step, xi)
    return abs(float(strips.k(h, lam, xi)) - float(strips.k(h, lam + step, xi - step)))


@given(two_strips())
def test_lemma_4_1_k_is_continuous(case):
    """Moving one edge of a strip by δ changes k by at most C δ."""
    lattice, lam, xi, step = case
    C = lipschitz(lattice.table())
    assert jump_of_k(lattice.table(), lam, xi, step) <= C * step + TOLERANCE * lattice.scale


def test_lemma_4_1_can_fail():
    """Relays are no function μ: k jumps, however small the step."""
    counterexample(
        two_strips(), lambda case: jump_of_k(case[0].measure(), case[1], case[2], 1e-9 * case[0].span) > 0.05
    )


@given(lattices())
def test_lemma_4_2_1_nothing_for_nothing(lattice):
    for h in (lattice.table(), lattice.measure()):
        assert strips.K(h, 0.0) == 0.0
        assert strips.bound(h, 0.0) == 0.0
        assert largest_change(h, 0.0).attained == 0.0


@given(lattices(), some_shares, st.floats(0, 0.02))
def test_lemma_4_2_2_K_is_continuous(lattice, share, step):
    table, xi = lattice.table(), share * lattice.span
    step = min(step * lattice.span, xi)
    change = abs(strips.K(table, xi) - strips.K(table, xi - step))
    assert change <= 2 * lipschitz(table) * step + TOLERANCE * lattice.scale


def test_lemma_4_2_2_can_fail():
    """With relays K(0) = 0 but K(0+) is the mass of the heaviest threshold."""
    counterexample(lattices(signed=False), lambda p: strips.K(p.measure(), 1e-9 * p.span) > 0.1)


def without_g(lattice: Lattice) -> float:
    """C of Lemma 4.2 as printed: 2M(u₊ − u₋), with M barely above max|μ|."""
    c = classes(lattice.table())
    return 2 * 1.001 * max(abs(c.mu_min.value), abs(c.mu_max.value)) * lattice.span


@settings(max_examples=30)
@given(lattices(), shares)
def test_lemma_4_2_3_K_is_below_C_xi(lattice, share):
    table, xi = lattice.table(), share * lattice.span
    C, slack = lipschitz(table), TOLERANCE * lattice.scale
    assert strips.K(table, xi) <= C * xi + slack
    assert largest_change(table, xi).bound <= C * xi + slack
    assert modulus(table, xi, levels=48).attained <= C * xi + slack


def test_lemma_4_2_3_can_fail():
    counterexample(
        lattices(signed=False), lambda p: strips.K(p.table(), p.span / 16) > without_g(p) * p.span / 16 + 0.01
    )
    assert lipschitz(Lattice(np.arange(3.0), np.ones((2, 2))).measure()) == np.inf


# --- Theorem 4.3: continuity ---------------------------------------------------------------------------


def stretch(case) -> tuple[float, float, float]:
    """Over the last moves of a history: how far the input went, net and in all, and the net output change."""
    lattice, past, rest = case
    y = lattice.relays(3).drive([*past, *rest], 0.0)
    path = [past[-1], *rest]
    return abs(path[-1] - path[0]), max(path) - min(path), abs(float(y[-1] - y[len(past) - 1]))


@st.composite
def stretches(draw, **kind):
    lattice = draw(lattices(**kind))
    return lattice, draw(histories(lattice, 3)), draw(histories(lattice, 3, longest=5))


@settings(max_examples=30)
@given(stretches())
def test_theorem_4_3_continuity(case):
    """While the input stays within ξ, the output stays within ω(ξ) ≤ Cξ: continuous in, continuous out."""
    table, slack = case[0].table(), TOLERANCE * case[0].scale
    _, within, change = stretch(case)
    assert change <= modulus(table, within, levels=48).bound + slack
    assert change <= lipschitz(table) * within + slack


@given(stretches(signed=False))
def test_theorem_4_3_for_positive_measures_by_K(case):
    """For ν ≥ 0 already K of the range of the input bounds the output change."""
    _, within, change = stretch(case)
    assert change <= strips.K(case[0].table(), within) + TOLERANCE * case[0].scale


def test_theorem_4_3_as_printed_can_fail():
    """The printed step |y(t₂) − y(t₁)| ≤ K(|u(t₂) − u(t₁)|) overlooks that inputs come back: memory remains."""

    def printed(case):
        net, _, change = stretch(case)
        return change > strips.K(case[0].table(), net) + 0.1

    counterexample(stretches(signed=False), printed)


def test_theorem_4_3_can_fail_for_relays():
    """A relay turns a step as small as one likes into one that is not."""
    lattice = Lattice(np.arange(4.0), np.tril(np.ones((3, 3))))
    y = Preisach(lattice.measure()).simulate([0.0, 2.0 - 1e-9, 2.0])
    assert y[2] - y[1] > 0.9


# --- modulus of continuity -----------------------------------------------------------------------------


@st.composite
def neighbours(draw, **kind):
    """A lattice, a common past, and two continuations no further than ξ apart at any time."""
    lattice = draw(lattices(**kind))
    past = draw(histories(lattice, 2, longest=4))
    xi = draw(some_shares) * lattice.span
    one, other = [], []
    for u in draw(histories(lattice, 4, longest=8)):
        v = u + draw(st.sampled_from([-1.0, -0.5, 0.0, 0.5, 1.0])) * xi
        one.append(u)
        other.append(min(max(v, float(lattice.levels[0])), float(lattice.levels[-1])))
    return lattice, xi, [*past, *one], [*past, *other]


def apart(h, case) -> float:
    return float(np.max(np.abs(Preisach(h).simulate(case[2]) - Preisach(h).simulate(case[3]))))


@settings(max_examples=30)
@given(neighbours(), st.sampled_from(["table", "measure"]))
def test_modulus_of_continuity(case, kind):
    lattice, xi = case[:2]
    h = lattice.table() if kind == "table" else lattice.measure()
    omega = modulus(h, xi, levels=48)
    assert apart(h, case) <= omega.bound + TOLERANCE * lattice.scale
    assert omega.attained <= omega.bound
    assert largest_change(h, xi).attained <= omega.attained


def test_modulus_of_continuity_can_fail():
    """K, the largest change of one monotone move, is no modulus: two inputs part along their whole past."""

    def parallel(case):
        lattice, inputs = case
        xi, high = lattice.span / 4, float(lattice.levels[-1])
        moved = [min(u + xi, high) for u in [high, *inputs]]
        return (
            apart(lattice.table(), (lattice, xi, [high, *inputs], moved))
            > strips.K(lattice.table(), xi) + 0.05
        )

    counterexample(driven(signed=False), parallel)


def test_modulus_with_signs_can_fail():
    """For signed ν what inputs ξ apart attain in parallel is not all: the bound needs |ν|."""

    def signed_mass_only(case):
        return apart(case[0].measure(), case) > abs(case[0].nu.sum()) + 0.1

    counterexample(neighbours(), signed_mass_only)


@given(lattices(signed=False, sizes=(3, 3), even=True), st.integers(1, 3))
def test_the_modulus_is_met(lattice, k):
    """All histories of five levels, one input k levels above the other, relay by relay: what modulus attains."""
    off_diagonal = Lattice(lattice.levels, np.tril(lattice.nu, k=-1))
    inputs = WHOLES + lattice.levels[0]
    low, high = off_diagonal.levels[0], off_diagonal.levels[-1]
    through = np.hstack([np.tile([high + k, low], (len(inputs), 1)), inputs])
    y, moved = drive_all(off_diagonal, through), drive_all(off_diagonal, np.minimum(through + k, high + k))
    brute = float(np.abs(moved - y)[:, -1].max())
    found = modulus(off_diagonal.measure(), float(k), levels=3).attained
    assert found == pytest.approx(brute, abs=TOLERANCE * lattice.scale)


def test_modulus_closes_in():
    """For ν ≥ 0 attained and bound close in on one another as 1/k."""
    rng = np.random.default_rng(2)
    table = Lattice(np.arange(7.0), np.tril(rng.uniform(0, 1, (6, 6)))).table()
    gaps = [(w := modulus(table, 1.5, levels=n)).bound / w.attained - 1 for n in (24, 96, 384)]
    assert gaps[0] > 2.5 * gaps[1] > 6 * gaps[2] > 0
    assert gaps[2] < 0.02


# --- Theorem 4.4 and Corollary 4.5: W₁² ----------------------------------------------------------------


def energies(h, u: np.ndarray, dt: np.ndarray) -> tuple[float, float]:
    """Σ(Δu)²/Δt and Σ(Δy)²/Δt: ∫u̇² of the piecewise linear input, and ∫ẏ² from below."""
    y = Preisach(h).simulate(u)
    return float(np.sum(np.diff(u) ** 2 / dt)), float(np.sum(np.diff(y) ** 2 / dt))


@st.composite
def signals(draw, **kind):
    lattice = draw(lattices(**kind))
    knots = draw(histories(lattice, 2, longest=6))
    u = np.concatenate([np.linspace(a, b, 9)[:-1] for a, b in pairwise([lattice.levels[0], *knots])])
    dt = np.repeat(draw(st.lists(st.floats(0.1, 10), min_size=len(knots), max_size=len(knots))), 8) / 8
    return lattice, np.append(u, knots[-1]), dt


@given(signals(signed=False))
def test_corollary_4_5_sobolev(case):
    """∫ẏ² ≤ C²∫u̇²: the operator keeps W₁² (g included)."""
    lattice, u, dt = case
    C = lipschitz(lattice.table())
    moved, answered = energies(lattice.table(), u, dt)
    assert answered <= C**2 * moved * (1 + 1e-12) + TOLERANCE


def test_corollary_4_5_can_fail():
    def violated(case):
        drawn, u, dt = case
        lattice = Lattice(drawn.levels, drawn.nu * np.where(np.eye(len(drawn.nu)), 1, 1 / 32))
        moved, answered = energies(lattice.table(), u, dt)
        return answered > without_g(lattice) ** 2 * moved + 0.1

    counterexample(signals(signed=False), violated)


def root_table(n: int) -> FodTable:
    """y = √u, reversible, as a table of n cells whose outputs are even: K(ξ) = √ξ for ξ = (j/n)²."""
    y = np.linspace(0.0, 1.0, n + 1)
    return FodTable.from_arrays(y**2, y**2, np.where(np.tri(n + 1, dtype=bool), y, np.nan))


def test_theorem_4_4_only_if():
    """√u is continuous, so Thm 4.3 holds; but no C serves, and u = t has an output without finite ∫ẏ²."""
    ns = (8, 64, 512)
    energy, constants = [], []
    for n in ns:
        table = root_table(n)
        for j in (1, 2, n // 2):
            assert strips.K(table, (j / n) ** 2) == pytest.approx(j / n, rel=1e-12)
        u = np.linspace(0.0, 1.0, n + 1) ** 2
        constants.append(lipschitz(table))
        energy.append(energies(table, u, np.diff(u))[1])
    assert np.allclose(constants, ns)  # C = max g = n: unbounded
    assert np.diff(energy) == pytest.approx(np.log(8) / 2, rel=0.05)  # ∫ dt/4t over ever more of (0, 1]
    smooth = [
        energies(Lattice(u, np.diag(np.diff(u))).table(), u, np.diff(u))[1] for u in (np.linspace(0, 1, 9),)
    ]
    assert smooth == pytest.approx([1.0])


# --- Assumption 2.1 and Proposition 4.6 ----------------------------------------------------------------


@given(lattices(), st.sampled_from(["table", "measure"]))
def test_assumption_2_1(lattice, kind):
    """Least slopes are where the strips of single rows and columns are least; they decide the sign of all moves."""
    h = lattice.table() if kind == "table" else lattice.measure()
    m, w = monotone(h), np.diff(lattice.levels)
    partial = np.cumsum(lattice.nu[:, ::-1], axis=1)[:, ::-1]  # ν of row i from column j to the diagonal
    rows = np.where(np.tri(w.size, dtype=bool), partial, np.inf)
    if kind == "table":
        assert m.rising.value == pytest.approx((rows / w[:, None]).min(), abs=TOLERANCE * lattice.scale)
        assert (m.rising.value >= 0) == bool(np.all(rows >= 0))
    assert m.holds == (m.setback <= TOLERANCE * lattice.scale)
    mirrored = monotone(Mirrored(h))
    assert mirrored.falling == m.rising.mirrored_place()


@given(driven(parts=3))
def test_no_move_goes_back_further_than_the_setback(case):
    lattice, inputs = case
    y = np.concatenate([[0.0], lattice.relays(3).drive(inputs, 0.0)])
    against = -np.diff(y) * np.sign(np.diff([lattice.levels[0], *inputs]))
    assert against.max() <= largest_setback(lattice.table()) + TOLERANCE * lattice.scale


@given(lattices(sizes=(3, 3)))
def test_the_setback_is_met(lattice):
    inputs = np.array(list(product(lattice.levels, repeat=5)))
    y = drive_all(lattice, inputs)
    against = -(y[:, -1] - y[:, -2]) * np.sign(inputs[:, -1] - inputs[:, -2])
    assert largest_setback(lattice.table()) == pytest.approx(
        max(0.0, against.max()), abs=TOLERANCE * lattice.scale
    )


def test_assumption_2_1_can_fail():
    counterexample(lattices(), lambda p: not monotone(p.table()).holds and largest_setback(p.measure()) > 0.1)


def descending(lattice: Lattice) -> np.ndarray:
    """FOD curves between levels, relay by relay: row α_i, column β_j ≤ α_i, NaN elsewhere."""
    n = lattice.levels.size
    y = np.full((n, n), np.nan)
    for i in range(n):
        inputs = [lattice.levels[i], *lattice.levels[: i + 1][::-1]]
        y[i, : i + 1] = lattice.relays().drive(inputs, 0.0)[1:][::-1]
    return y


def deepest_crossing(lattice: Lattice) -> float:
    y, deepest = descending(lattice), 0.0
    for low in range(len(y)):
        for high in range(low + 1, len(y)):
            deepest = max(deepest, float(np.max((y[low] - y[high])[: low + 1])))
    return deepest


@given(lattices())
def test_proposition_4_6(lattice):
    """Crossing curves prove a negative μ, in the rectangle named; without one none cross. FOA is the mirror."""
    table = lattice.table()
    found = crossing_descending(table)
    assert (found.depth if found else 0.0) == pytest.approx(deepest_crossing(lattice), abs=1e-12)
    for crossing in (found, crossing_ascending(table)):
        if crossing is not None:
            assert not classes(table).M_P
        if classes(table).M_P:
            assert crossing is None
    if found is not None:
        u = lattice.levels
        rows, columns = (u[:-1] >= found.lower) & (u[1:] <= found.higher), u[1:] <= found.at
        assert lattice.nu[np.ix_(rows, columns)].sum() == pytest.approx(-found.depth, abs=1e-12)
    ascending, turned = crossing_ascending(table), crossing_descending(Mirrored(table))
    assert (ascending is None) == (turned is None)
    assert ascending is None or turned is None or ascending.at == -turned.at


def test_proposition_4_6_can_fail():
    """A negative cell makes curves cross; and the converse is not true: μ < 0 although none cross."""
    counterexample(lattices(), lambda p: crossing_descending(p.table()) is not None)
    nu = np.zeros((4, 4))
    nu[2, 1], nu[2, 0], nu[3, 1] = -0.5, 1.0, 1.0  # whatever reaches to a saturation is positive
    hidden = Lattice(np.arange(5.0), nu).table()
    assert classes(hidden).mu_min.value == -0.25
    assert crossing_descending(hidden) is None
    assert crossing_ascending(hidden) is None


def test_degenerate_relays_count():
    """A relay with α = β switches with any sweep over it, both ways."""
    h = RelayMeasure.from_arrays([1.0, 2.0], [1.0, 0.0], [0.5, 0.0])
    assert strips.K(h, 0.25) == 1.0
    assert largest_change(h, 0.25).attained == 1.0
    c = classes(h)
    assert (c.g_min.value, c.g_min.at, c.reversible_share) == (0.5, (1.0, 1.0), 1.0)
