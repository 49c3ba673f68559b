"""``identify`` recognises a run of sweeps: the model carries τ, and predicts settled holds of a hidden wire."""

from dataclasses import replace

import numpy as np
import pytest

from identification.made_runs import made_run
from identification.sweeps.relay_wire import (
    PER_COUNT,
    TAU_S,
    heated,
    relays,
    swept_run,
    switched,
)
from smarig.core import DataError
from smarig.identification import identify, verify
from smarig.plant import Actuator
from smarig.replay import load_model, with_heating_of
from smarig.replay.plant_model import actuator_of

TAU = 1.4


@pytest.fixture(scope="module")
def result():
    return identify(swept_run({"curves": 15}, tau=TAU), "positive")


def settled_run(seed):
    """Settled holds of the same relays, read to a tenth of a count."""
    inputs = np.concatenate([[0.0], np.random.default_rng(seed).uniform(0, 170, 40)])
    y = np.round(switched(inputs, *relays()) / PER_COUNT, 1) * PER_COUNT
    return made_run(inputs, y, encoder_zero="power-up", actuator="gorbet_one_wire")


def test_the_model_predicts_settled_holds(result):
    errors = verify(result.model, settled_run(5)).runs[0]
    assert errors.offset_kind == "known"
    assert errors.settled.rms < 0.8 * PER_COUNT


def test_the_model_file_carries_the_heating(result, tmp_path):
    model = load_model(result.model.save(tmp_path / "fast.model.json"))
    heating = model.fit["heating"]["parameters"]
    assert heating["tau"]["value"] == pytest.approx(TAU * TAU_S, rel=0.02)
    assert heating["R_M"]["value"] == pytest.approx(5.0, abs=0.05)
    assert heating["R_A"]["value"] == pytest.approx(4.5, abs=0.05)
    assert "R/hA" in model.fit["heating"]["not_available"]["R_over_hA"]
    wire = actuator_of(model)
    assert wire.tau_s == pytest.approx(heating["tau"]["value"], rel=1e-4)
    assert (
        wire.gain_K_per_A2 == Actuator.named("gorbet_one_wire").gain_K_per_A2
    )  # inputs stay those of the record
    assert result.to_json()["heating"]["lack_of_fit"] < 2


def test_samples_of_a_run_are_predicted_with_the_tau_of_the_model(result):
    run = swept_run(tau=TAU, seed=4, wire=relays())
    truth = heated(run["current_A"], TAU * TAU_S)
    assert np.abs(with_heating_of(result.model, run)["input"] - truth).max() < 1.5
    assert np.abs(run["input"] - truth).max() > 10
    errors = verify(result.model, run).runs[0].settled
    assert errors.rms < 1.2 * PER_COUNT
    assert with_heating_of(result.model, run.with_meta(actuator="another")).columns is run.columns


def test_other_models_leave_runs_as_they_are(result):
    run = swept_run()
    plain = replace(result.model, fit={k: v for k, v in result.model.fit.items() if k != "heating"})
    assert with_heating_of(plain, run) is run


def test_sweeps_at_one_rate_give_no_model():
    with pytest.raises(DataError, match="Measure with two rates"):
        identify(swept_run({"curves": 8, "rates_K_per_s": "6"}), "positive")
