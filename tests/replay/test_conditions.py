"""Conditions of runs are compared: pooling, a model and a run of other conditions, and what counts as the same."""

from dataclasses import replace

import pytest

from diagnosis.measured.independent_wire import RelayWire, as_run, triangles
from smarig.identification import identify, verify
from smarig.replay import foreign_conditions, load_model, pooled_conditions

T = triangles((90.0, 70.0), rows=40)
STRAIN = RelayWire(1).strain(T)


def under(name="a", **conditions):
    """A run with conditions: a text, or (mean, unit)."""
    stored = {
        k: {"text": v} if isinstance(v, str) else {"mean": v[0], "unit": v[1], "min": v[0], "max": v[0]}
        for k, v in conditions.items()
    }
    run = as_run(name, T, STRAIN)
    return replace(run, meta={**run.meta, "conditions": stored})


@pytest.mark.long("takes three seconds")
def test_pooled_stresses_are_said_in_one_sentence_and_kept_with_the_model(tmp_path):
    runs = [under(str(s), stress=(s, "MPa")) for s in (100.0, 50.0, 150.0)]
    sentence = (
        "These runs were made under 50, 100 and 150 MPa; the model pools them as one wire. "
        "To model the load, use smarig identify with --load-from stress."
    )
    model = load_model(identify(runs, "positive").model.save(tmp_path / "m.model.json"))
    assert sentence in model.warnings
    assert [p.conditions["stress"].value for p in model.provenance] == [100.0, 50.0, 150.0]


@pytest.mark.parametrize(
    ("a", "b", "sentence"),
    [
        ({"stress": (100.0, "MPa")}, {"stress": (103.0, "MPa")}, ""),
        ({"room_temperature": (20.0, "degC")}, {"room_temperature": (22.0, "degC")}, ""),
        (
            {"room_temperature": (0.5, "degC")},
            {"room_temperature": (9.0, "degC")},
            "room temperature of 0.5 and 9 °C",
        ),
        ({"frequency": (0.1, "Hz")}, {"frequency": (1.0, "Hz")}, "made at 0.1 and 1 Hz;"),
        ({"specimen": "A"}, {"specimen": "B"}, "of specimen A and B;"),
        ({"load": (2.0, "N")}, {"load": (4.0, "N")}, "under a load of 2 and 4 N;"),
        ({"humidity": (20.0, "1")}, {"humidity": (60.0, "1")}, "at humidity 20 and 60;"),
        ({"stress": (100.0, "MPa")}, {}, ""),
    ],
)
def test_only_differences_are_said(a, b, sentence):
    found = " ".join(pooled_conditions([under("a", **a), under("b", **b)]))
    assert sentence in found
    assert bool(found) == bool(sentence)


def test_a_condition_that_the_model_depends_on_is_not_pooled():
    runs = [under(str(s), stress=(s, "MPa")) for s in (50.0, 150.0)]
    assert pooled_conditions(runs, {"stress"}) == []


def test_verify_says_that_a_run_was_made_under_another_condition():
    model = identify(under(stress=(50.0, "MPa"), specimen="A"), "positive").model
    same, other = under("same", stress=(52.0, "MPa")), under("other", stress=(80.0, "MPa"), specimen="B")
    assert not [w for w in verify(model, same).runs[0].warnings if "made" in w]
    warnings = verify(model, other).runs[0].warnings
    assert "The run was made under 80 MPa, the model from runs under 50 MPa." in warnings
    assert "The run was made of specimen B, the model from runs of specimen A." in warnings


def test_a_model_of_old_files_knows_no_conditions():
    model = identify(as_run("a", T, STRAIN), "positive").model
    assert foreign_conditions(model, under(stress=(80.0, "MPa"))) == []
