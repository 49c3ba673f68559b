"""The properties that each extension of §3.5 keeps and loses; each is plain Preisach at zero strength."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from smarig.core.errors import DataError, UsageError
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.hysteresis.relay_measure import RelayMeasure
from smarig.preisach.operator import Preisach
from smarig.theory.extended.accommodating_operator import AccommodatingPreisach
from smarig.theory.extended.moving_operator import MovingPreisach, slope_range
from smarig.theory.extended.nonlinear_operator import NonlinearPreisach, SecondOrderExcess
from smarig.theory.extended.restricted_operator import RestrictedPreisach
from smarig.theory.extended.reversible_operator import ReversiblePart, ReversiblePreisach
from theory.extended import truths

WIRE = thesis_surface("one_e")
NODES = np.linspace(0.0, 174.1, 7)
MANY = st.lists(st.floats(-5, 180, allow_subnormal=False), min_size=2, max_size=25)


def some_excess(scale):
    """A smooth, made-up excess on the seven nodes, ``scale`` times 1 at its like."""
    a, b, u = np.meshgrid(NODES, NODES, NODES, indexing="ij")
    return SecondOrderExcess.from_nodes(NODES, scale * (a - u) * (u - b) * b / 50.0**3)


RAMP = ReversiblePart(np.array([0.0, 174.1]), np.array([0.0, 2.0]))
NOTHING = ReversiblePart(np.array([0.0]), np.array([0.0]))
ZERO_STRENGTH = {
    "non-linear": NonlinearPreisach(WIRE, some_excess(0.0)),
    "reversible": ReversiblePreisach(WIRE, NOTHING),
    "moving": MovingPreisach(WIRE, 0.0),
    "accommodation, no amount": AccommodatingPreisach(WIRE, 0.0, 1.0),
    "accommodation, endless path": AccommodatingPreisach(WIRE, 1.0, np.inf),
    "restricted, no extremum": RestrictedPreisach(WIRE, []),
    "restricted": RestrictedPreisach.first_order(WIRE, some_excess(0.0)),
}
STRONG = {
    "non-linear": NonlinearPreisach(WIRE, some_excess(0.5)),
    "reversible": ReversiblePreisach(WIRE, RAMP),
    "moving": MovingPreisach(WIRE, 1.5),
    "moving back": MovingPreisach(WIRE, -3.0),
    "accommodation": AccommodatingPreisach(WIRE, 0.8, 0.5),
    "restricted": RestrictedPreisach.first_order(WIRE, some_excess(0.5)),
}


def loop_heights(model, low, high, history):
    """Chords between the branches of the loop low … high that follows a history, at three inputs between."""
    inside = np.linspace(low, high, 5)[1:-1]
    u = [*history, low, *inside, high, *inside[::-1], low]
    y = model.simulate(u)[len(history) :]
    return y[1:4], y[5:8][::-1], y[0] - y[-1]


HISTORIES = ([150.0], [81.0], [105.0, 10.0, 81.0])


@pytest.mark.parametrize("name", ZERO_STRENGTH)
@given(u=MANY, start=st.sampled_from(["negative", "positive"]))
def test_at_zero_strength_each_is_preisach_bit_for_bit(name, u, start):
    assert np.array_equal(ZERO_STRENGTH[name].simulate(u, start), Preisach(WIRE).simulate(u, start))


@pytest.mark.parametrize("name", STRONG)
def test_at_full_strength_each_differs_from_preisach(name):
    u = [120.0, 40.0, 100.0, 50.0, 90.0, 45.0, 110.0]
    assert np.max(np.abs(STRONG[name].simulate(u) - Preisach(WIRE).simulate(u))) > 0.05


@pytest.mark.parametrize("name", STRONG)
@given(u=MANY, split=st.integers(0, 24))
def test_a_run_may_go_on_where_another_ended(name, u, split):
    model = STRONG[name]
    whole = model.simulate(u)
    model.simulate(u[:split])
    state = model.state
    model.simulate([100.0, 3.0])
    assert np.array_equal(model.simulate(u[split:], state), whole[split:])


@pytest.mark.parametrize("name", ["non-linear", "reversible", "moving", "moving back", "restricted"])
@given(peak=st.floats(60, 160), dips=st.lists(st.floats(0.05, 0.95), min_size=2, max_size=8))
def test_wiping_out_survives(name, peak, dips):
    model = STRONG[name]
    second_order_mask = [peak * d for d in dips]
    after = [*second_order_mask, peak, 40.0, 55.0]
    assert model.simulate([peak, *after])[-3:] == pytest.approx(model.simulate([peak, 40.0, 55.0]), abs=1e-11)


def test_accommodation_gives_wiping_out_up():
    model = STRONG["accommodation"]
    y = model.simulate([100.0, *[60.0, 90.0] * 4, 100.0, 60.0])
    assert abs(y[-1] - y[1]) > 0.01


def test_loops_of_a_restricted_wire_are_congruent_after_one_maximum_and_differ_after_another():
    model = STRONG["restricted"]
    alike = [loop_heights(model, 40.0, 75.0, [130.0, 20.0, *inner]) for inner in ([90.0], [80.0, 30.0, 78.0])]
    shapes = [np.append(up - up[0], down - up[0]) for up, down, _ in alike]
    assert shapes[0] == pytest.approx(shapes[1], abs=1e-12)
    up, down, _ = loop_heights(model, 40.0, 75.0, [110.0, 20.0, 90.0])
    assert np.max(np.abs(np.append(up - up[0], down - up[0]) - shapes[0])) > 0.02


def test_vertical_chords_of_a_restricted_wire_may_differ():
    up, down, gaps = zip(*(loop_heights(STRONG["restricted"], 25.0, 80.0, [peak]) for peak in (150.0, 90.0)))
    assert np.max(np.ptp(np.array(down) - np.array(up), axis=0)) > 0.02
    assert np.array(gaps) == pytest.approx(0, abs=1e-12)


@given(u=MANY)
def test_a_reversible_part_adds_its_value_beyond_saturation_too(u):
    wide = ReversiblePart(np.array([-10.0, 200.0]), np.array([-1.0, 3.0]))
    added = ReversiblePreisach(WIRE, wide).simulate(u) - Preisach(WIRE).simulate(u)
    assert added == pytest.approx((np.array(u) + 10) * 4 / 210 - 1, abs=1e-12)


def test_vertical_chords_are_equal_for_the_non_linear_model_though_loops_are_not_congruent():
    up, down, gaps = zip(*(loop_heights(STRONG["non-linear"], 25.0, 80.0, h) for h in HISTORIES))
    chords = np.array(down) - np.array(up)
    assert np.ptp(chords, axis=0) == pytest.approx(0, abs=1e-12)
    assert np.array(gaps) == pytest.approx(0, abs=1e-12)
    shapes = np.array(up) - np.array(up)[:, :1]
    assert np.max(np.ptp(shapes, axis=0)) > 0.02
    assert np.max(chords) > 0.1


@pytest.mark.parametrize("name", ["moving", "moving back", "accommodation"])
def test_vertical_chords_differ_under_feedback_and_accommodation(name):
    up, down, _ = zip(*(loop_heights(STRONG[name], 25.0, 80.0, h) for h in HISTORIES))
    assert np.max(np.ptp(np.array(down) - np.array(up), axis=0)) > 0.02


def test_the_excess_of_a_second_order_curve_is_what_the_model_lies_below_the_congruent_one():
    alpha, beta, u = NODES[5], NODES[2], NODES[4]
    below = (
        Preisach(WIRE).simulate([alpha, beta, u])[-1] - STRONG["non-linear"].simulate([alpha, beta, u])[-1]
    )
    assert below == pytest.approx(0.5 * (alpha - u) * (u - beta) * beta / 50.0**3, abs=1e-12)


@given(u=MANY)
def test_an_excess_leaves_no_jump_where_the_input_turns(u):
    model = STRONG["non-linear"]
    model.simulate(u)
    before, state = model.step(u[-1]), model.state
    for nudge in (1e-9, -1e-9):
        model.reset(state)
        assert model.step(u[-1] + nudge) == pytest.approx(before, abs=1e-6)


@pytest.mark.parametrize("k", [2.5, -4.0])
@settings(max_examples=20)
@given(u=MANY)
def test_the_moving_model_solves_its_own_equation(k, u):
    model = MovingPreisach(WIRE, k)
    for v in u:
        y = model.step(v)
        w = min(max(v + k * y, WIRE.lower), WIRE.upper)
        assert model.state.u == pytest.approx(w, abs=1e-10)


@pytest.mark.parametrize("k", [0.0, 2.0, -3.0])
def test_the_moving_model_agrees_with_relays_that_feel_the_output(k):
    rng = np.random.default_rng(3)
    u = rng.uniform(0, 150, 60)
    wire = truths.Wire()
    levels = np.linspace(truths.LOWER, truths.UPPER, 61)
    nu = wire.share * ((wire.alpha[:, None] <= levels).astype(float).T @ (wire.beta[:, None] >= levels))
    table = np.where(np.tri(levels.size, dtype=bool), nu[:, :1] - nu, np.nan)
    np.fill_diagonal(table, nu[:, 0])
    h = Preisach.from_table(levels, levels, table).hysteresis
    truth = truths.moving(u, k)
    assert MovingPreisach(h, k).simulate(u) == pytest.approx(truth, abs=0.06)  # cells of 2.5 K
    assert k == 0 or np.max(np.abs(truth - truths.classical(u))) > 1


def test_a_feedback_beyond_the_steepest_branch_is_refused_with_its_place():
    s = slope_range(WIRE)
    MovingPreisach(WIRE, 0.999 / s.greatest)
    with pytest.raises(UsageError, match=f"from {s.greatest_at[0]:g} the slope near {s.greatest_at[1]:g}"):
        MovingPreisach(WIRE, 1.001 / s.greatest)


def test_a_branch_that_turns_back_bounds_negative_feedback():
    s = slope_range(thesis_surface("two_p"))
    assert s.least == pytest.approx(-0.037, abs=2e-3)  # theory.md §1
    with pytest.raises(UsageError, match="ill posed"):
        MovingPreisach(thesis_surface("two_p"), 1.001 / s.least)
    MovingPreisach(thesis_surface("two_p"), 0.999 / s.least)


def test_relays_in_steps_take_no_feedback():
    with pytest.raises(UsageError, match="steps"):
        MovingPreisach(RelayMeasure.from_arrays([1.0, 2.0], [0.0, 1.0], [1.0, 1.0]), 0.1)


def test_accommodation_converges_geometrically():
    y = AccommodatingPreisach(WIRE, 0.6, 0.5).simulate([110.0] + [60.0, 80.0] * 80)[2::2]
    steps = np.diff(y)
    assert abs(steps[0]) > 1e-3
    assert abs(steps[-1]) < 0.01 * abs(steps[0])
    path = 2 * np.ptp(Preisach(WIRE).simulate([110.0, 60.0, 80.0])[1:]) / 12.54
    assert steps[2:6] / steps[1:5] == pytest.approx(np.exp(-path / 0.5), rel=1e-6)


@settings(max_examples=20)
@given(u=MANY, n=st.integers(2, 6))
def test_samples_in_between_change_no_accommodation(u, n):
    fine = np.interp(np.arange((len(u) - 1) * n + 1) / n, np.arange(len(u)), np.clip(u, 0, 174.1))
    model = AccommodatingPreisach(thesis_surface("one_c"), 0.7, 0.5)
    coarse = model.simulate(np.clip(u, 0, 174.1))
    assert model.simulate(fine)[::n] == pytest.approx(coarse, abs=1e-9)


@given(u=MANY)
def test_accommodation_stays_between_the_saturations(u):
    y = AccommodatingPreisach(thesis_surface("one_c"), 1.0, 0.05).simulate(u)
    assert np.all(y >= -1e-9)
    assert np.all(y <= 12.54 + 1e-9)


def relay_measure(m=9):
    wire = truths.Wire(m=m)
    return RelayMeasure.from_arrays(wire.alpha, wire.beta, np.full(wire.alpha.size, wire.share / 2))


def test_accommodation_agrees_with_relays_that_drift_one_by_one():
    u = np.append(np.random.default_rng(5).uniform(20, 130, 8), [55.0, 95.0] * 15)
    y = AccommodatingPreisach(relay_measure(), 0.7, 0.4).simulate(u) + truths.STROKE / 2
    truth = truths.accommodating(u, 0.7, 0.4, m=9)
    assert y == pytest.approx(truth, abs=0.06)  # a relay is 0.02
    assert np.max(np.abs(truth - truths.classical(u, m=9))) > 0.5


@pytest.mark.parametrize("order", [0, 1, 2, 3])
def test_the_restricted_model_agrees_with_relays_weighted_after_past_extrema(order):
    wire = truths.Wire(m=9)

    def mass(extrema, beta, alpha):
        inside = (wire.alpha <= alpha) & (wire.beta >= beta)
        return truths.weights(wire, extrema, 0.5)[inside].sum()

    def excess(extrema, beta, alpha):
        return mass(extrema[:-1], beta, alpha) - mass(extrema, beta, alpha)

    rng = np.random.default_rng(order)  # nested, so that there is something to depend on
    inward = [75 + 70 * rng.uniform(0.9, 1, 12) * (-0.85) ** np.arange(12) for _ in range(3)]
    u = np.concatenate([*(np.append(turns, turns[-2::-1]) for turns in inward), rng.uniform(0, 150, 60)])
    ends = RelayMeasure.from_arrays(
        [*wire.alpha, truths.UPPER], [*wire.beta, truths.LOWER], [wire.share / 2] * wire.alpha.size + [0.0]
    )  # a relay without mass, so that both remember over one range
    model = RestrictedPreisach(ends, [excess] * order)
    truth = truths.restricted(u, order, m=9)
    assert model.order == order
    assert model.simulate(u) + truths.STROKE / 2 == pytest.approx(truth, abs=1e-9)
    fewer = truths.restricted(u, order - 1, m=9) if order else truths.classical(u, m=9) + 1
    assert np.max(np.abs(truth - fewer)) > 0.1


def test_mistakes_are_answered_in_one_sentence():
    with pytest.raises(UsageError, match="between 0 and 1"):
        AccommodatingPreisach(WIRE, 1.5, 1.0)
    with pytest.raises(UsageError, match="positive"):
        AccommodatingPreisach(WIRE, 0.5, 0.0)
    with pytest.raises(UsageError, match="strokes .* must be positive; this hysteresis has 0"):
        AccommodatingPreisach(replace(WIRE, y_upper=WIRE.y_lower), 0.5, 1.0)
    with pytest.raises(UsageError, match="this hysteresis has -12.54"):
        AccommodatingPreisach(replace(WIRE, y_upper=-12.54), 0.5, 1.0)
    with pytest.raises(UsageError, match="saturation"):
        NonlinearPreisach(
            thesis_surface("two_e"),
            SecondOrderExcess.from_nodes([-185.0, 185.0], np.zeros((2,) * 3)),
            "anhysteretic",
        )
    with pytest.raises(UsageError, match="one function Q_j"):
        RestrictedPreisach(WIRE, [0.5])
    for model in (NonlinearPreisach, RestrictedPreisach.first_order):
        with pytest.raises(DataError, match="covers only"):
            model(WIRE, SecondOrderExcess.from_nodes([0.0, 100.0], np.zeros((2,) * 3)))
    hole = np.zeros((4, 4, 4))
    hole[3, 1, 2] = np.nan
    with pytest.raises(DataError, match="α = 3, β = 1, u = 2"):
        SecondOrderExcess.from_nodes(range(4), hole)


@pytest.mark.parametrize(
    "nodes", [[0.0, np.nan], [0.0, np.inf], [1.0, 1.0], [0.0], ["low", "high"], None], ids=str
)
def test_inputs_that_are_no_partition_are_refused(nodes):
    with pytest.raises(DataError, match="A reversible part needs"):
        ReversiblePart(nodes, [0.0, 1.0])
    for make in (SecondOrderExcess, SecondOrderExcess.from_nodes):
        with pytest.raises(DataError, match="An excess "):
            make(nodes, np.zeros((2, 2, 2)))


def test_an_excess_needs_numbers():
    for values in ("none", np.full((3, 3, 3), np.nan), np.zeros((2, 2, 2))):
        with pytest.raises(DataError, match="An excess "):
            SecondOrderExcess([0.0, 1.0, 2.0], values)


def test_lists_of_numbers_do_as_well_as_arrays():
    part, nodes = ReversiblePart([0.0, 2.0], [0.0, 1.0]), NODES.tolist()
    assert float(part.at(1.0)) == 0.5
    excess = some_excess(1.0)
    same = SecondOrderExcess(nodes, excess.values.tolist())
    assert same.at(130.0, 40.0, 70.0) == excess.at(130.0, 40.0, 70.0) != 0


@pytest.mark.parametrize("name", STRONG)
@pytest.mark.parametrize("wrong", ["1.0", None], ids=str)
def test_a_step_to_no_number_is_refused(name, wrong):
    with pytest.raises(UsageError, match="needs a number as its input"):
        STRONG[name].step(wrong)
