"""Diagnosis of measurements by others: the errors of a plain model, with figures.

Each verdict uses the training part alone; held-out parts are for evaluation only. If the data contradict the
expectation, the test states it.
"""

import json
import os
from dataclasses import replace

import numpy as np
import pytest

import smarig
from smarig.cli import run as cli
from smarig.diagnosis.diagnose import diagnose
from smarig.diagnosis.thermal.thermal_diagnosis import diagnose_transient
from smarig.identification.identify import identify
from smarig.record import Run
from smarig.replay import build_timeline, predict

NULLS = 40
EARLY = 6500  # rows of the cycles: the first 25
long = pytest.mark.skipif(not os.environ.get("SMARIG_LONG"), reason="takes ten seconds: SMARIG_LONG=1")
CYCLE = {"cycle", "reversals"}
BY_CYCLE = {"walking", "training", "fatigue"}


def imported(source, mapping, out) -> Run:
    if not source.is_file():
        pytest.skip(f"real data {source.name} are not in {source.parent}")
    assert cli(["import", str(source), "--format", "csv", "--map", mapping, "-o", str(out), "--force"]) == 0
    return smarig.load_run(out)


def part(run: Run, rows: slice) -> Run:
    return replace(run, columns={name: values[rows] for name, values in run.columns.items()})


def test_cycles_depend_on_the_cycle_and_later_ones_are_better_predicted(shared_data, tmp_path):
    run = imported(
        shared_data / "sma_cycles" / "cycles.txt", "sma_cycles_contraction", tmp_path / "c.run.sqlite"
    )
    early, late = part(run, slice(0, EARLY)), part(run, slice(len(run) // 2, None))
    found = diagnose(identify(early, "positive").model, early, late, nulls=NULLS)
    named = {n for n in found.verdict.names if n in BY_CYCLE}
    assert found.verdict.word != "silent"
    assert found.first.p_value <= 2 / (NULLS + 1)
    assert named or found.verdict.depends_on in CYCLE
    assert "creep" in found.visibility.invisible, "without a clock nothing is said of time"
    assert found.gain is not None
    assert found.gain.extended < found.gain.base


@pytest.fixture
def loops(shared_data, tmp_path):
    source = shared_data / "ferroelectric_loops" / "RMN_TRAP_SLOW.dat"
    hertz = {0.1: 1, 0.01: 2, 1.0: 6}
    return {
        f: imported(source, f"ferroelectric_loops:{table}", tmp_path / f"{table}.run.sqlite")
        for f, table in hertz.items()
    }


def test_a_loop_at_one_hertz_does_not_predict_slower_ones(loops):
    model = identify(loops[1.0], "positive").model
    from smarig.replay import plant_model_of

    timeline = build_timeline(list(loops.values()), 1.0)
    error = (
        timeline.settled.value - predict(timeline, plant_model_of(model, timeline.runs[0])).values["settled"]
    )
    rms = {f: float(np.std(error[timeline.run == k])) for k, f in enumerate(loops)}
    assert rms[1.0] < 2.0 < rms[0.1] < rms[0.01]


def test_polarisation_depends_on_the_rate(loops):
    found = diagnose(identify(loops[1.0], "positive").model, list(loops.values()), nulls=NULLS)
    assert found.verdict.word == "unknown"
    assert found.verdict.depends_on == "rate"


def test_a_heating_step_shows_a_sensor_that_answers_late(shared_data, tmp_path):
    run = imported(
        shared_data / "sma_heating_step" / "step.csv", "sma_heating_step", tmp_path / "s.run.sqlite"
    )
    found = diagnose_transient(run, nulls=NULLS)
    assert found.verdict.word == "named"
    assert found.verdict.names == ("sensor_lag",)
    assert found.p_value < 0.03
    assert found.extended.rms < 0.5 * found.base.rms
    assert found.held_out[1] < 0.5 * found.held_out[0]
    low, high = found.parameters()["dead"]["ci95"]
    assert 1.0 < low < high < 6.0, "seconds"
    assert "latent_heat" in found.undetectable


@pytest.mark.parametrize("pulse", [0, pytest.param(1, marks=long), pytest.param(2, marks=long)])
def test_force_pulses_show_a_late_sensor_and_too_much_wandering_for_latent_heat(shared_data, tmp_path, pulse):
    """Expected was latent heat with half the residual; the thermometer wanders by 1 K over thousands of samples."""
    source = shared_data / "sma_force_pulse" / f"AB{pulse}.csv"
    run = imported(source, "sma_force_pulse_heating", tmp_path / "f.run.sqlite")
    found = diagnose_transient(run, nulls=NULLS)
    assert found.verdict.word in ("named", "ambiguous")
    assert "sensor_lag" in found.extended.names
    assert "latent_heat" not in found.extended.names
    assert "latent_heat" not in found.undetectable, "the force tells the transformation: it could have shown"
    latent = next(s for s in found.levels[0].scores if s.name == "latent_heat")
    assert latent.gain < 2.0, "nats"
    assert found.noise.rho > 0.8
    assert found.extended.rms > 0.5 * found.base.rms


def test_the_command_diagnoses_a_transient_and_writes_it(shared_data, tmp_path, capsys):
    run = imported(
        shared_data / "sma_heating_step" / "step.csv", "sma_heating_step", tmp_path / "s.run.sqlite"
    )
    out = tmp_path / "found"
    capsys.readouterr()
    assert cli(["diagnose", "--transient", str(run.path), "--nulls", "35", "-o", str(out), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["verdict"] == "named"
    assert json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))["set"] == ["sensor_lag"]
    assert cli(["diagnose", "--nulls", "35"]) != 0
