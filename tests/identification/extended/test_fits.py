"""The parameters of each extension are recovered from noisy records of an independent truth, with correct
coverage.

There are ten records each, with fixed seeds; at least eight intervals of 95 % must contain the truth (fewer
has probability 1 %).
"""

import tracemalloc

import numpy as np
import pytest

from identification.made_runs import made_run
from smarig.core.errors import DataError
from smarig.identification.extended.extensions.accommodating import identify_accommodation
from smarig.identification.extended.extensions.moving import identify_moving
from smarig.identification.extended.extensions.reversible import identify_reversible
from smarig.identification.extended.nonlinear_fit import identify_nonlinear
from smarig.preisach.hysteresis.relay_measure import RelayMeasure
from smarig.preisach.operator import Preisach
from theory.extended import truths

SEEDS = range(10)
NOISE = 0.01  # a thousandth of the stroke
LEVELS = np.linspace(truths.LOWER, truths.UPPER, 16)


def line(start, stop, points):
    """Inputs from start (left out) to stop."""
    return list(start + (stop - start) * np.arange(1, points + 1) / points)


def first_order(levels):
    """Negative saturation, up to each level through the others, down to saturation through all."""
    return [levels[0]] + [u for k in range(1, len(levels)) for u in [*levels[1 : k + 1], *levels[:k][::-1]]]


def second_order(levels):
    """Every α, every β below it, every u between on the way up again."""
    n = len(levels)
    triples = [(i, j) for i in range(2, n) for j in range(1, i - 1)]
    return [u for i, j in triples for u in [levels[0], levels[i], levels[j], *levels[j + 1 : i]]] + [
        levels[0]
    ]


def minor_loops(pairs, crests=(150.0, 110.0)):
    """Loops low … high after the rising branch, and after a fall from each crest."""
    out = [0.0]
    for low, high in pairs:
        out += [*line(0, high, 4), *line(high, low, 5), *line(low, high, 5), 0.0]
        for crest in crests:
            out += [*line(0, crest, 4), *line(crest, low, 4), *line(low, high, 5), 0.0]
    return out


def record(inputs, y, seed=None, noise=NOISE):
    """One run of settled points with noise."""
    scatter = 0 if seed is None else noise * np.random.default_rng(seed).standard_normal(len(inputs))
    return made_run(inputs, y + scatter)


def relays(m=9):
    """The truth's relays as a classical hysteresis, output from −5 to 5."""
    wire = truths.Wire(m=m)
    return RelayMeasure.from_arrays(wire.alpha, wire.beta, np.full(wire.alpha.size, wire.share / 2))


# --- moving -------------------------------------------------------------------------------------------------

FIRST, LOOPS = first_order(LEVELS), minor_loops([(30, 65), (85, 120), (50, 75), (75, 105)])


def fitted_moving(k):
    y = [truths.moving(u, k) for u in (FIRST, LOOPS)]
    return [identify_moving([record(FIRST, y[0], s), record(LOOPS, y[1], 99 + s)]) for s in SEEDS]


@pytest.mark.long
def test_the_feedback_of_a_moving_wire_comes_back():
    fits = fitted_moving(2.0)
    low, high = np.transpose([f.feedback.ci95 for f in fits])
    assert np.sum((low <= 2.0) & (high >= 2.0)) >= 8
    assert np.median([f.feedback.value for f in fits]) == pytest.approx(2.0, abs=0.5)
    assert np.median([f.p_value for f in fits]) < 0.01
    assert all(f.rms < 0.85 * f.rms_without for f in fits)


@pytest.mark.long("takes a second")
def test_the_identified_moving_model_predicts_held_out_loops():
    seen, fresh = minor_loops([(30, 65), (75, 105)]), minor_loops([(40, 70), (85, 120)], (130.0,))
    fit = identify_moving([record(u, truths.moving(u, 2.0), 7) for u in (FIRST, seen)])
    left = fit.model().simulate(fresh) - truths.moving(fresh, 2.0)
    assert np.sqrt(np.mean(left**2)) < 0.03


@pytest.mark.long("takes three seconds")
def test_a_classical_wire_shows_no_feedback():
    u, y = (FIRST, LOOPS), [truths.classical(v) for v in (FIRST, LOOPS)]
    fits = [identify_moving([record(u[0], y[0], s), record(u[1], y[1], 99 + s)]) for s in range(2)]
    assert all(f.p_value > 0.01 for f in fits)
    assert all(abs(f.feedback.value) < 1 for f in fits)


def test_a_record_without_loops_is_refused_with_what_is_missing():
    with pytest.raises(DataError, match="Measure minor loops"):
        identify_moving([record(FIRST, truths.classical(FIRST))])


# --- accommodation ------------------------------------------------------------------------------------------

AGAIN = [0.0, 120.0, 25.0, *[95.0, 55.0] * 12, 0.0, 85.0, *[45.0, 85.0] * 12, 0.0]


@pytest.mark.long("takes two seconds")
def test_amount_and_path_of_accommodation_come_back():
    y = truths.accommodating(AGAIN, 0.6, 0.4, m=9)
    fits = [identify_accommodation([record(AGAIN, y, seed)], relays()) for seed in SEEDS]
    for name, truth in (("amount", 0.6), ("path", 0.4)):
        low, high = np.transpose([getattr(f, name).ci95 for f in fits])
        assert np.sum((low <= truth) & (high >= truth)) >= 8, name
        assert np.median([getattr(f, name).value for f in fits]) == pytest.approx(truth, rel=0.1)
    assert all(f.p_value < 1e-6 for f in fits)


@pytest.mark.long("takes two seconds")
def test_loops_that_coincide_show_no_accommodation():
    y = truths.classical(AGAIN, m=9)
    fits = [identify_accommodation([record(AGAIN, y, seed)], relays()) for seed in SEEDS]
    assert sum(f.p_value < 0.05 for f in fits) <= 2
    low, high = np.transpose([f.amount.ci95 for f in fits])
    assert np.sum((low <= 0) & (high >= 0)) >= 7  # l is chosen to fit noise best


def test_a_record_without_repeats_is_refused_with_what_is_missing():
    u = [0.0, 100.0, 50.0, 80.0, 60.0]
    with pytest.raises(DataError, match="driven several times"):
        identify_accommodation([record(u, truths.classical(u, m=9))], relays())


def test_repeats_of_saturation_alone_show_no_accommodation():
    u = [0.0, 150.0] * 6
    with pytest.raises(DataError, match="cannot drift"):
        identify_accommodation([record(u, truths.classical(u, m=9), 1)], relays())


# --- non-linear ---------------------------------------------------------------------------------------------

COARSE = np.linspace(truths.LOWER, truths.UPPER, 7)
CURVES = [*first_order(COARSE), *second_order(COARSE)]


def true_excess(strength):
    """Q at the nodes by relays: fall short of the congruent curve, from exact outputs."""
    n = len(COARSE)
    q = np.full((n, n, n), np.nan)

    def y(*turns):
        return truths.nonlinear([0.0, *turns], strength, m=12)[-1]

    for i in range(2, n):
        for j in range(1, i):
            for k in range(j + 1, i):
                a, b, u = COARSE[[i, j, k]]
                q[i, j, k] = y(a, b) + y(u) - y(u, b) - y(a, b, u)
    return q


def test_the_excess_of_second_order_curves_comes_back_with_its_error():
    truth, y = true_excess(1.0), truths.nonlinear(CURVES, 1.0, m=12)
    known = np.isfinite(truth)
    covered = []
    for seed in SEEDS:
        fit = identify_nonlinear([record(CURVES, y, seed)], NOISE)
        low, high = fit.interval()
        covered.append((low <= truth)[known] & (truth <= high)[known])
        assert fit.p_value < 1e-4
    assert 0.90 <= np.mean(covered) <= 0.99
    assert np.max(np.abs(truth[known])) > 0.2


def test_the_identified_non_linear_model_is_exact_on_its_partition():
    fit = identify_nonlinear([record(CURVES, truths.nonlinear(CURVES, 1.0, m=12))], NOISE)
    u = COARSE[np.random.default_rng(1).integers(0, len(COARSE), 200)]
    assert fit.model().simulate(u) == pytest.approx(
        truths.nonlinear(np.append(0, u), 1.0, m=12)[1:], abs=1e-10
    )


def test_second_order_curves_of_a_classical_wire_show_no_excess():
    y = truths.classical(CURVES, m=12)
    p = [identify_nonlinear([record(CURVES, y, seed)], NOISE).p_value for seed in range(40)]
    assert 0.3 < np.mean(p) < 0.7  # uniform
    assert np.min(p) > 1e-3


def test_a_missing_second_order_curve_is_named():
    with pytest.raises(DataError, match="No second-order point at α = 75, β = 25, u = 50"):
        identify_nonlinear([record(first_order(COARSE), truths.classical(first_order(COARSE), m=12))], NOISE)


def test_curves_between_hundreds_of_inputs_are_refused_before_their_tensor_is_made():
    """As in FORC files of thousands of points: a tensor of 400³ would take half a gigabyte."""
    known = identify_nonlinear([record(CURVES, truths.classical(CURVES, m=12))], NOISE).hysteresis
    inner = np.random.default_rng(1).uniform(truths.LOWER, truths.UPPER, 400)
    u = [truths.LOWER, *inner.tolist()]
    tracemalloc.start()
    try:
        with pytest.raises(
            DataError, match=r"different inputs, and all second-order curves .* Run second_ord"
        ):
            identify_nonlinear([record(u, truths.classical(u, m=12))], NOISE, known)
        assert tracemalloc.get_traced_memory()[1] < 30e6
    finally:
        tracemalloc.stop()


# --- reversible ---------------------------------------------------------------------------------------------

BRANCHES = [*LEVELS, *LEVELS[::-1]]


@pytest.mark.parametrize("strength", [0.0, 0.5])
def test_a_reversible_part_comes_back_from_the_mean_of_the_branches(strength):
    truth = strength * np.sin(LEVELS / 40)
    y = truths.classical(BRANCHES, m=9) + np.append(truth, truth[::-1])
    inside = truth[1:-1] + truths.STROKE / 2  # the measure is centred, the wire starts at 0

    def covers(seed):
        """The share of it in the interval of a fit, and the p-values of that fit."""
        fit = identify_reversible([record(BRANCHES, y, seed)], relays(), NOISE)
        low, high = fit.interval()
        return np.mean((low <= inside) & (inside <= high)), fit.p_enough, fit.p_none

    covered, p_enough, p_none = np.transpose([covers(seed) for seed in SEEDS])
    assert 0.88 <= np.mean(covered) <= 0.99
    assert np.median(p_enough) > 0.05
    assert (np.median(p_none) < 1e-6) == (strength > 0)


def test_branches_that_differ_in_width_are_not_explained_by_a_reversible_part():
    y = truths.moving(BRANCHES, 2.0, m=9)
    fit = identify_reversible([record(BRANCHES, y, 1)], relays(), NOISE)
    assert fit.p_enough < 1e-6


# --- restricted ---------------------------------------------------------------------------------------------


def test_the_identified_restricted_model_is_exact_on_its_partition_where_the_non_linear_one_is_not():
    fit = identify_nonlinear([record(CURVES, truths.restricted(CURVES, 1, m=12))], NOISE)
    u = np.append(0, COARSE[np.random.default_rng(1).integers(0, len(COARSE), 200)])
    truth = truths.restricted(u, 1, m=12)
    assert fit.restricted().simulate(u) == pytest.approx(truth, abs=1e-10)
    assert np.max(np.abs(fit.model().simulate(u) - truth)) > 0.05


def test_beyond_a_known_hysteresis_second_order_curves_alone_hold_the_excess():
    known = identify_nonlinear([record(CURVES, truths.restricted(CURVES, 1, m=12))], NOISE).hysteresis
    inner = second_order(COARSE)
    y = truths.restricted(inner, 1, m=12)
    p = []
    for seed in SEEDS:
        fit = identify_nonlinear([record(inner, y, seed)], NOISE, known)
        assert fit.p_value < 1e-4
        classical = Preisach(known).simulate(inner)
        p.append(identify_nonlinear([record(inner, classical, seed)], NOISE, known).p_value)
    assert 0.2 < np.mean(p) < 0.8
    exact = identify_nonlinear([record(inner, y)], NOISE, known)
    assert exact.restricted().simulate(inner) == pytest.approx(y, abs=1e-10)


def test_a_run_without_second_order_curves_names_the_protocol():
    wire = relays()
    with pytest.raises(DataError, match="second_order_transition"):
        identify_nonlinear([record(BRANCHES, truths.classical(BRANCHES, m=9))], NOISE, wire)
