"""``identify(extension=…)``: the catalogue, the extension in a model file, and the choice by runs left out."""

import numpy as np
import pytest

import smarig
from identification.extended.test_fits import AGAIN, COARSE, LEVELS, first_order, record, second_order
from smarig.cli.commands.identify import command
from smarig.core.errors import DataError, UsageError
from smarig.identification.extended.extension_names import extension_names
from smarig.identification.identify import identify
from smarig.identification.verify import verify
from smarig.replay.model_file import load_model
from theory.extended import truths

FIRST = first_order(COARSE)
SECOND = second_order(COARSE)
DEEP = [
    [0.0, 125.0, 50.0, 75.0, 50.0, 100.0, 25.0, 75.0, 50.0, 0.0],
    [0.0, 100.0, 25.0, 75.0, 50.0, 75.0, 0.0],
]
INPUTS = [FIRST, SECOND, *DEEP, FIRST]


def runs(wire, inputs=INPUTS):
    return [record(u, wire(u), seed) for seed, u in enumerate(inputs)]


def restricted(u):
    return truths.restricted(u, 1, strength=0.8, m=10)


def test_the_command_offers_every_file_of_the_catalogue():
    (option,) = (p for p in command.params if p.name == "extension")
    assert list(option.type.choices) == list(extension_names())
    with pytest.raises(UsageError, match="did you mean moving"):
        identify(runs(restricted)[:1], "table", extension="movin")


@pytest.mark.parametrize("name", ["restricted", "nonlinear"])
def test_an_extension_is_kept_in_the_file_and_predicts_from_it(name, tmp_path):
    trained = runs(restricted)
    result = identify(trained, "table", extension=name)
    path = result.model.save(tmp_path / "m.model.json")
    again = load_model(path)
    assert again.extension["kind"] == name
    assert np.array_equal(again.predict(DEEP[0]), result.model.predict(DEEP[0]))
    assert not np.array_equal(again.predict(DEEP[0]), again.preisach().simulate(DEEP[0]))
    assert (
        verify(again, trained[2]).runs[0].settled.rms
        < verify(identify(trained, "table").model, trained[2]).runs[0].settled.rms
    )
    with pytest.raises(UsageError, match="requires a classical model"):
        again.check_classical("A loop")


@pytest.mark.long("takes three seconds")
def test_the_best_extension_of_a_restricted_wire_is_the_restricted_model():
    result = identify(runs(restricted), "table", extension="best")
    found = result.to_json()["extension"]
    assert found["chosen"] == "restricted"
    scores = {name: fit["held_out"] for name, fit in found["fits"].items()}
    assert scores["restricted"]["gain_ci95"][0] > 0
    assert scores["restricted"]["extended"] < scores["restricted"]["classical"]
    assert "restricted: largest_excess" in result.extension.text


@pytest.mark.long("takes five seconds")
def test_for_a_classical_wire_no_extension_is_chosen_and_the_file_has_none(tmp_path):
    result = identify(runs(lambda u: truths.classical(u, m=10)), "table", extension="best")
    assert result.to_json()["extension"]["chosen"] == "none"
    assert result.model.extension == {}
    assert "extension" not in result.model.save(tmp_path / "m.model.json").read_text()


@pytest.mark.long("takes three seconds")
def test_accommodation_is_found_and_held_out_runs_show_the_cost_of_drift_in_the_first_order_curves():
    def wire(u):
        return truths.accommodating(u, 0.6, 0.4, m=9)

    result = identify(runs(wire, [first_order(LEVELS), AGAIN, AGAIN]), "table", extension="accommodating")
    fit = result.extension.fits["accommodating"]
    assert fit.p_value < 1e-6
    assert 0.4 < fit.parameters["amount"].value < 0.9
    held_out = result.extension.to_json()["fits"]["accommodating"]["held_out"]
    assert (held_out["runs"], held_out["points"]) == (2, 108)
    assert held_out["extended"] > held_out["classical"], (
        "the table has the drift of its own curves in it already"
    )


def test_what_the_runs_do_not_hold_is_reported():
    with pytest.raises(DataError, match="second_order_transition"):
        identify(runs(restricted, [FIRST, FIRST]), "table", extension="restricted")
    result = identify(runs(restricted, [FIRST, FIRST]), "table", extension="best")
    assert {"moving", "accommodating", "nonlinear", "restricted"} <= set(result.extension.refused)


@pytest.mark.parametrize(
    "wrong", [{"kind": "vector"}, {"kind": "moving"}, {"kind": "accommodating", "amount": 2, "path": 1}]
)
def test_a_damaged_extension_is_named(wrong, tmp_path):
    from dataclasses import replace

    path = replace(identify(runs(restricted)[:1], "table").model, extension=wrong).save(
        tmp_path / "m.model.json"
    )
    with pytest.raises((DataError, UsageError), match="m.model.json"):
        smarig.load_model(path)
