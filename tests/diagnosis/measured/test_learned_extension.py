"""Mechanisms that no catalogue lists are unknown, yet learned: the law, its model on other runs, its page."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from diagnosis.measured.independent_wire import RelayWire, as_run, triangles
from diagnosis.measured.unlisted_mechanisms import MECHANISMS, world
from smarig.core import DataError
from smarig.diagnosis import MeasuredDiagnosis, diagnose_measured
from smarig.diagnosis.comparison.measured.measured_diagnosis import _error_to_beat
from smarig.diagnosis.comparison.measured.measured_extension import extension_by_law
from smarig.diagnosis.comparison.measured.preisach_properties import preisach_properties
from smarig.diagnosis.looks_like import PLANT_EFFECTS, looks_like
from smarig.identification import identify, verify
from smarig.measurement import input_records
from smarig.plant import effect_types
from smarig.record import Step
from smarig.replay import load_model
from smarig.report.measured_diagnosis_page import measured_diagnosis_page

long = pytest.mark.long("takes a minute")


def any_model():
    """A model to extend; the diagnosis refits everything itself."""
    u = triangles((85.0, 62.0, 80.0))
    return identify(as_run("any", u, RelayWire(1).strain(u)), "positive").model


@pytest.fixture(scope="module")
def wider() -> tuple[MeasuredDiagnosis, list]:
    """A loop that widens with the rate; the third run is for the model alone."""
    runs = world("wider_by_rate", 1)
    return diagnose_measured(any_model(), runs[:1], runs[1:2]), runs


@pytest.mark.long("takes twenty seconds")
def test_the_law_of_a_loop_that_widens_with_the_rate_is_learned(wider):
    found, _ = wider
    answer = found.to_json()
    assert answer["verdict"] == "unknown"
    assert answer["depends_on"] == "rate"
    assert not answer["effects"]
    law = answer["learned"]
    assert law["variables"] == ["rate", "direction"]
    assert law["enters"] == "input"
    assert "log10(rate/" in law["formula"]
    assert "input_lag" in law["looks_like"]
    (slow, narrow), (fast, wide) = law["points"]
    per_decade = (wide - narrow) / np.log10(fast / slow)
    true = 3.0 * np.random.default_rng([1, sorted(MECHANISMS).index("wider_by_rate")]).uniform(0.7, 1.5)
    assert per_decade == pytest.approx(true, rel=0.2)
    assert "was learned" in found.text()
    assert answer["held_out"]["removable_share"] > 0.7


@pytest.mark.long("takes twenty seconds")
def test_its_model_refuses_runs_with_settled_steps(wider):
    found, runs = wider
    settled = Step(0, 0, False, "hold", 70.0, 0.0, 10.0, "settled", 0.5, 50)
    with pytest.raises(DataError, match="has settled steps. Identify a model from such runs"):
        verify(found.model, replace(runs[2], steps=(settled,)))


@pytest.mark.long("takes twenty seconds")
def test_the_saved_model_predicts_a_run_that_the_diagnosis_never_had(wider, tmp_path):
    found, runs = wider
    file = found.model.save(tmp_path / "learned.model.json")
    plain = verify(identify(runs[:1], "positive").model, runs[2:]).runs[0].settled.rms
    assert verify(load_model(file), runs[2:]).runs[0].settled.rms < 0.4 * plain
    stored = json.loads(file.read_text(encoding="utf-8"))
    stored["measurement"]["learned"][0]["knots"][0] = 1e9
    file.write_text(json.dumps(stored), encoding="utf-8")
    with pytest.raises(DataError, match="learned term"):
        load_model(file)


@pytest.mark.long("takes twenty seconds")
def test_the_page_draws_the_law(wider):
    page = measured_diagnosis_page(wider[0])
    assert "Learned term" in page
    assert "Half-width of the input" in page


@long
@pytest.mark.long("takes twenty seconds")
def test_a_law_that_is_worse_on_held_out_runs_is_not_offered(wider):
    found, _ = wider
    assert extension_by_law(found.plain, "rate") is not None
    assert extension_by_law(replace(found.plain, error_to_beat=0.0), "rate") is None


def test_an_extension_must_beat_the_given_model_unless_that_knew_the_held_out_runs(monkeypatch):
    run = as_run("held", triangles((85.0,)), RelayWire(1).strain(triangles((85.0,))))
    where = "smarig.diagnosis.comparison.measured.measured_diagnosis.file_hash"
    monkeypatch.setattr(where, lambda _: "abc")
    stranger, maker = (SimpleNamespace(provenance=[SimpleNamespace(sha256=h)]) for h in ("xyz", "abc"))
    base, given = np.full(4, 2.0), np.full(4, 1.0)
    assert _error_to_beat(base, given, stranger, [run]) == pytest.approx(1.0)
    assert _error_to_beat(base, given, maker, [run]) == pytest.approx(2.0)
    assert _error_to_beat(base, np.full(4, np.nan), stranger, [run]) == pytest.approx(2.0)


@long
def test_nothing_is_learned_where_nothing_is_wrong():
    u = triangles((85.0, 62.0, 80.0, 57.0, 85.0, 66.0))
    found = diagnose_measured(any_model(), [as_run("plain", u, RelayWire(1).strain(u), dt=1.0)], [])
    assert found.verdict.word == "silent"
    assert found.learned is None
    assert found.to_json()["learned"] is None
    assert "return" not in found.text()


def test_effects_that_it_looks_like_exist():
    known = {k.name for k in effect_types()}
    assert {name for names in PLANT_EFFECTS.values() for name in names} <= known
    assert "ratcheting" in looks_like("cycle")


@long
@pytest.mark.parametrize("name", sorted(MECHANISMS))
def test_a_learned_model_is_better_on_other_runs(name):
    runs = world(name, 3)
    found = diagnose_measured(any_model(), runs[:1], runs[1:2])
    if found.learned is not None:
        assert found.gain is not None
        assert found.gain.extended < found.gain.base


# --- properties of every Preisach operator -----------------------------------------------------------------


def nested(y_of):
    """Minor excursions on rising branches that close and go on."""
    u = np.concatenate(
        [triangles((70.0,), 40), *(np.linspace(a, b, 30)[1:] for a, b in PATH), np.linspace(85.0, 25.0, 40)]
    )
    return input_records([as_run("nested", u, y_of(u), dt=1.0)])


PATH = [(25, 45), (45, 38), (38, 55), (55, 46), (46, 62), (62, 50), (50, 70), (70, 58), (58, 85)]


def test_minor_loops_of_relays_return_and_are_wiped_out():
    found = {t.name: t for t in preisach_properties(nested(RelayWire(2).strain))}
    assert found["return_point"].tested >= 4
    assert found["return_point"].holds


def test_minor_loops_that_lose_a_little_do_not_return():
    wire = RelayWire(2)

    def losing(u):
        back = np.cumsum(np.maximum(-np.diff(u, prepend=u[0]), 0.0))
        return wire.strain(u) + 0.03 * back

    found = {t.name: t for t in preisach_properties(nested(losing))}
    assert not found["return_point"].holds
    assert found["return_point"].violated_rms == pytest.approx(0.03 * 9.5, rel=0.3)


def test_branches_that_shift_from_cycle_to_cycle_are_not_wiped_out():
    wire, u = RelayWire(2), triangles((85.0,) * 6, 40)
    drifting = wire.strain(u) + 0.002 * np.arange(u.size)
    for y, holds in ((wire.strain(u), True), (drifting, False)):
        (test,) = preisach_properties(input_records([as_run("cycles", u, y, dt=1.0)]))
        assert test.name == "wiping_out"
        assert test.holds is holds


@pytest.mark.long("takes twenty seconds")
def test_a_single_loop_shows_neither_and_a_failure_is_stated(wider):
    u = triangles((85.0,))
    assert preisach_properties(input_records([as_run("one", u, RelayWire(2).strain(u))])) == ()
    failed = replace(wider[0])
    failed.__dict__["properties"] = (
        replace(wider[0].properties[0], name="return_point", lower=1.0, limit=0.1),
    )
    assert "Minor loops do not return" in failed.text()
