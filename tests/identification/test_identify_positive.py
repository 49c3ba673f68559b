"""``identify(runs, "positive")``: a measure without negative mass, from first-order curves or from any runs."""

import json
from importlib import import_module

import numpy as np
import pytest

from identification.made_runs import PARTITION, driven_run, fod_inputs, fod_run, made_run
from smarig.core.errors import DataError, UsageError
from smarig.identification.identify import identify
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.hysteresis.mirrored import Mirrored
from smarig.preisach.operator import Preisach
from smarig.record import Run
from smarig.replay import load_model

EXTRA = {
    *("smoothing", "freedom", "cells", "at_zero", "rank", "null_space", "sigma", "held_out_rms"),
    *("signed_held_out_rms", "stretch", "reversible_share", "symmetric"),
}
WALK = np.random.default_rng(11).uniform(0.0, 174.1, 300)


def error_on(inputs, result, name, initial="negative"):
    """Rms of a model along inputs against the surface that made its data."""
    truth = Preisach.from_surface(thesis_surface(name)).simulate(inputs, initial)
    return float(np.sqrt(np.mean((result.model.predict(inputs, initial) - truth) ** 2)))


def swept(*turns, points=8):
    """Inputs from turn to turn, ``points`` to each stretch."""
    parts = [np.linspace(a, b, points + 1)[1:] for a, b in zip(turns, turns[1:])]
    return np.concatenate([turns[:1], *parts])


def without_steps(run):
    """The same samples as a record without settled steps."""
    return Run(run.path, run.meta, run.columns, (), ())


@pytest.fixture(scope="module")
def one_e():
    """A hysteresis that has negative mass, identified without any."""
    return identify(fod_run("one_e", seed=4), "positive")


# --- what it is -------------------------------------------------------------------------------------------


def test_no_mass_is_negative_though_the_truth_has_some(one_e):
    table = one_e.model.hysteresis
    assert isinstance(table, FodTable)
    u = np.random.default_rng(3).uniform(0.0, 174.1, (4000, 4))
    b1, b2, a1, a2 = np.sort(u, axis=1).T  # any rectangle above the diagonal
    mass = table.y(a2, b2) - table.y(a2, b1) - table.y(a1, b2) + table.y(a1, b1)
    assert mass.min() >= -1e-12
    falls = table.y(a2, b2) - table.y(a2, b1)  # reversible cells on the diagonal included
    rises = table.y(a2, a2) - table.y(a1, a1)
    assert min(falls.min(), rises.min()) >= -1e-12
    found = one_e.to_json()
    assert found["classes"] == {"M_PC": True, "M_P": True}
    assert found["mu_min"] == 0.0
    assert found["g_min"] >= 0.0
    assert not identify(fod_run("one_e", seed=4), "exponential").density.M_P


def test_it_predicts_better_than_the_table_and_than_the_surface_without_negative_mass(one_e):
    others = [
        error_on(WALK, identify(fod_run("one_e", seed=4), kind), "one_e") for kind in ("table", "constant")
    ]
    assert error_on(WALK, one_e, "one_e") < 0.5 * min(others)


def test_its_figures_are_in_the_model_file_and_the_file_gives_the_same_model(one_e, tmp_path):
    assert one_e.model.fit.keys() >= EXTRA
    model = load_model(one_e.model.save(tmp_path / "p.model.json"))
    assert model.fit == one_e.model.fit
    np.testing.assert_array_equal(model.predict(WALK), one_e.model.predict(WALK))


def test_errors_are_those_of_the_operator_along_the_run(one_e):
    inputs, outputs = fod_run("one_e", seed=4).points()
    error = one_e.model.predict(inputs) - outputs
    fit = one_e.model.fit
    assert fit["rms"] == pytest.approx(np.sqrt(np.mean(error**2)), rel=1e-9)
    assert fit["rms"] == pytest.approx(one_e.positive.rms, rel=1e-3)
    twice = np.where(_on_major_loop(inputs), 2.0, 1.0)
    assert fit["weighted_norm2"] == pytest.approx(np.linalg.norm(twice * error), rel=1e-9)


def _on_major_loop(inputs):
    """By hand for the protocol of §5.4.1: peaks, negative saturation, and all of the last descent."""
    peaks = np.concatenate([[True], np.diff(inputs) > 0])
    return peaks | (inputs == inputs.min()) | (np.arange(inputs.size) >= int(np.argmax(inputs)))


# --- what it learns from ----------------------------------------------------------------------------------


def test_it_needs_no_first_order_curves_and_the_surfaces_do():
    growing = swept(
        0.0, 20.0, -20.0, 40.0, -45.0, 70.0, -75.0, 100.0, -110.0, 130.0
    )  # from B*, never saturated
    run = driven_run("two_c", growing, seed=3, initial="anhysteretic")
    result = identify(run, "positive")
    assert result.to_json()["points"] == growing.size
    assert error_on(growing, result, "two_c", "anhysteretic") < 0.3
    other = swept(0.0, -35.0, 60.0, -90.0, 85.0, 10.0, 50.0)
    assert error_on(other, result, "two_c", "anhysteretic") < 0.6  # of 33 degrees
    for kind in ("constant", "table", "best"):
        with pytest.raises(DataError, match="no first-order descending curves.*positive surface"):
            identify(run, kind)


def test_runs_without_any_curve_are_reported_and_leave_no_number_undefined():
    result = identify(driven_run("one_c", swept(0.0, 60.0, 174.1), seed=1), "positive")
    assert len(result.data) > 0
    assert result.data.curves == 0
    assert any("no first-order curves" in w for w in result.warnings)
    found = result.to_json()
    json.dumps(found, allow_nan=False)
    assert found["curves"] == 0
    assert found["exercised"] is None
    assert "without first-order curves" in repr(result)


LOOPS = swept(0.0, 130.0, 20.0, 95.0, 35.0, 75.0, 10.0, 50.0)


@pytest.mark.long
def test_other_runs_of_the_wire_make_it_better():
    """By a fifth and more, typically, where a positive measure can be true."""
    ratios = []
    for seed in (4, 14, 24, 34, 44, 54):
        fod, loops = (
            fod_run("one_c", seed=seed),
            driven_run("one_c", LOOPS, seed=seed + 1, name="b.run.sqlite"),
        )
        alone, both = identify(fod, "positive"), identify([fod, loops], "positive")
        assert both.model.fit["points"] == 66 + loops.points()[0].size
        assert len(both.model.provenance) == 2
        ratios.append(error_on(WALK, both, "one_c") / error_on(WALK, alone, "one_c"))
    assert np.median(ratios) < 0.8
    assert max(ratios) < 1.2


@pytest.mark.long("takes three seconds")
def test_where_no_positive_measure_is_true_other_runs_do_no_harm():
    fod, loops = fod_run("one_e", seed=4), driven_run("one_e", LOOPS, seed=5, name="b.run.sqlite")
    alone, both = identify(fod, "positive"), identify([fod, loops], "positive")
    assert error_on(WALK, both, "one_e") < error_on(WALK, alone, "one_e")


def test_ascending_curves_need_no_mirror():
    levels = PARTITION["two"]
    rises = [-u for u in fod_inputs([-v for v in reversed(levels)])]
    result = identify(driven_run("two_e", [-185.0, *rises], seed=2), "positive")
    assert result.data.mirrored  # the curves, as they are drawn
    assert not result.model.mirrored
    walk = np.random.default_rng(2).uniform(-185, 185, 200)
    assert error_on(walk, result, "two_e") < 0.02 * np.ptp(
        Preisach.from_surface(thesis_surface("two_e")).simulate(walk)
    )


def test_a_selection_leaves_its_points_alone():
    run = fod_run("two_p", seed=1)
    even = identify(run, "positive", select="curve%2==0")
    assert even.model.fit["points"] == len(even.data) < 77
    assert even.positive.curves == even.data.curves
    data = identify(run, "constant").data
    left_out = ~np.isin(data.alpha, even.data.alpha) & (data.beta > data.lower)
    error = even.model.hysteresis.y(data.alpha, data.beta) - data.y
    assert np.sqrt(np.mean(error[left_out] ** 2)) > 3 * np.sqrt(np.mean(error[~left_out] ** 2))


def test_reversal_curves_are_fitted_in_the_mirror():
    fields = np.linspace(-185.0, 185.0, 30)
    truth = Preisach.from_surface(thesis_surface("two_c"))
    branches = [(k, fields[fields >= start]) for k, start in enumerate(fields[:-1:2])]
    u = np.concatenate([b for _, b in branches])
    step = np.concatenate([np.full(b.size, float(k)) for k, b in branches])
    y = np.concatenate([truth.simulate(np.concatenate([[185.0], b]))[1:] for _, b in branches])
    run = made_run(u, y, unit="emu", initial=None, protocol="first_order_reversal_curves")
    run = Run(run.path, run.meta, run.columns | {"step": step}, (), ())
    result = identify(run, "positive")
    assert isinstance(result.model.hysteresis, Mirrored)
    assert isinstance(result.model.hysteresis.image, FodTable)
    assert result.model.mirrored
    assert result.density.M_P
    walk = np.random.default_rng(2).uniform(-185, 185, 200)
    assert error_on(walk, result, "two_c") < 0.01 * np.ptp(y)


def test_a_dense_record_is_thinned_but_its_memory_is_not(monkeypatch):
    monkeypatch.setattr(import_module("smarig.identification.fitted_hysteresis"), "MOST_OBSERVATIONS", 300)
    inputs = swept(0.0, 174.1, 20.0, 140.0, 35.0, 120.0, 5.0, 150.0, 30.0, 90.0, points=100)
    k = int(np.flatnonzero(inputs == 5.0)[0]) + 32  # one sample, not kept, that changes everything after it
    inputs[k] = 165.0
    run = without_steps(driven_run("one_e", inputs, seed=6))
    result = identify(run, "positive")
    assert 200 < result.model.fit["points"] < 300
    assert result.model.fit["rms"] < 0.05
    assert error_on(inputs, result, "one_e") < 0.05


def even(name, n=61):
    """The mean of a surface and its own mirror image, F(α, β) = (F₀(α, β) + F₀(−β, −α))/2, as a fine table."""
    s = thesis_surface(name)
    nodes = np.linspace(s.lower, s.upper, n)
    a, b = np.meshgrid(nodes, nodes, indexing="ij")
    high, low = np.maximum(a, b), np.minimum(a, b)
    F = 0.5 * (s.swept(high, low) + s.swept(-low, -high))
    return FodTable.from_arrays(nodes, nodes, np.where(b <= a, F[:, :1] - F[-1, 0] / 2 - F, np.nan))


def test_mirror_symmetry_supplies_what_is_not_measured():
    truth, levels = Preisach.from_surface(even("two_c")), np.linspace(-185.0, 185.0, 12)
    falls = [levels[k::-1] for k in (11, 3, 4)]  # the major loop's descent and two small curves, no more
    inputs = np.concatenate([[-185.0], *falls])
    noise = np.random.default_rng(0).normal(0, 0.05, inputs.size)
    run = made_run(inputs, truth.simulate(inputs) + noise, unit="mT")
    asked, not_asked = identify(run, "positive", symmetric=True), identify(run, "positive")
    assert asked.model.fit["symmetric"] is True
    assert not_asked.model.fit["symmetric"] is False
    walk = np.concatenate([[185.0, -185.0], np.random.default_rng(1).uniform(-185, 185, 100)])
    exact, there = truth.simulate(walk), asked.model.predict(walk)
    back = asked.model.predict(np.concatenate([[185.0], -walk]))[1:]
    np.testing.assert_allclose(there[1:], -back[1:], atol=0.005 * np.ptp(exact))
    assert np.std(there - exact) < 0.1 * np.std(not_asked.model.predict(walk) - exact)


def test_mirror_symmetry_can_be_required_of_a_positive_measure_only():
    with pytest.raises(UsageError, match="positive surface only"):
        identify(fod_run("two_c"), "constant", symmetric=True)
    with pytest.raises(DataError, match="range around zero"):
        identify(fod_run("one_c"), "positive", symmetric=True)


# --- what it warns of -------------------------------------------------------------------------------------


def planted(share):
    """A run of a hysteresis of even density, part of which (in a square) is turned negative."""
    levels = np.linspace(0.0, 100.0, 13)
    cells = np.tri(12)
    cells[7:10, 2:5] = -share
    y = np.zeros((13, 13))
    y[1:, 1:] = np.cumsum(np.cumsum(cells, axis=0), axis=1)
    table = FodTable.from_arrays(levels, levels, np.where(np.tri(13), y, np.nan))
    inputs = fod_inputs(levels)
    noise = np.random.default_rng(0).normal(0, 0.02, len(inputs))
    return made_run(inputs, Preisach.from_surface(table).simulate(inputs) + noise)


@pytest.mark.long("takes three seconds")
def test_the_cost_of_non_negativity_is_reported_where_it_occurs():
    asked = [w for w in identify(planted(3.0), "positive").warnings if "favour negative mass" in w]
    assert len(asked) == 1
    fit = identify(planted(3.0), "positive").model.fit
    assert f"{fit['held_out_rms']:.3g} mm" in asked[0]
    assert f"{fit['signed_held_out_rms']:.3g} mm" in asked[0]
    assert not any("negative mass" in w for w in identify(planted(-1.0), "positive").warnings)


def test_too_few_curves_to_choose_the_smoothing_are_reported():
    result = identify(
        driven_run("one_c", [0, 60, 30, 0, 90, 40, 0, 120, 70, 0, 174.1, 60, 0], seed=1), "positive"
    )
    few = identify(driven_run("one_c", swept(0.0, 174.1, 0.0), seed=1), "positive")
    assert any("smoothing could not be chosen" in w for w in few.warnings)
    assert few.model.fit["held_out_rms"] is None
    assert not any("smoothing" in w for w in result.warnings)


@pytest.mark.long("takes a second")
def test_an_output_that_falls_as_the_input_rises_has_the_model_of_its_negative():
    inputs, outputs = fod_run("one_c", seed=1).points()
    rising, falling = (identify(made_run(inputs, sign * outputs), "positive").model for sign in (1.0, -1.0))
    assert any("falls while the input rises" in w for w in falling.warnings)
    assert np.allclose(falling.predict(inputs), -rising.predict(inputs), atol=1e-9)


@pytest.mark.long(
    "takes two seconds",
    cases=(
        "0.0",
        "5.0",
    ),
)
@pytest.mark.parametrize("mean", [0.0, 5.0])
def test_an_output_of_noise_alone_is_not_reported_with_the_wrong_sign(mean):
    inputs = fod_inputs(PARTITION["one"])
    with pytest.raises(DataError, match="nor its negative: it does not move with the input") as refused:
        identify(made_run(inputs, np.random.default_rng(0).normal(mean, 1.0, len(inputs))), "positive")
    assert "sign" not in str(refused.value)


def test_an_input_that_never_moves_is_named():
    noise = np.random.default_rng(0).normal(size=40)
    with pytest.raises(DataError, match="The input is 50 at every point"):
        identify(made_run([50.0] * 40, noise), "positive")


def test_steps_that_did_not_settle_are_counted_among_all_points():
    run = fod_run("one_e")
    late = tuple(
        type(s)(*(getattr(s, f) for f in list(s.__slots__)[:7]), "timed_out", s.position, s.n)
        if k % 10 == 0
        else s
        for k, s in enumerate(run.steps)
    )
    run = Run(run.path, run.meta, run.columns, late, ())
    assert any("7 of 66 points" in w for w in identify(run, "positive").warnings)


def _loops(clockwise):
    """Growing loops of a surface, or the same loops run the other way round."""
    inputs = swept(0.0, 60.0, 0.0, 120.0, 0.0, 174.1, 0.0, points=20)
    outputs = driven_run("one_e", inputs).points()[1]
    if clockwise:  # y = c u − P[u]: the output leads
        outputs = 2 * np.ptp(outputs) / 174.1 * inputs - outputs
    return made_run(inputs, outputs)


def test_an_output_that_no_positive_measure_follows_gives_no_model():
    with pytest.raises(
        DataError, match=r"has no hysteresis and leaves .* Exchange input and output in the mapping"
    ):
        identify(_loops(clockwise=True), "positive")
    assert identify(_loops(clockwise=False), "positive").positive.reversible_share < 0.5


def test_a_single_valued_output_is_followed_by_a_measure_without_hysteresis():
    inputs = swept(0.0, 100.0, 0.0, 60.0, 0.0, points=20)
    found = identify(made_run(inputs, 0.01 * inputs**1.5), "positive")
    assert found.positive.reversible_share > 0.99


def test_a_few_points_that_any_measure_follows_are_not_called_good():
    few = identify(driven_run("one_e", [0.0, 60.0, 100.0, 140.0, 60.0, 100.0, 140.0], seed=1), "positive")
    assert few.model.noise_floor.value
    assert (few.fit_verdict.level, few.to_json()["verdict"]) == ("unknown", "unknown")
    assert "too few curves to hold one out" in few.fit_verdict.text
    many = identify(fod_run("one_e", seed=1), "positive")
    assert "too few curves" not in many.fit_verdict.text
