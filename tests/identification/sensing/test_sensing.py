"""Self-sensing identified from runs of the twin: its constants are recovered, held-out runs are within the interval."""

import json
from dataclasses import replace

import numpy as np
import pytest

from smarig.cli import run as cli
from smarig.control import SelfSensing
from smarig.core import DataError, UsageError
from smarig.identification import identify, identify_sensing, sensing_errors, sensing_text
from smarig.plant import effects_from_pairs
from smarig.record import load_run
from smarig.replay import load_model
from smarig.report import closed_loop_result
from smarig.report.closed_loop.loop_result import RegulationResult
from smarig.rig import TwinSettings
from smarig.runner import Session, run

LEVELS = (0.0, 40.0, 90.0, 130.0, 170.0)
long = pytest.mark.long("campaign of an hour")


@pytest.fixture(scope="module")
def commissioned(tmp_path_factory):
    """A folder with two runs, a model without and one with self-sensing."""
    folder = tmp_path_factory.mktemp("sensing")
    rig = "one_wire_twin"
    fod = run("first_order_descending", rig=rig, out=folder / "fod.run.sqlite", seed=1, partition_K=LEVELS)
    run("validation", rig=rig, out=folder / "val.run.sqlite", seed=2, points=5)
    run("validation", rig=rig, out=folder / "held.run.sqlite", seed=3, points=8)
    identify([fod], surface="exponential").model.save(folder / "wire.model.json")
    words = [folder / name for name in ("wire.model.json", "fod.run.sqlite", "val.run.sqlite")]
    assert cli(["sense", *map(str, words), "-o", str(folder / "sensing.model.json")]) == 0
    return folder


@pytest.mark.long("takes three seconds")
def test_the_resistances_of_both_phases_are_recovered(commissioned):
    model = load_model(commissioned / "sensing.model.json")
    sensing = SelfSensing.from_json(model.self_sensing)
    wire = sensing.wires[0]
    low, high = wire.intervals["1"]
    assert low - 0.002 <= 5.0 <= high + 0.002  # R_M
    assert wire.coefficients["1"] + wire.coefficients["y"] * sensing.stroke == pytest.approx(
        4.5, abs=0.01
    )  # R_A
    assert sensing.noise_V == pytest.approx(np.hypot(0.002, 4.75 * 0.0002), rel=0.15)  # of the rig file
    assert "falls with the position" in " ".join(sensing_text(sensing, "mm"))


def test_a_held_out_run_is_within_its_intervals(commissioned):
    model = load_model(commissioned / "sensing.model.json")
    (found,) = sensing_errors(model, [load_run(commissioned / "held.run.sqlite")])
    figures = found.to_json()
    assert figures["coverage_95"] >= 0.93
    assert figures["rms_of_stroke"] < 0.01
    assert figures["r_squared"] > 0.99
    assert figures["no_reading"] < 0.5


def with_effect(commissioned, folder, name):
    """Self-sensing of a twin with an effect that the map does not know, and its figures on a held-out run."""
    runs = []
    for seed in (4, 5):
        settings = TwinSettings(seed=seed, effects=effects_from_pairs([name]))
        with Session("one_wire_twin", twin=settings) as session:
            path = folder / f"{seed}.run.sqlite"
            runs.append(load_run(session.run("validation", {"points": 6}, path)))
    model = load_model(commissioned / "wire.model.json")
    sensing, _ = identify_sensing(model, runs[:1])
    (found,) = sensing_errors(replace(model, self_sensing=sensing.to_json()), runs[1:])
    return sensing, found.to_json()


@pytest.mark.long("takes two seconds")
def test_a_motion_without_a_change_of_resistance_makes_the_readings_ambiguous(commissioned, tmp_path):
    """The R-phase moves the wire of this twin and leaves its resistance as it is."""
    plain = SelfSensing.from_json(load_model(commissioned / "sensing.model.json").self_sensing)
    sensing, figures = with_effect(commissioned, tmp_path, "r_phase")
    assert sensing.wires[0].error_ohm > 3 * plain.wires[0].error_ohm
    assert figures["ambiguous"] > 0.5
    assert figures["coverage_95"] >= 0.9


@pytest.mark.long("takes two seconds")
def test_another_law_of_the_resistance_is_learnt(commissioned, tmp_path):
    sensing, figures = with_effect(commissioned, tmp_path, "resistance_phase")
    assert sensing.wires[0].coefficients["y"] == pytest.approx(
        -0.079, rel=0.1
    )  # twice that of the two phases
    assert figures["coverage_95"] >= 0.9
    assert figures["rms_of_stroke"] < 0.02


def test_runs_that_do_not_determine_a_resistance_are_refused(commissioned):
    model, held = load_model(commissioned / "wire.model.json"), load_run(commissioned / "held.run.sqlite")
    blind = held.columns | {"voltage_V": np.full(len(held), np.nan)}
    with pytest.raises(DataError, match="no measured voltage"):
        identify_sensing(model, [replace(held, columns=blind)])
    cold = held.columns | {"current_A": np.zeros(len(held))}
    with pytest.raises(DataError, match="no resistance is known"):
        identify_sensing(model, [replace(held, columns=cold)])
    with pytest.raises(UsageError, match="has no self-sensing"):
        sensing_errors(model, [held])


@pytest.mark.long("takes three seconds")
def test_regulation_without_encoder_on_the_command_line(commissioned, capsys):
    words = ["regulate", str(commissioned / "sensing.model.json"), "--setpoint", "6", "--hold-s", "60"]
    words += ["--rig", "one_wire_twin", "--within", "0.05", "--quiet", "--json"]
    out = commissioned / "observed.run.sqlite"
    assert cli([*words, "--feedback", "resistance", "-o", str(out)]) == 0
    figures = json.loads(capsys.readouterr().out)["regulate"]["self_sensing"]
    assert figures["coverage_95"] >= 0.9
    assert abs(figures["steady_error"]) < 0.1
    assert figures["ambiguous"] < 0.05
    result = closed_loop_result(load_run(out))
    assert isinstance(result, RegulationResult)
    assert result.observed is not None
    assert result.observed.t_s.size == 600  # every tick is in the run file
    assert cli(["report", str(out)]) == 0
    assert "Feedback: resistance" in out.with_name("observed.html").read_text(encoding="utf-8")
    wire = [w.replace("sensing.model", "wire.model") for w in words]
    assert cli([*wire, "--feedback", "resistance", "-o", str(commissioned / "no.run.sqlite")]) == 2
    assert "has no self-sensing" in capsys.readouterr().err


@long
def test_campaign_of_the_benchmark():
    from benchmarks.self_sensing import WANTED_DETECTED
    from benchmarks.self_sensing import run as campaign

    for rig, found in campaign().items():
        assert found["resistance"]["tripped"] == 0, rig
        assert found["path"]["detected"] >= WANTED_DETECTED, rig
        assert found["path"]["coverage_95"] >= 0.9, rig
