"""A study of somebody's files, as they are, names what is known to be behind their errors, and nothing else.

The known causes are those of the notes beside the data, found by independent calculations or stated by the sources.
"""

import pytest

from smarig.study import StudyOptions, study
from smarig.study.study_sentences import measure

long = pytest.mark.long("takes up to half a minute")
WATER = [f"sma_water_steps/hyd_stp_{k}.txt" for k in (1, 2, 3)]
FLEXINOL = [f"flexinol_isobaric/filtered_data_{k}MPa.txt" for k in (50, 100, 150)]
ISOBARIC = [f"sma_isobaric/cal_sample_2/{k} MPa.txt" for k in (7, 50, 100, 200, 300, 400)]


def studied(shared_data, files, out):
    paths = [shared_data / file for file in files]
    if missing := [p for p in paths if not p.is_file()]:
        pytest.skip(f"real data {missing[0].name} are not in {missing[0].parent}")
    return study(paths, out, StudyOptions())


def value(found, name):
    (effect,) = found.diagnosis.effects()
    return effect["parameters"][name]["value"], effect["parameters"][name]["ci95"]


@pytest.mark.long("takes ten seconds", cases=("magnetic 1", "magnetic 2", "staircase"))
@pytest.mark.parametrize(
    ("files", "names"),
    [
        pytest.param(WATER, ("input_lag",), id="water", marks=long),
        pytest.param(FLEXINOL, ("stress_shift",), id="flexinol", marks=long),
        pytest.param(ISOBARIC, ("stress_shift",), id="isobaric", marks=long),
        pytest.param(["sma_cycles/cycles.txt"], ("ratcheting",), id="cycles", marks=long),
        pytest.param(["sma_staircase/test.csv"], (), id="staircase"),
        pytest.param(["forc_magnetic/MSM33-55-1_d330.forc"], (), id="magnetic 1"),
        pytest.param(["forc_magnetic/hchb_forc"], (), id="magnetic 2", marks=long),
        pytest.param(["forc_magnetic/UB199BF"], (), id="magnetic 3", marks=long),
        pytest.param([f"sma_nested_bumps/ele_hys_{k}.txt" for k in range(1, 6)], (), id="bumps", marks=long),
    ],
)
def test_the_known_cause_is_named(shared_data, files, names, tmp_path):
    found = studied(shared_data, files, tmp_path / "out")
    assert found.diagnosis is not None
    assert found.diagnosis.verdict.names == names
    if not names:
        assert not found.diagnosis.effects()
        return
    best, plain = found.evaluation.best.rms, found.evaluation.plain.rms
    assert best < 0.9 * plain, "the cause must predict what was held out"
    assert any(names[0] in sentence for sentence in found.sentences())
    with_cause, without = found.evaluation.extended.rms, found.without_cause
    assert with_cause <= 0.9 * without <= 0.9 * plain, (
        "the sentence compares what the table of the page shows"
    )
    shown = (
        f"the error is {measure(with_cause, found.unit)} with it and {measure(without, found.unit)} without."
    )
    assert any(shown in sentence for sentence in found.sentences())


@long
def test_the_lag_of_the_thermometer_in_rows_contains_the_known_one(shared_data, tmp_path):
    """About 4 s, at 0.1 s a row, of which the files say nothing."""
    _, (low, high) = value(studied(shared_data, WATER, tmp_path / "out"), "lag_rows")
    assert low <= 40 <= high


@long
@pytest.mark.parametrize(("files", "known"), [(FLEXINOL, 8.0), (ISOBARIC, 10.0)])
def test_the_slope_of_the_transformation_contains_the_known_one(shared_data, files, known, tmp_path):
    _, (low, high) = value(studied(shared_data, files, tmp_path / "out"), "MPa_per_K")
    assert low <= known <= high


@pytest.mark.long("takes three seconds")
def test_a_thermometer_that_was_moved_between_two_days(shared_data, tmp_path):
    found = studied(shared_data, [f"sma_force_runs/AB{k}_thin.csv" for k in (5, 7)], tmp_path / "out")
    (offset,) = found.diagnosis.offsets
    assert offset.interval[0] < 3.0 < offset.interval[1]
    assert any("02_AB7_thin is shifted by" in sentence for sentence in found.sentences())
    assert not any("no known effect" in sentence for sentence in found.sentences())


@long
def test_drop_outs_and_another_load_are_told(shared_data, tmp_path):
    found = studied(shared_data, [f"sma_chamber/chamber_{k}MPa.csv" for k in (100, 200)], tmp_path / "out")
    assert not found.diagnosis.effects()
    assert "drop-outs of the instrument" in found.diagnosis.text()
    assert any("The stress differs: 197 MPa" in reason for reason in found.reasons)


@long
def test_a_loop_that_depends_on_the_rate_is_told_as_one(shared_data, tmp_path):
    found = studied(shared_data, ["ferroelectric_loops/RMN_TRAP_SLOW.dat"], tmp_path / "out")
    assert found.diagnosis.verdict.depends_on == "rate"
