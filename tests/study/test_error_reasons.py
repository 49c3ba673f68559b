"""Verdicts of studies, and what they say of an error: facts of data whose cause is planted."""

import numpy as np
import pytest

from smarig.identification import AgainstCurves, error_verdict
from smarig.study import StudyOptions, study
from study.known_data import csv_text, displacements, temperatures

QUICK = StudyOptions(diagnose=False)


def _studied(tmp_path, u, x):
    path = tmp_path / "loop.csv"
    path.write_text(csv_text(np.arange(u.size) * 0.5, u, x), encoding="utf-8")
    return study([path], tmp_path / "out", QUICK)


def level_against_curves(rms, floor, share, gain, *, full_loops=False):
    return error_verdict(rms, floor, share, curves=AgainstCurves(gain, full_loops)).level


@pytest.mark.parametrize("ratio", [0.5, 1.4, 1.6, 2.9])
def test_a_model_clearly_better_than_curves_is_judged_as_by_verify(ratio):
    assert level_against_curves(ratio, 1.0, 0.02, 5.0) == error_verdict(ratio, 1.0, 0.02).level


def test_a_small_error_on_full_loops_is_good_even_if_two_branches_fit_better():
    assert level_against_curves(2.9, 1.0, 0.004, 0.6, full_loops=True) == "good"
    assert level_against_curves(2.9, 1.0, 0.02, 0.6, full_loops=True) == "poor"
    assert level_against_curves(2.9, 1.0, 0.004, 0.6) == "poor", "a line is better: this is no hysteresis"


def test_a_model_no_better_than_a_curve_is_poor_even_at_the_noise():
    assert level_against_curves(1.0, 1.0, 0.02, 1.0) == "poor"
    assert level_against_curves(5.0, 1.0, 0.20, 5.0) == "poor", "20 % of the range"


@pytest.mark.parametrize(
    ("ratio", "share", "gain", "level"),
    [
        (1.0, 0.02, 1.0, "good"),
        (1.0, 0.02, 1.4, "good"),
        (2.4, 0.0048, 0.98, "good"),
        (2.4, 0.02, 0.98, "fair"),
        (9.0, 0.05, 1.0, "poor"),
        (1.0, 0.02, 0.7, "poor"),
    ],
)
def test_a_model_as_good_as_two_branches_is_as_good_as_full_loops_can_show(ratio, share, gain, level):
    assert level_against_curves(ratio, 1.0, share, gain, full_loops=True) == level


def test_drop_outs_are_not_taken_for_branches(tmp_path):
    u = temperatures(1, 120)
    x = displacements(u)
    u[[20, 21, 60, 61, 90]] = 0.0
    assert _studied(tmp_path, u, x).split.kind == "none", "one loop, whatever the instrument dropped"


def test_an_output_that_goes_back_within_a_branch_is_said(tmp_path):
    u = temperatures(1, 240)
    (tmp_path / "a").mkdir()
    honest = _studied(tmp_path / "a", u, displacements(u))
    assert not any("goes back" in s for s in honest.reasons)
    (tmp_path / "b").mkdir()
    expanding = _studied(tmp_path / "b", u, displacements(u) + 1.5 * np.cos(0.3 * (u - u.min())))
    assert any("goes back by" in s for s in expanding.reasons)


@pytest.mark.long("takes three seconds")
def test_a_first_branch_of_another_state_is_no_output_that_goes_back(tmp_path):
    u = 72.5 - 47.5 * np.cos(np.linspace(0, 20 * np.pi, 2400))
    x = displacements(u)
    x[:120] += 1.5 * np.sin(np.linspace(0, np.pi, 120))  # the first heating
    assert not any("goes back" in s for s in _studied(tmp_path, u, x).reasons)


def test_a_branch_without_a_way_back_is_no_good_model(tmp_path):
    u = np.linspace(120, 20, 60)
    result = _studied(tmp_path, u, displacements(u, noise=0.002))
    assert result.verdict == "fair"
    assert "no loop to judge it by" in result.sentences()[0]
    assert not any("simple curve" in s for s in result.sentences())
    assert any("one way only" in s for s in result.reasons)


def test_a_magnet_is_not_said_to_slip_in_its_grips(tmp_path):
    h = 2000 * np.cos(np.linspace(0, 4 * np.pi, 800))
    m = np.tanh((h - 300 * np.sign(np.gradient(h))) / 400) - 1.4e-3 * h
    path = tmp_path / "loop.csv"
    rows = "\n".join(f"{a:.1f},{b:.5f}" for a, b in zip(h, m))
    path.write_text(f"H (Oe),M (emu)\n{rows}\n", encoding="utf-8")
    reasons = study([path], tmp_path / "out", QUICK).reasons
    assert any("diamagnetic" in s for s in reasons)
    assert not any("grips" in s for s in reasons)


def test_a_moment_over_temperature_has_no_background_of_the_field(tmp_path):
    u = 300 + 60 * np.cos(np.linspace(0, 4 * np.pi, 800))
    m = 2 * np.tanh((u - 295 - 6 * np.sign(np.gradient(u))) / 4) - 0.02 * (u - 300)
    rows = "\n".join(f"{k},{a:.3f},{b:.5f}" for k, (a, b) in enumerate(zip(u, m)))
    (tmp_path / "scan.csv").write_text(f"Time (s),T (K),M (emu)\n{rows}\n", encoding="utf-8")
    reasons = study([tmp_path / "scan.csv"], tmp_path / "out", QUICK).reasons
    assert any("changes with the temperature in each phase" in s for s in reasons)
    assert not any("diamagnetic" in s for s in reasons)


def test_a_model_through_few_readings_does_not_blame_the_specimen(tmp_path):
    steps = np.arange(10, -11, -1.0)
    parts = {"a": np.arange(0, 11.0), "b": steps, "c": steps[::-1]}
    files = []
    for name, u in parts.items():
        files.append(tmp_path / f"{name}.csv")
        b = 700 * np.tanh((u - 1.5 * np.sign(u[-1] - u[0])) / 4)
        rows = "\n".join(f"{x},{y:.2f}" for x, y in zip(u, b))
        files[-1].write_text(f"I [A],B [mT]\n{rows}\n", encoding="utf-8")
    reasons = study(files, tmp_path / "out", QUICK).reasons
    assert any("passes through them" in s for s in reasons)
    assert not any("set-up changed" in s for s in reasons)


def _columns(tmp_path, drive, output, u, y):
    path = tmp_path / "loop.csv"
    rows = np.column_stack([0.5 * np.arange(u.size), u, y])
    header = f"time (s),{drive},{output}"
    np.savetxt(path, rows, delimiter=",", header=header, comments="", fmt="%.7g")
    return study([path], tmp_path / "out", QUICK).reasons


@pytest.mark.parametrize(
    ("drive", "output", "named", "other"),
    [
        ("T (degC)", "R (mohm)", "temperature coefficient of resistance", "grips"),
        ("T (K)", "resistance (ohm)", "temperature coefficient of resistance", "Thermal expansion"),
        ("T (degC)", "moment (emu)", "background", "grips"),
        ("T (degC)", "x (mm)", "Thermal expansion", "resistance"),
    ],
)
def test_what_goes_back_is_named_by_what_is_measured(tmp_path, drive, output, named, other):
    u = temperatures(2, 150)
    y = 0.015 * (u - u.min()) - displacements(u)  # it rises, falls in the transformation, and rises
    back = [
        s for s in _columns(tmp_path, drive, output, u + 273 * ("K" in drive), 600 + y) if "goes back by" in s
    ]
    assert len(back) == 1
    assert named in back[0]
    assert other not in back[0]


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize(
    ("output", "named"), [("M (emu)", "Magnetic viscosity"), ("x (mm)", "sensor that lags")]
)
def test_what_is_missed_is_explained_by_what_is_measured(tmp_path, output, named):
    u = 100 * np.cos(np.linspace(0, 8 * np.pi, 800))
    jumps = 0.4 * np.random.default_rng(0).standard_normal(8)  # one for each branch
    y = np.tanh(np.roll(u, 8) / 40) + jumps[np.arange(u.size) // 100]
    drive = "H (Oe)" if "emu" in output else "voltage (V)"
    missed = [s for s in _columns(tmp_path, drive, output, u, y) if "misses the fitted data as well" in s]
    assert all(named in s for s in missed)
    assert missed


@pytest.mark.parametrize("virgin", [True, False])
def test_a_first_branch_from_another_state_is_told(tmp_path, virgin):
    """The rest of the record is judged without it."""
    corners = (25.0, 120.0, 25.0, 120.0, 35.0, 105.0, 50.0, 95.0, 25.0)
    u = np.concatenate(
        [np.full(20, 25.0), *(np.linspace(a, b, 120)[1:] for a, b in zip(corners, corners[1:]))]
    )
    x = displacements(u)
    if virgin:
        x[:139] -= 0.6 * (1 - np.linspace(0, 1, 139)) ** 2
    result = _studied(tmp_path, u, x)
    told = [
        hint for hint in result.hints() if "the specimen began in another state. Fits start after it." in hint
    ]
    assert len(told) == int(virgin)
    assert result.verdict == "fair", "as without that state"
