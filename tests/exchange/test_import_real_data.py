"""Measurements by others: every file imports, physical facts hold, and errors in the files are reported.

Needs the folder ../shared/data next to the repository; skipped without it.
"""

from functools import cache
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from smarig.core.errors import DataError
from smarig.exchange import correct_drift_if_it_helps, import_file
from smarig.exchange.checks.drift import ForcCurves
from smarig.record import Run, load_run

DATA = Path(__file__).resolve().parents[2] / ".." / "shared" / "data"


@cache
def _run(name: str, mapping: str | None, format: str = "csv") -> Run:
    with TemporaryDirectory() as folder:
        report = import_file(DATA / name, format=format, mapping=mapping, out=Path(folder) / "x.run.sqlite")
        return load_run(report.run)


def real(name: str, mapping: str | None = None, format: str = "csv") -> tuple[Run, str]:
    """The imported run and all its warnings as one text."""
    if not (DATA / name).exists():
        pytest.skip(f"real data {name} are not in ../shared/data")
    run = _run(name, mapping, format)
    return run, "\n".join(run.meta["warnings"])


# --- the wire on a current staircase --------------------------------------------------------------------


def test_staircase_has_41_readings_up_and_41_down():
    run, _ = real("sma_staircase/test.csv", "sma_staircase")
    assert len(run.steps) == len(run) == 82
    assert [s.branch for s in run.steps] == ["up"] * 41 + ["down"] * 41
    np.testing.assert_allclose(run["current_command_A"][:41], np.arange(41) * 0.02, atol=1e-12)
    np.testing.assert_allclose(run["current_command_A"][41:], np.arange(40, -1, -1) * 0.02, atol=1e-12)
    inputs, outputs = run.points()
    np.testing.assert_array_equal(inputs, run["current_A"])
    assert outputs.min() == -0.008
    assert outputs.max() == 16.92


def test_staircase_loop_is_open_and_lags():
    run, _ = real("sma_staircase/test.csv", "sma_staircase")
    i, x = run.points()
    width_A = np.interp(8.0, x[:41], i[:41]) - np.interp(8.0, x[:40:-1], i[:40:-1])
    assert 0.15 < width_A < 0.25  # at half stroke: heating needs more current than cooling


def test_staircase_resistance_is_that_of_a_wire():
    run, _ = real("sma_staircase/test.csv", "sma_staircase")
    flowing = run["current_A"] > 0.1
    ohms = run["voltage_V"][flowing] / run["current_A"][flowing]
    assert 2.5 < ohms.min() < ohms.max() < 4.0


def test_staircase_faults_are_reported():
    run, said = real("sma_staircase/test.csv", "sma_staircase")
    assert "temperature_degC is clipped at 150.792 degC in 10 rows" in said
    assert "listed twice" in said
    assert "steps of 0.085 mm" in said
    assert "'dLd0 [mm]' is column 'dLzmd0 [mm]' -0.248: the same data with another zero" in said
    assert "-0.008 → 0.248 mm over 2 visits" in said
    assert "differs from its command by 5 mA" in said
    assert int((run["quality"] == 4).sum()) == 10


# --- isobaric thermal cycles -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "mapping", "load", "low", "high"),
    [
        ("sma_isobaric/cal_sample_1/7 MPa.txt", "sma_isobaric_1", 7.0, 0.0006, 0.0078),
        ("sma_isobaric/cal_sample_1/50 MPa.txt", "sma_isobaric_1", 50.0, 0.0009, 0.0191),
        ("sma_isobaric/cal_sample_1/150 MPa.txt", "sma_isobaric_1", 150.0, 0.0028, 0.0348),
        ("sma_isobaric/cal_sample_1/200 MPa.txt", "sma_isobaric_1", 200.0, 0.0056, 0.0400),
        ("sma_isobaric/cal_sample_2/7 MPa.txt", "sma_isobaric_2", 7.0, -0.0004, 0.0017),
        ("sma_isobaric/cal_sample_2/50 MPa.txt", "sma_isobaric_2", 50.0, 0.0003, 0.0097),
        ("sma_isobaric/cal_sample_2/100 MPa.txt", "sma_isobaric_2", 100.0, 0.0010, 0.0162),
        ("sma_isobaric/cal_sample_2/200 MPa.txt", "sma_isobaric_2", 200.0, 0.0024, 0.0246),
        ("sma_isobaric/cal_sample_2/300 MPa.txt", "sma_isobaric_2", 300.0, 0.0040, 0.0309),
        ("sma_isobaric/cal_sample_2/400 MPa.txt", "sma_isobaric_2", 400.0, 0.0057, 0.0364),
    ],
)
def test_isobaric_strain_is_in_mm_per_mm_whatever_the_file_has(name, mapping, load, low, high):
    run, said = real(name, mapping)
    strain = run["position"]
    assert run.unit == "mm/mm"
    assert low - 1e-4 < strain.min() < strain.max() < high + 1e-4
    assert strain.min() < low + 1e-4
    assert strain.max() > high - 1e-4
    assert run.meta["conditions"]["stress"]["mean"] == pytest.approx(load, rel=0.01)
    assert ("nominal, not measured" in said) == (mapping == "sma_isobaric_2")
    assert "leads its input" not in said


@pytest.mark.parametrize("stress", ["50", "100", "200", "300", "400"])
def test_isobaric_transformation_is_found_to_be_undersampled(stress):
    _, said = real(f"sma_isobaric/cal_sample_2/{stress} MPa.txt", "sma_isobaric_2")
    assert "the values in between were not sampled" in said


@pytest.mark.parametrize("stress", ["100", "200", "300", "400"])
def test_the_wrong_strain_unit_is_noticed(stress):
    name = f"sma_isobaric/cal_sample_2/{stress} MPa.txt"
    if not (DATA / name).exists():
        pytest.skip(f"real data {name} are not in ../shared/data")
    with pytest.raises(DataError, match="Is the column in %"):
        _run(name, "sma_isobaric_1")


def test_the_wrong_strain_unit_the_other_way_round_is_doubted():
    _, said = real("sma_isobaric/cal_sample_1/50 MPa.txt", "sma_isobaric_2")
    assert "Is the unit right" in said


@pytest.mark.parametrize(("stress", "percent"), [(50, 20), (100, 8), (150, 8)])
def test_flexinol_load_was_not_constant_and_is_described(stress, percent):
    run, said = real(f"flexinol_isobaric/filtered_data_{stress}MPa.txt", "flexinol_isobaric")
    load = run.meta["conditions"]["stress"]
    assert len(run) == 499
    assert load["mean"] == pytest.approx(stress, rel=0.002)
    assert load["max"] - load["mean"] > percent / 100 * load["mean"]
    assert "stress was not constant" in said
    assert 0.041 < np.ptp(run["position"]) < 0.0444
    assert run["position"][np.argmax(run["input"])] < 1e-4  # hot is zero
    assert "clipped" not in said


# --- many cycles, nested loops, pulses ----------------------------------------------------------------------


def test_cycles_walk_and_their_temperature_is_noisy():
    run, said = real("sma_cycles/cycles.txt", "sma_cycles")
    assert len(run) == 13000
    assert not run.has("t_s")
    assert "input moves opposite to the direction of its branch in 2540 rows, by up to 22.6 degC" in said
    assert "over 50 visits" in said  # the high end: the hot strain creeps from −0.15 % to 0.34 %
    assert "-0.001528 → … → 0.000545 → … → 0.003395 mm/mm" in said


@pytest.mark.parametrize(
    ("file", "rows", "lost"), [(1, 474, 0), (2, 426, 0), (3, 500, 2), (4, 480, 103), (5, 530, 46)]
)
def test_nested_bumps_keep_pairs_and_lose_rows_of_a_failed_thermocouple(file, rows, lost):
    run, said = real(f"sma_nested_bumps/ele_hys_{file}.txt", "sma_nested_bumps")
    assert len(run) == rows
    np.testing.assert_allclose(np.diff(run["t_s"])[::2], 1e-5, atol=1e-9)
    np.testing.assert_allclose(np.diff(run["t_s"][::2]), 0.1)
    assert int(np.isnan(run["input"]).sum()) == lost
    assert ("disagree by up to" in said) == (lost > 0)
    assert np.nanmax(run["input"]) < 75  # the failed one read 220 °C
    assert "not measured" in said  # the clock


def test_nested_bumps_4_has_a_thermocouple_that_never_recovers():
    _, said = real("sma_nested_bumps/ele_hys_4.txt", "sma_nested_bumps")
    assert "still differ by 3.4 K (median)" in said


@pytest.mark.parametrize(("file", "spikes"), [(0, 47), (1, 37), (2, 46)])
def test_force_pulse_has_garbled_duty_cycles_and_force_in_counts(file, spikes):
    run, said = real(f"sma_force_pulse/AB{file}.csv", "sma_force_pulse")
    assert len(run) == 30000
    assert f"'Control input' has single-row spikes in {spikes} place(s)" in said
    garbled = "2 readings of 30000 are masked: 27.51 in single rows"  # among 24.25 to 24.69 °C
    assert "ambient_degC has single-row spikes" in said or garbled in said
    assert "position comes in steps of 1 count" in said
    assert 715 <= run["position"].min() < run["position"].max() <= 801
    assert np.corrcoef(run["input"], run["position"])[0, 1] < -0.85  # hotter pulls harder: fewer counts
    assert not run.has("t_s")


def test_heating_step_repeats_times_and_holds_temperatures():
    run, said = real("sma_heating_step/step.csv", "sma_heating_step")
    assert "983 rows repeat the time" in said
    assert "time gaps of more than ten times the usual 0.014 s, the longest 0.352 s after line 1722" in said
    assert "steps of 0.25 degC" in said
    assert "no position" in said
    assert len(run) == 5491 - 983
    assert (np.diff(run["t_s"]) > 0).all()
    on = run["t_s"][np.argmax(run["input"] > 0)]
    assert on == pytest.approx(32.046, abs=0.01)
    assert run["input"].max() == 10.0
    assert not run.has("position")


@pytest.mark.parametrize(("table", "volts"), [(1, 1400), (2, 1400), (3, 800), (6, 1400), (10, 800)])
def test_ferroelectric_tables_are_offset_and_hold_copies(table, volts):
    run, said = real("ferroelectric_loops/RMN_TRAP_SLOW.dat", f"ferroelectric_loops:{table}")
    assert len(run) == 401
    assert float(run.meta["header"]["Hysteresis Amplitude [V]"]) == volts
    assert np.ptp(run["input"]) / 2 == pytest.approx(volts, rel=0.005)
    assert "centre +72." in said
    assert "'P1 [uC/cm2]' and 'P2 [uC/cm2]' are identical" in said
    assert run["position"][np.argmax(run["input"])] > 0 > run["position"][np.argmin(run["input"])]


def test_a_matlab_file_given_as_text_is_refused_with_what_to_do():
    path = DATA / "ferrite_nested" / "H_MnZn_HP_ferrite.mat"
    if not path.exists():
        pytest.skip("real data ferrite_nested are not in ../shared/data")
    with pytest.raises(DataError, match=r"MATLAB file\. Import it with --format mat and a mapping \(--map\)"):
        _run("ferrite_nested/H_MnZn_HP_ferrite.mat", "sma_cycles")


# --- reversal curves --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "curves", "points", "units", "spread"),
    [
        ("UB199BF", 140, 15504, ("T", "A m^2"), "0.14 %"),
        ("MSM33-55-1_d330.forc", 120, 8394, ("T", "A m^2"), "1.30 %"),
        ("hchb_forc", 152, 30476, ("Oe", "emu"), "0.55 %"),
    ],
)
def test_reversal_curves(name, curves, points, units, spread):
    run, said = real(f"forc_magnetic/{name}", None, "forc")
    step, field = run["step"], run["input"]
    assert run.meta["forc"]["curves"] == curves
    assert int((step < 0).sum()) == curves
    assert int((step >= 0).sum()) == points
    assert (run.input_unit, run.unit) == units
    assert f"spread {spread}" in said
    assert "declares" not in said
    assert "cut off" not in said
    first = np.flatnonzero((step >= 0) & (np.diff(step, prepend=-1) != 0))
    assert first.size == curves
    assert (np.diff(field[first]) < 0).all()  # reversal fields descend
    assert (step[first - 1] == -1).all()  # each after a calibration point, at higher field
    assert (field[first - 1] > field[first]).all()
    assert run["position"].max() > 0 > run["position"].min()


@pytest.mark.parametrize("name", ["UB199BF", "MSM33-55-1_d330.forc", "hchb_forc"])
def test_drift_correction_is_decided_by_held_out_error(name):
    run, said = real(f"forc_magnetic/{name}", None, "forc")
    error = run.meta["forc"]["drift"]["error"]
    assert set(error) == {"none", "multiplicative", "additive"}
    assert error[run.meta["forc"]["drift"]["kind"]] == min(error.values())
    assert "Drift: held-out error" in said
    step = run["step"].astype(int)
    curves, _ = correct_drift_if_it_helps(ForcCurves(run["input"], run["position"], step))
    assert 0 < error["none"] < 0.01 * np.ptp(curves.moment)


def test_a_truncated_real_file_is_reported(tmp_path):
    source = DATA / "forc_magnetic" / "UB199BF"
    if not source.exists():
        pytest.skip("real data forc_magnetic are not in ../shared/data")
    cut = tmp_path / "cut"
    cut.write_bytes(source.read_bytes()[:200_000].rsplit(b"\r\n", 1)[0])
    report = import_file(cut, format="forc", out=tmp_path / "cut.run.sqlite")
    said = "\n".join(report.warnings)
    assert "cut off" in said
    assert "declares 15644 points" in said
    assert "declares 140 curves" in said


def test_no_import_reports_a_finding_twice():
    for name, mapping in (
        ("sma_staircase/test.csv", "sma_staircase"),
        ("sma_cycles/cycles.txt", "sma_cycles"),
    ):
        warnings = sorted(real(name, mapping)[0].meta["warnings"])
        assert all(a != b for a, b in pairwise(warnings))
