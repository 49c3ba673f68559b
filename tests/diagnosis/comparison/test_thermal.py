"""Records of wire temperature: a mechanism that was hidden in an independent wire is named, or its variable is."""

import json
from dataclasses import replace

import numpy as np
import pytest

from computed_once import computed_once
from diagnosis.comparison.heated_wire import ROW_S, Wire
from smarig.core import DataError, UsageError
from smarig.diagnosis import diagnose_transient
from smarig.report import thermal_diagnosis_page

STEPS, SECONDS = 12, 600.0
long = pytest.mark.long("takes ten seconds")
PLAIN = Wire()


@computed_once
def diagnosed(wire, steps=STEPS, seconds=SECONDS, seed=0):
    return diagnose_transient(wire.run(steps, seconds, seed))


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=long), pytest.param(2, marks=long)])
@pytest.mark.parametrize("wire", [PLAIN, pytest.param(Wire(shows_share=True, noise_K=0.4), marks=long)])
def test_a_plain_wire_is_silent(wire, seed):
    found = diagnosed(wire, seed=seed)
    assert found.verdict.word == "silent"
    assert not found.findings
    assert found.base.rms < 0.1
    assert found.parameters()["tau"]["value"] == pytest.approx(12.0, rel=0.01)


@pytest.mark.parametrize(
    ("wire", "name", "values"),
    [
        (Wire(lag_s=2.0), "sensor_lag", {"lag": 2.0, "dead": 0.0}),
        pytest.param(Wire(dead_s=2.5), "sensor_lag", {"lag": 0.0, "dead": 2.5}, marks=long),
        pytest.param(Wire(loss_exponent=0.3), "convection", {"exponent": 0.3}, marks=long),
        pytest.param(Wire(latent_K=12.0), "latent_heat", {"latent_K": 12.0, "cooling_K": 12.0}, marks=long),
        pytest.param(Wire(second_mass=0.3), "settling", {"mass_share": 0.3, "mass_tau": 90.0}, marks=long),
        pytest.param(Wire(room_K_per_s=0.007), "ambient_drift", {"drift": 0.007}, marks=long),
    ],
)
def test_a_hidden_mechanism_is_named_with_its_size(wire, name, values):
    found = diagnosed(wire)
    assert (found.verdict.word, found.verdict.names) == ("named", (name,))
    for parameter, true in values.items():
        finding = found.findings[0].parameters[parameter]
        assert finding["value"] == pytest.approx(true, rel=0.08, abs=ROW_S if name == "sensor_lag" else 0.0)
        assert finding["ci95"][0] <= finding["value"] <= finding["ci95"][1]
    assert found.gain.extended < 0.2 * found.gain.base


@long
@pytest.mark.parametrize(
    ("wire", "variable"),
    [
        (Wire(room_wave_K=2.0), "time"),
        (Wire(resistance_peak=0.3), "temperature"),
        (Wire(pickup_K=5.0), "power"),
    ],
)
def test_a_mechanism_of_no_catalogue_is_unknown_with_its_variable(wire, variable):
    found = diagnosed(wire)
    assert (found.verdict.word, found.verdict.depends_on) == ("unknown", variable)
    assert not found.findings


@pytest.mark.long("takes five seconds")
def test_a_current_heats_with_its_square():
    run = PLAIN.run(STEPS, SECONDS)
    columns = run.columns | {"input": np.sqrt(run["input"])}
    by_current = replace(
        run, meta={**run.meta, "input": {"quantity": "current", "unit": "A"}}, columns=columns
    )
    found = diagnose_transient(by_current)
    assert found.verdict.word == "silent"
    assert found.parameters()["tau"]["value"] == pytest.approx(12.0, rel=0.01)


@pytest.mark.long("takes five seconds")
def test_three_steps_are_too_few_for_a_name():
    found = diagnosed(Wire(lag_s=2.0), steps=3, seconds=200.0)
    assert found.evidence.problem.transients < 10
    assert found.verdict.word != "named"
    assert found.verdict.names[0] == "sensor_lag"
    assert found.candidates[0].parameters["lag"]["value"] == pytest.approx(2.0, rel=0.1)
    text = found.text()
    assert "Candidate, not proved: sensor_lag" in text
    assert "A cause is named from 10 on" in text


def test_the_json_has_the_keys_of_a_diagnosis():
    said = json.loads(json.dumps(diagnosed(Wire(lag_s=2.0)).to_json()))
    assert said["set"] == ["sensor_lag"]
    assert said["effects"][0]["parameters"]["lag"]["unit"] == "s"
    assert sum(h["weight"] for h in said["hypotheses"]) == pytest.approx(1.0)
    assert said["causes"][0] == {
        "kind": "effect",
        "name": "sensor_lag",
        "probability": said["effects"][0]["probability"],
    }
    assert {"latent_heat", "wire_lag"} <= set(said["not_identifiable"])
    assert said["error"]["extended"] < 0.2 * said["error"]["base"]
    assert said["held_out"]["removable_share"] > 0.9
    old = {"verdict", "depends_on", "parameters", "alpha", "p_value", "nulls", "seconds"}
    assert old | {"reason", "missing_knowledge", "adequacy", "separating_run", "stands_out"} <= set(said)


def test_the_page_shows_the_verdict_and_what_was_compared():
    html = thermal_diagnosis_page(diagnosed(Wire(lag_s=2.0)))
    assert "Found: sensor_lag" in html
    assert "Log score" in html


@long
def test_an_effect_that_is_left_out_is_not_named():
    found = diagnose_transient(Wire(lag_s=2.0).run(STEPS, SECONDS), without=["sensor_lag"])
    assert "sensor_lag" not in found.verdict.names
    assert found.verdict.word == "unknown"


def test_what_cannot_be_diagnosed_is_refused():
    run = PLAIN.run(STEPS, 20.0)
    steady = replace(run, columns=run.columns | {"temperature_degC": np.full(len(run), 22.0)})
    unheated = replace(run, columns=run.columns | {"input": np.full(len(run), np.nan)})
    with pytest.raises(DataError, match="too few or too steady"):
        diagnose_transient(steady)
    with pytest.raises(DataError, match="lacks the wire temperature"):
        diagnose_transient(unheated)
    with pytest.raises(UsageError, match="negative"):
        diagnose_transient(run, seed=-1)
    with pytest.raises(UsageError, match="no such effect"):
        diagnose_transient(run, without=["walking"])
