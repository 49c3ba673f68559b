"""Rates are no outputs: a study refuses them with one sentence, and models what they are the rates of."""

import numpy as np
import pytest

from smarig.cli import run as cli
from smarig.core import UsageError
from smarig.study import StudyOptions, study
from smarig.study.quantity_units import is_rate_unit

QUICK = StudyOptions(diagnose=False)
LOOP = 100 * np.cos(np.linspace(0, 6 * np.pi, 400))
LATE = np.tanh(np.roll(LOOP, 8) / 40)


def table(path, drive, name, values):
    rows = "\n".join(f"{k / 10},{a:.4f},{b:.6f}" for k, (a, b) in enumerate(zip(LOOP, values)))
    path.write_text(f"time (s),{drive},{name}\n{rows}\n", encoding="utf-8")
    return path


@pytest.mark.long(
    "takes a second each",
    cases=(
        "H (A/m)-B (T/s)-B (T)",
        "field (mT)-dM/dt-M (emu)",
        r"temperature (\xb0C)-strain [%/min]-strain (%)",
        r"temperature (\xb0C)-x (mm/s)-x (mm)",
    ),
)
@pytest.mark.parametrize(
    ("drive", "rate", "output"),
    [
        ("H (A/m)", "dB/dt (T/s)", "B (T)"),
        ("H (A/m)", "B (T/s)", "B (T)"),
        ("field (mT)", "dM/dt", "M (emu)"),
        ("field (mT)", "pick-up coil (V)", "moment (emu)"),
        ("current (A)", "V_ind (mV)", "flux density (T)"),
        ("temperature (°C)", "strain rate (1/s)", "strain (%)"),
        ("temperature (°C)", "strain [%/min]", "strain (%)"),
        ("temperature (°C)", "x (mm/s)", "x (mm)"),
    ],
)
def test_a_rate_is_refused_and_what_it_is_the_rate_of_is_modelled(tmp_path, drive, rate, output):
    with pytest.raises(UsageError) as refused:
        study([table(tmp_path / "rate.csv", drive, rate, np.gradient(LATE))], tmp_path / "out", QUICK)
    said = str(refused.value)
    assert f"'{rate}' is a rate" in said
    assert "its integral over time would be the output" in said
    assert not (tmp_path / "out" / "model.json").exists()
    found = study([table(tmp_path / "y.csv", drive, output, LATE)], tmp_path / "other", QUICK)
    assert found.evaluation is not None


def test_it_is_refused_also_where_the_draft_is_accepted(tmp_path, capsys):
    path = table(tmp_path / "rate.csv", "H (A/m)", "dB/dt (T/s)", np.gradient(LATE))
    assert cli(["study", str(path), "-o", str(tmp_path / "out"), "--yes"]) == 2
    assert capsys.readouterr().err.count("is a rate") == 1


def test_a_rate_beside_an_output_is_ignored(tmp_path):
    path = tmp_path / "both.csv"
    rows = "\n".join(f"{a:.4f},{b:.6f},{c:.6f}" for a, b, c in zip(LOOP, np.gradient(LATE), LATE))
    path.write_text(f"H (A/m),dB/dt (T/s),B (T)\n{rows}\n", encoding="utf-8")
    result = study([path], tmp_path / "out", QUICK)
    assert result.understood.guesses[0].first("output").name == "B (T)"


@pytest.mark.parametrize(
    "unit", ["ml/min", "°C/min", "K/s", "kg/h", "m", "s", "A/s", "mm/mm", "A/m", "rpm", ""]
)
def test_a_flow_and_the_rate_of_an_input_are_none(unit):
    assert not is_rate_unit(unit)


@pytest.mark.parametrize("unit", ["T/s", "%/s", "s^-1", "1/s", "mm/min", "N/s", "emu/s", "s⁻¹", "MPa/min"])
def test_units_of_outputs_per_time_are_rates(unit):
    assert is_rate_unit(unit)
