"""Diagnosis of measurements by others: the errors of a plain model, with figures.

Each verdict uses the training part alone; held-out parts are for evaluation only. If the data contradict the
expectation, the test states it.
"""

import json
from dataclasses import replace

import numpy as np
import pytest

import smarig
from smarig.cli import run as cli
from smarig.diagnosis import Part, diagnose_measured, diagnose_transient
from smarig.identification.identify import identify
from smarig.identification.verify import verify
from smarig.record import Run
from smarig.replay import build_timeline, load_model, predict

EARLY = 6500  # rows of the cycles: the first 25
long = pytest.mark.long("takes ten seconds")


def imported(source, mapping, out) -> Run:
    if not source.is_file():
        pytest.skip(f"real data {source.name} are not in {source.parent}")
    assert cli(["import", str(source), "--format", "csv", "--map", mapping, "-o", str(out), "--force"]) == 0
    return smarig.load_run(out)


def part(run: Run, rows: slice) -> Run:
    return replace(run, columns={name: values[rows] for name, values in run.columns.items()})


def given(run):
    """A model to compare with, from one run."""
    return identify(run, "positive").model


@pytest.mark.long
def test_a_thermometer_in_a_glued_tube_lags_and_undoing_it_predicts_other_days(shared_data, tmp_path):
    """Known: about 4 s; undoing it takes the error of a relay grid from 0.061 to 0.016 of the stroke."""
    runs = [
        imported(
            shared_data / "sma_water_steps" / f"hyd_stp_{k}.txt",
            "sma_water_steps",
            tmp_path / f"w{k}.run.sqlite",
        )
        for k in (1, 2, 3)
    ]
    found = diagnose_measured(given(runs[0]), runs[:1], runs[1:])
    assert found.verdict.names == ("input_lag",)
    low, high = found.effects()[0]["parameters"]["lag_s"]["ci95"]
    assert 2.0 < low < 4.0 < high, "one excursion: the interval is wide above"
    assert found.effects()[0]["parameters"]["lag_s"]["value"] == pytest.approx(4.2, rel=0.1)
    stroke = np.nanmax(runs[0]["position"]) - np.nanmin(runs[0]["position"])
    assert found.rms(found.best) < 0.025 * stroke < 0.3 * found.rms()
    model = load_model(found.model.save(tmp_path / "lag.model.json"))
    errors = [r.settled.nrmse for r in verify(model, runs[1:]).runs]
    assert max(errors) < 0.05


@pytest.mark.parametrize(("train", "held_out"), [((50, 100), 150), pytest.param((50, 150), 100, marks=long)])
@pytest.mark.long("its study is tested")
def test_a_wire_under_other_loads_shifts_by_clausius_and_clapeyron(shared_data, tmp_path, train, held_out):
    """Known: about 8 MPa/K. A load between and one beyond are predicted with half the error of the nearest load."""

    def loaded(stress):
        source = shared_data / "flexinol_isobaric" / f"filtered_data_{stress}MPa.txt"
        return imported(source, "flexinol_isobaric", tmp_path / f"{stress}.run.sqlite")

    runs, other = [loaded(s) for s in train], loaded(held_out)
    nearest = given(loaded(100) if held_out == 150 else runs[0])
    found = diagnose_measured(nearest, runs, [other])
    assert found.verdict.names == ("stress_shift",)
    assert 6.0 < found.effects()[0]["parameters"]["MPa_per_K"]["value"] < 10.0
    assert found.gain is not None
    assert found.gain.extended < 0.5 * verify(nearest, other).runs[0].settled.rms


@pytest.mark.long("its study is tested")
def test_the_thermometer_of_another_day_is_off(shared_data, tmp_path):
    """Known: about 3 K between the two runs."""
    runs = [
        imported(
            shared_data / "sma_force_runs" / f"AB{k}_thin.csv",
            "sma_force_runs",
            tmp_path / f"f{k}.run.sqlite",
        )
        for k in (5, 7)
    ]
    found = diagnose_measured(given(runs[0]), runs[:1], runs[1:])
    assert not found.effects()
    assert found.verdict.depends_on == "run"
    (offset,) = found.offsets
    assert offset.interval[0] < 3.0 < offset.interval[1], "two excursions tell little of its size"
    assert 1.0 < offset.offset < 5.0


@pytest.mark.long("its study is tested")
def test_cycles_leave_a_strain_behind(shared_data, tmp_path):
    run = imported(
        shared_data / "sma_cycles" / "cycles.txt", "sma_cycles_contraction", tmp_path / "c.run.sqlite"
    )
    found = diagnose_measured(given(part(run, slice(0, EARLY))), [run], [])
    assert found.verdict.depends_on == "cycle"
    assert found.extended


@pytest.mark.long
def test_a_chamber_whose_thermometer_failed_for_some_rows(shared_data, tmp_path):
    run = imported(
        shared_data / "sma_chamber" / "chamber_100MPa.csv", "sma_chamber", tmp_path / "ch.run.sqlite"
    )
    found = diagnose_measured(given(part(run, slice(None, None, 20))), [run], [])
    zeros = int(np.sum(run["input"] == 0))
    assert 0 < sum(r.dropouts for r in found.records) < zeros, "it also passes 0 °C twice"
    assert not found.effects()


@pytest.mark.parametrize(
    "name",
    [pytest.param("MSM33-55-1_d330.forc", marks=long), pytest.param("UB199BF", marks=long), "hchb_forc"],
)
def test_magnetic_reversal_curves_are_silent(shared_data, tmp_path, name):
    source, target = shared_data / "forc_magnetic" / name, tmp_path / "m.run.sqlite"
    if not source.is_file():
        pytest.skip(f"real data {name} are not in {source.parent}")
    assert cli(["import", str(source), "--format", "forc", "-o", str(target)]) == 0
    run = smarig.load_run(target)
    found = diagnose_measured(identify(run, "table", select="curve%2==0").model, [run], [])
    assert found.verdict.word == "silent"


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


@pytest.mark.long
def test_polarisation_depends_on_the_rate(loops):
    found = diagnose_measured(given(loops[1.0]), list(loops.values()), [])
    assert found.verdict.word == "unknown"
    shares = {p.name: w for p, w in found.evidence.weights.causes.items()}
    assert shares["rate"] + shares["time_since_reversal"] > 0.9, "one cycle at each rate cannot part them"
    assert shares["rate"] > 0.2


@pytest.mark.long("takes three seconds")
def test_a_heating_step_shows_a_sensor_that_answers_late(shared_data, tmp_path):
    """Known: a dead time of some seconds. One transient is too few for a name, but not for the likeliest cause."""
    run = imported(
        shared_data / "sma_heating_step" / "step.csv", "sma_heating_step", tmp_path / "s.run.sqlite"
    )
    found = diagnose_transient(run)
    assert found.verdict.word in ("ambiguous", "unknown")
    assert found.verdict.names[0] == "sensor_lag"
    assert found.evidence.problem.transients == 1
    assert found.extended.rms < 0.5 * found.base.rms
    assert found.gain.extended < 0.5 * found.gain.base
    parameters = found.parameters()
    low, high = parameters["dead"]["ci95"]
    assert 2.0 < parameters["dead"]["value"] < 4.5, "seconds"
    assert low < 3.5 < high
    assert "latent_heat" in found.not_testable


@pytest.mark.parametrize("pulse", [0, pytest.param(1, marks=long), pytest.param(2, marks=long)])
@pytest.mark.long("takes ten seconds")
def test_force_pulses_wander_too_much_for_a_name(shared_data, tmp_path, pulse):
    """The thermometer wanders by 1 K over thousands of samples, and no hypothesis predicts that."""
    source = shared_data / "sma_force_pulse" / f"AB{pulse}.csv"
    run = imported(source, "sma_force_pulse_heating", tmp_path / "f.run.sqlite")
    found = diagnose_transient(run)
    assert found.verdict.word == "unknown"
    assert "latent_heat" not in found.not_testable, "the force tells the transformation: it could have shown"
    assert found.evidence.weights.causes[Part("effect", "latent_heat")] < 0.1
    assert found.evidence.evidence.error > 10 * found.evidence.evidence.noise


@pytest.mark.long("takes ten seconds")
def test_the_command_diagnoses_a_transient_and_writes_it(shared_data, tmp_path, capsys):
    run = imported(
        shared_data / "sma_heating_step" / "step.csv", "sma_heating_step", tmp_path / "s.run.sqlite"
    )
    out = tmp_path / "found"
    capsys.readouterr()
    assert cli(["diagnose", "--transient", str(run.path), "--nulls", "35", "-o", str(out), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["parameters"]["dead"]["unit"] == "s"
    assert json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))["set"][0] == "sensor_lag"
    assert "Temperature and drive" in (out / "report.html").read_text(encoding="utf-8")
    assert cli(["diagnose", "--nulls", "35"]) != 0
