"""Isotherms of gas sorption: what is adsorbed against the pressure, and no evaluation of some of its points."""

import numpy as np
import pytest

from smarig.exchange import find_tables
from smarig.study import guess_table
from smarig.study.study_options import StudyOptions
from smarig.study.understanding import understand

UP = np.linspace(0.02, 0.98, 30)
P = np.r_[UP, UP[-2::-1]]
FILLED = 210 / (1 + np.exp((np.r_[np.full(30, 0.7), np.full(29, 0.55)] - P) / 0.02)) + 60 * P**0.5


def report(tmp_path, heads, evaluation=True):
    path = tmp_path / "isotherm.csv"
    rows = [
        f"{p:.5f},{p * 98.6:.4f},{a:.3f},{k // 6:02d}:{k * 10 % 60:02d},{98.6 + 0.01 * (k % 3):.3f}"
        for k, (p, a) in enumerate(zip(P, FILLED, strict=True))
    ]
    lines = ["Sample:,zeolite 4", "", "Isotherm", ",".join(heads), *rows]
    if evaluation:
        lines += ["", "Surface", "slope:,0.01", f"{heads[0]},{heads[2]},p/(n(1-p))"]
        lines += [f"{p:.4f},{60 * p**0.5:.3f},{p / 50:.6f}" for p in np.linspace(0.05, 0.3, 7)]
    path.write_text("\n".join([*lines, ""]), encoding="utf-8")
    return path


HEADS = {
    "volume": (
        "Rel. Pressure (p/p0)",
        "Pressure (kPa)",
        "Volume adsorbed (cc/g STP)",
        "Clock (h:min)",
        "p0 (kPa)",
    ),
    "amount": ("P/Psat", "Cell pressure [mmHg]", "uptake [mmol/g]", "Time", "Saturation pressure [mmHg]"),
}


@pytest.mark.parametrize("name", HEADS)
def test_the_relative_pressure_is_the_input_and_the_uptake_the_output(tmp_path, name):
    guess = guess_table(find_tables(report(tmp_path, HEADS[name]))[0])
    heads = HEADS[name]
    assert [guess.first(role).name for role in ("input", "output", "time")] == [heads[0], heads[2], heads[3]]
    assert (guess.first("input").unit, guess.doubts) == ("1", [])


def test_a_table_that_evaluates_points_is_no_run(tmp_path):
    found = understand([report(tmp_path, HEADS["volume"])], StudyOptions())
    assert [len(guess.table) for guess in found.guesses] == [P.size]
    assert "evaluates readings of another table" in next(iter(found.left_out.values()))
