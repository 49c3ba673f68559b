"""Runs to models: the JSON contract, the kinds, and the choice among them."""

import json
import os
from dataclasses import replace

import numpy as np
import pytest

from identification.made_runs import PARTITION, driven_run, fod_run
from smarig.core.errors import DataError, UsageError
from smarig.identification.identify import identify
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.hysteresis.forc_table import ForcTable
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.hysteresis.mirrored import Mirrored
from smarig.preisach.operator import Preisach

CONTRACT = [
    *("model", "surface", "points", "curves", "rms", "norm2", "weighted_norm2"),
    *("mu_min", "mu_max", "classes", "fod_curves_cross", "unit"),
]
WALK = np.random.default_rng(11).uniform(0.0, 174.1, 200)


@pytest.mark.long("takes a second", cases=("best",))
@pytest.mark.parametrize("kind", ["constant", "parabolic", "exponential", "positive", "table", "best"])
def test_json_begins_with_the_contract(kind):
    found = identify(fod_run("one_e", seed=4), kind).to_json()
    assert list(found)[: len(CONTRACT)] == CONTRACT
    json.dumps(found, allow_nan=False)
    points = 66 if kind == "positive" else 65  # it learns from the first point, in saturation, as well
    assert found["points"] == points
    assert found["curves"] == 10
    assert found["unit"] == "mm"
    assert found["classes"].keys() == {"M_PC", "M_P"}
    assert found["norm2"] == pytest.approx(found["rms"] * np.sqrt(points))


def test_the_model_predicts_what_was_not_measured():
    result = identify(fod_run("one_e", seed=4), "exponential")
    truth = Preisach.from_surface(thesis_surface("one_e")).simulate(WALK)
    error = result.model.predict(WALK) - truth
    assert np.sqrt(np.mean(error**2)) < 0.03
    assert result.model.twin
    assert "exponential from 65 points" in repr(result)


LONG = pytest.mark.long("takes three seconds")


@pytest.mark.long("takes two seconds", cases=("one_e-exponential", "two_c-constant"))
@pytest.mark.parametrize(
    ("name", "form"),
    [
        ("one_e", "exponential"),
        pytest.param("two_p", "parabolic", marks=LONG),
        pytest.param("one_c", "constant", marks=LONG),
        ("two_c", "constant"),
    ],
)
def test_best_finds_the_form_of_the_truth_and_the_simplest_that_does(name, form):
    for seed in range(4 if os.environ.get("SMARIG_LONG") else 2):
        result = identify(fod_run(name, seed=seed), "best")
        assert result.surface == form
        rms = result.choice.held_out_rms
        assert rms[form] <= 1.3 * min(rms.values())


@pytest.mark.long("takes a second")
def test_best_gives_the_model_that_its_kind_gives_by_name():
    run = fod_run("two_p", seed=0)
    best, named = identify(run, "best"), identify(run, "parabolic")
    assert best.surface == "parabolic"
    assert best.fit.values.tolist() == named.fit.values.tolist()
    assert best.model.intervals == named.model.intervals
    assert best.model.fit == named.model.fit
    found = best.to_json()
    assert found["held_out_interval"].keys() == found["negative_share"].keys() == found["held_out_rms"].keys()
    assert named.to_json()["held_out_interval"] is None


def test_best_needs_curves_to_hold_out():
    run = driven_run("one_e", [0, 60, 30, 0, 100, 60, 30, 0, 174.1, 100, 60, 30, 0])
    with pytest.raises(DataError, match="at least 4; there are 3"):
        identify(run)


def test_table_meets_every_point_and_admits_negative_cells():
    result = identify(fod_run("one_c", seed=1), "table")
    table = result.model.hysteresis
    assert isinstance(table, FodTable)
    inside = result.data.beta > result.data.lower
    error = table.y(result.data.alpha, result.data.beta) - result.data.y
    assert np.abs(error[inside]).max() < 1e-12
    assert result.fit is None
    assert not result.density.M_P  # noise makes some cells negative …
    assert any("Noise of the readings does that too" in w for w in result.warnings)  # … which is said
    assert identify(fod_run("one_c"), "table").density.M_P


def test_irregular_curves_become_a_table_of_curves():
    result = identify(fod_run("one_e"), "table", select="curve%2==1")
    assert isinstance(result.model.hysteresis, ForcTable)
    assert result.data.curves == 5
    assert any("do not share one partition" in w for w in result.warnings)


def test_reversal_curves_are_fitted_in_the_mirror():
    levels = [-u for u in reversed(PARTITION["two"])]
    rise = [u for k in range(1, len(levels)) for u in [-levels[k], *(-v for v in reversed(levels[:k]))]]
    run = driven_run("two_c", [levels[-1], *rise], initial="anhysteretic")
    result = identify(run, "constant")
    assert isinstance(result.model.hysteresis, Mirrored)
    assert result.model.mirrored
    truth = Preisach.from_surface(thesis_surface("two_c"))
    walk = np.random.default_rng(2).uniform(-185, 185, 100)
    error = result.model.predict(walk) - truth.simulate(walk)
    # the mirror of a constant surface is no constant surface: close, not equal
    assert np.sqrt(np.mean(error**2)) < 0.05 * np.ptp(truth.simulate(walk))


def test_runs_by_path_by_value_one_or_many(tmp_path):
    parts = [
        driven_run("one_e", [0, *[174.1, 141, 111.4, 85.3, 62.7, 43.5, 27.8, 15.7, 7, 1.7, 0]]),
        driven_run("one_e", [0, *[85.3, 62.7, 43.5, 27.8, 15.7, 7, 1.7, 0, 43.5, 27.8, 15.7, 7, 1.7, 0]]),
    ]
    result = identify(parts, "constant")
    assert result.data.curves == 3
    assert len(result.model.provenance) == 2
    with pytest.raises(UsageError, match="no run file"):
        identify(tmp_path / "missing.run.sqlite")
    with pytest.raises(UsageError, match="did you mean exponential"):
        identify(parts, "exponentail")
    with pytest.raises(UsageError, match="finds no point"):
        identify(parts, "constant", select="curve > 99")


def test_steps_that_did_not_settle_are_counted():
    run = fod_run("one_e")
    late = tuple(s if k % 10 else type(s)(*[*(getattr(s, f) for f in s.__slots__)][:7], "timed_out", s.position, s.n)
                 for k, s in enumerate(run.steps))  # fmt: skip
    run = type(run)(run.path, run.meta, run.columns, late, ())
    assert any("6 of 65 points" in w for w in identify(run, "constant").warnings)


@pytest.mark.parametrize("counts", [1.0, 2.5])
def test_a_wire_that_has_not_moved_gives_no_model(counts):
    """A loop that was interrupted before the wire transformed: one count is rounding, not a poor fit."""
    whole = fod_run("one_e", output={"quantity": "position", "unit": "mm", "per_count": 0.05})
    still = np.linspace(0.0, counts * 0.05, len(whole))
    run = replace(whole, columns=whole.columns | {"position": still})
    with pytest.raises(
        DataError, match=rf"moves by .* mm only, {counts:.1f} counts .* heat the wire further"
    ):
        identify([run], "positive")
