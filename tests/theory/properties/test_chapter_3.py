"""Chapter 3, number by number, on random signed measures; each with an injected violation it must find.

(3.1)       test_3_1_output_is_the_sum_of_relays            injected: masses where ν is meant (half of it)
Obs. 3.1    test_observation_3_1_and_proposition_3_4        injected: the impossible boundary of Fig. 3.7
(3.2)       test_3_2_output_from_the_boundary               injected: P₊ without the relays on its corner
Prop. 3.2   test_proposition_3_2_output_variation           injected: sgn(Δu) left out
Cor. 3.3    test_corollary_3_3_signs                        injected: a measure with negative cells
Def. 3.1    test_definition_3_1_decaying_oscillation        injected: an oscillation that starts too small
§3.2.6      test_3_2_6_saturations_are_symmetric_but_for_an_offset   injected: the offset left out
§3.3.1      test_3_3_1_wiping_out                           injected: accommodation
§3.3.2      test_3_3_2_congruency                           injected: a non-linear Preisach model
§3.3.2      test_3_3_2_both_are_sufficient (plays)          injected: both of the above: necessary
§3.3.3      test_3_3_3_no_accommodation                     injected: accommodation
Prop. 3.4   see Obs. 3.1
(3.3), (3.5)  test_3_5_density_is_half_the_mixed_derivative injected: the ½ left out
"""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarig.preisach.hysteresis.relay_measure import RelayMeasure
from smarig.preisach.operator import Preisach, State
from smarig.theory.properties.classes import classes
from theory.properties.planes import Y_LOWER, Lattice, counterexample, driven, histories, lattices

TOLERANCE = 1e-12


class Operator:
    """The required interface of a hysteresis: a history in, outputs out, from negative saturation."""

    def __init__(self, lattice: Lattice) -> None:
        self.lattice = lattice

    def __call__(self, inputs) -> np.ndarray:
        return Preisach(self.lattice.table()).simulate(inputs)


class Accommodating(Operator):
    """§3.3.3: each rise loses a share of what the last fall left, until the loop has settled (Fig. 3.9b)."""

    def __call__(self, inputs) -> np.ndarray:
        op, drift, out = Preisach(self.lattice.table()), 0.0, []
        for u in inputs:
            before, seat = op.y, op.u
            op.step(u)
            drift = 0.8 * (drift + (0.1 * abs(op.y - before) if u != seat else 0.0))
            out.append(op.y + drift)
        return np.array(out)


class NonLinear(Operator):
    """The non-linear Preisach model of §3.5 in its simplest form: wiping-out holds, congruency does not."""

    def __call__(self, inputs) -> np.ndarray:
        y = Operator.__call__(self, inputs)
        return y + 0.3 * y**2 / self.lattice.scale


class Plays:
    """A weighted sum of plays p ← max(u − r, min(u + r, p)): Prandtl's model, without a relay or a plane."""

    def __init__(self, radii, weights, start: float) -> None:
        self.radii, self.weights, self.start = np.array(radii), np.array(weights), start

    def __call__(self, inputs) -> np.ndarray:
        p, out = self.start + self.radii, []
        for u in inputs:
            p = np.maximum(u - self.radii, np.minimum(u + self.radii, p))
            out.append(float(self.weights @ p))
        return np.array(out)


# --- the model (§3.1, §3.2) ---------------------------------------------------------------------------


def off_the_relays(lattice: Lattice, inputs, outputs) -> float:
    return float(np.max(np.abs(outputs - lattice.relays(2).drive(inputs, Y_LOWER))))


@given(driven())
def test_3_1_output_is_the_sum_of_relays(case):
    lattice, inputs = case
    assert off_the_relays(lattice, inputs, Operator(lattice)(inputs)) <= TOLERANCE * lattice.scale


def test_3_1_can_fail():
    def halved(case):
        lattice, inputs = case
        half = Operator(Lattice(lattice.levels, lattice.nu / 2))(inputs)
        return off_the_relays(lattice, inputs, half) > 0.1

    counterexample(driven(), halved)


def on_by_corners(state: State, alpha, beta) -> np.ndarray:
    """P₊ by its staircase: (M_i, m_i) are the extrema, the present input is the last of them."""
    path = [*state.extrema, state.u]
    on = np.zeros(alpha.size, dtype=bool)
    for before, u in pairwise(path):
        on = on | (alpha <= u) if u > before else on & (beta < u)
    return on


def is_falling(relays) -> bool:
    """Prop. 3.4: what is on stays on at any smaller α and any smaller β (relays 1 and 2, pair by pair)."""
    a, b = relays.alpha, relays.beta
    below = (a[:, None] <= a) & (b[:, None] <= b)
    return not np.any(below & relays.on & ~relays.on[:, None])


@given(driven(parts=1))
def test_observation_3_1_and_proposition_3_4(case):
    """The boundary falls, meets α = β in (u, u), and is the one the operator's State draws."""
    lattice, inputs = case
    relays, op = lattice.relays(), Preisach(lattice.table())
    for u in inputs:
        relays.drive([u], 0.0)
        op.step(u)
        assert np.all(relays.on[relays.alpha <= u])
        assert not np.any(relays.on[relays.beta >= u])
        assert is_falling(relays)
        assert np.array_equal(on_by_corners(op.state, relays.alpha, relays.beta), relays.on)


def test_observation_3_1_and_proposition_3_4_can_fail():
    """Fig. 3.7: a state that remembers the maximum 2 and, later, 3, has a boundary that rises."""

    def impossible(lattice):
        relays = lattice.relays()
        u = lattice.levels
        relays.on = (relays.alpha <= u[1]) | ((relays.alpha <= u[-1]) & (relays.beta >= u[1]))
        return not is_falling(relays)

    counterexample(lattices(), impossible)


def by_the_boundary(lattice: Lattice, inputs, strict: bool) -> float:
    """(3.2): y = 2∬_{P₊} μ − ∬ μ with P₊ from the State; its largest deviation from the operator."""
    relays, op, worst = lattice.relays(), Preisach(lattice.measure()), 0.0
    for u in inputs:
        y = op.step(u)
        on = on_by_corners(op.state, relays.alpha, relays.beta)
        if strict:
            on &= (relays.alpha < op.u) | (relays.alpha > op.u)
        worst = max(worst, abs(y - (relays.nu[on].sum() - relays.nu.sum() / 2)))
    return worst


@given(driven(parts=1))
def test_3_2_output_from_the_boundary(case):
    lattice, inputs = case
    assert by_the_boundary(lattice, inputs, strict=False) <= TOLERANCE * lattice.scale


def test_3_2_can_fail():
    counterexample(driven(parts=1), lambda case: by_the_boundary(*case, strict=True) > 0.1)


def moves(lattice: Lattice, inputs):
    """(Δu, Δy of the operator, ν(Ω) of the relays that switched) for every move."""
    relays, op, found = lattice.relays(2), Preisach(lattice.table()), []
    for u in inputs:
        before, y, on = op.u, op.y, relays.on.copy()
        relays.drive([u], 0.0)
        swept = relays.nu[on != relays.on].sum()
        found.append((u - before, op.step(u) - y, float(swept)))
    return found


@given(driven())
def test_proposition_3_2_output_variation(case):
    for du, dy, swept in moves(*case):
        assert dy == pytest.approx(np.sign(du) * swept, abs=TOLERANCE * case[0].scale)


def test_proposition_3_2_can_fail():
    counterexample(driven(), lambda case: any(abs(dy - swept) > 0.1 for _, dy, swept in moves(*case)))


@given(driven(signed=False), driven())
def test_corollary_3_3_signs(positive, signed):
    """ν(Ω) ≥ 0 exactly where output and input change alike; always so for a positive measure."""
    assert all(dy * du >= -TOLERANCE for du, dy, _ in moves(*positive))
    for du, dy, swept in moves(*signed):
        if du != 0 and abs(swept) > TOLERANCE * signed[0].scale:
            assert (swept >= 0) == (dy * du >= 0)


def test_corollary_3_3_can_fail():
    counterexample(driven(), lambda case: any(dy * du < -0.1 for du, dy, _ in moves(*case)))


def distance_to_B_star(lattice: Lattice, periods: int, amplitude: float) -> tuple[float, float]:
    """|y − r(B*)| after an oscillation that decays from ``amplitude``, and what n periods may leave of it."""
    table = lattice.table()
    op = Preisach(table, "positive")
    for k in range(periods):
        op.step(amplitude * (1 - k / periods))
        op.step(-amplitude * (1 - (k + 0.5) / periods))
    y = op.step(0.0)
    c = classes(table)
    M = max(abs(c.mu_min.value), abs(c.mu_max.value))
    G = max(abs(c.g_min.value), abs(c.g_max.value))
    step = amplitude / periods
    return abs(y - Preisach(table, "anhysteretic").y), 2 * M * step * amplitude + 2 * G * step


@st.composite
def symmetric(draw):
    lattice = draw(lattices(even=True))
    return Lattice(lattice.levels - (lattice.levels[0] + lattice.levels[-1]) / 2, lattice.nu)


@given(symmetric(), st.integers(5, 60))
def test_definition_3_1_decaying_oscillation(lattice, periods):
    """The slower it decays, the nearer the boundary comes to α = −β: as 1/periods."""
    distance, allowed = distance_to_B_star(lattice, periods, float(lattice.levels[-1]))
    assert distance <= allowed + TOLERANCE * lattice.scale


def test_definition_3_1_can_fail():
    def too_small(lattice):
        distance, allowed = distance_to_B_star(lattice, 60, 0.4 * float(lattice.levels[-1]))
        return distance > allowed + 0.1

    counterexample(symmetric(), too_small)


@given(lattices())
def test_3_2_6_saturations_are_symmetric_but_for_an_offset(lattice):
    relays = Preisach(lattice.measure())
    low, high = relays.reset("negative"), relays.reset("positive")
    assert low == pytest.approx(-high, abs=TOLERANCE * lattice.scale)
    shifted = Preisach(lattice.table())
    offset = (shifted.reset("positive") + shifted.reset("negative")) / 2
    assert shifted.reset("negative") - offset == pytest.approx(low, abs=TOLERANCE * lattice.scale)


def test_3_2_6_can_fail():
    """Without the offset a table's saturations are not symmetric."""
    counterexample(
        lattices(), lambda p: abs(sum(Preisach(p.table()).reset(e) for e in ("negative", "positive"))) > 0.1
    )


# --- the two conditions (§3.3) ------------------------------------------------------------------------


@st.composite
def wiped(draw):
    """A history, what is wiped out, and what comes after: (lattice, with, without), equal endings."""
    lattice = draw(lattices())
    past = draw(histories(lattice))
    points = lattice.points(2)
    end = draw(st.sampled_from(points.tolist()))
    between = points[(points >= min(past[-1], end)) & (points <= max(past[-1], end))].tolist()
    wiggle = draw(st.lists(st.sampled_from(between), max_size=6))
    after = draw(histories(lattice))
    return lattice, [*past, *wiggle, end, *after], [*past, end, *after], len(after) + 1


def memory_of_what_was_wiped(kind, case) -> float:
    lattice, with_it, without, n = case
    box = kind(lattice)
    return float(np.max(np.abs(box(with_it)[-n:] - box(without)[-n:])))


@given(wiped())
def test_3_3_1_wiping_out(case):
    assert memory_of_what_was_wiped(Operator, case) <= TOLERANCE * case[0].scale


def test_3_3_1_can_fail():
    counterexample(wiped(), lambda case: memory_of_what_was_wiped(Accommodating, case) > 0.05)


@st.composite
def comparable(draw):
    """Two histories that end in loops between the same inputs (Def. 3.2)."""
    lattice = draw(lattices())
    low, high = sorted(
        draw(st.lists(st.sampled_from(lattice.points(2).tolist()), min_size=2, max_size=2, unique=True))
    )
    inside = lattice.points(2)
    inside = inside[(inside >= low) & (inside <= high)].tolist()
    loop = [high, low, *draw(st.lists(st.sampled_from(inside), max_size=5)), high, low]
    return lattice, draw(histories(lattice)), draw(histories(lattice)), loop


def incongruence(kind, case) -> float:
    lattice, one, two, loop = case
    ends = [kind(lattice)([*past, *loop])[-len(loop) + 1 :] for past in (one, two)]
    shapes = [y - y[0] for y in ends]
    return float(np.max(np.abs(shapes[0] - shapes[1])))


@given(comparable())
def test_3_3_2_congruency(case):
    assert incongruence(Operator, case) <= TOLERANCE * case[0].scale


def test_3_3_2_congruency_can_fail():
    counterexample(comparable(), lambda case: incongruence(NonLinear, case) > 0.05)


def preisach_of(box, levels: np.ndarray) -> RelayMeasure:
    """Mayergoyz's construction: the measure of a black box from its first-order curves alone (§3.4)."""
    n = levels.size
    y = np.full((n, n), np.nan)
    for i in range(n):
        y[i, : i + 1] = box([levels[0], levels[i], *levels[: i + 1][::-1]])[2:][::-1]
    F = np.where(np.tri(n, dtype=bool), np.diag(y)[:, None] - y, 0.0)
    nu = np.tril(F[1:, :-1] - F[:-1, :-1] - F[1:, 1:] + F[:-1, 1:])
    i, j = np.nonzero(np.tri(n - 1))
    return RelayMeasure.from_arrays([*levels[i + 1]], [*levels[j]], nu[i, j] / 2)


def misprediction(box, levels, inputs) -> float:
    """How far the Preisach model with the box's first-order curves is from the box along any history."""
    predicted = Preisach(preisach_of(box, levels)).simulate([levels[0], *inputs])
    observed = box([levels[0], *inputs])
    return float(np.max(np.abs((predicted - predicted[0]) - (observed - observed[0]))))


LEVELS = np.arange(8.0)


@given(
    st.lists(st.tuples(st.integers(0, 6), st.integers(-8, 8)), min_size=1, max_size=6),
    st.lists(st.sampled_from(LEVELS.tolist()), min_size=1, max_size=14),
)
def test_3_3_2_both_are_sufficient(plays, inputs):
    """A box that wipes out and is congruent, and was not built of relays, has a Preisach representation."""
    radii, weights = zip(*plays)
    box = Plays(np.array(radii) / 2, np.array(weights) / 8, LEVELS[0])
    assert misprediction(box, LEVELS, inputs) <= 1e-12 * (1 + np.abs(weights).sum())


@pytest.mark.parametrize("kind", [NonLinear, Accommodating])
def test_3_3_2_both_are_necessary(kind):
    """A box that lacks one of the two has none: no measure whatever predicts it."""
    counterexample(driven(parts=1), lambda case: misprediction(kind(case[0]), case[0].levels, case[1]) > 0.05)


@st.composite
def cycled(draw):
    lattice = draw(lattices())
    ends = draw(st.lists(st.sampled_from(lattice.points(2).tolist()), min_size=2, max_size=2, unique=True))
    return lattice, draw(histories(lattice)), ends


def shift_of_cycles(kind, case) -> float:
    """Largest difference of the third to the sixth cycle from the second one."""
    lattice, past, ends = case
    y = kind(lattice)([*past, *ends * 6])[len(past) + 2 :].reshape(5, 2)
    return float(np.max(np.abs(y[1:] - y[0])))


@given(cycled())
def test_3_3_3_no_accommodation(case):
    assert shift_of_cycles(Operator, case) == 0.0


def test_3_3_3_can_fail():
    counterexample(cycled(), lambda case: shift_of_cycles(Accommodating, case) > 0.01)


# --- identification (§3.4) ----------------------------------------------------------------------------


def densities(lattice: Lattice) -> np.ndarray:
    """μ = ν/2 over the area of each cell off the diagonal."""
    w = np.diff(lattice.levels)
    mu = lattice.nu / (2 * w[:, None] * w)
    return mu[np.tri(w.size, k=-1, dtype=bool)]


@given(lattices())
def test_3_5_density_is_half_the_mixed_derivative(lattice):
    c, mu = classes(lattice.table()), densities(lattice)
    assert c.mu_min.value == pytest.approx(mu.min(), abs=TOLERANCE)
    assert c.mu_max.value == pytest.approx(mu.max(), abs=TOLERANCE)


def test_3_5_can_fail():
    counterexample(lattices(), lambda p: abs(classes(p.table()).mu_max.value - 2 * densities(p).max()) > 0.1)
