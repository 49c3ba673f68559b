"""Charges, steps per row and stated units: what a potentiostat writes is no displacement."""

import numpy as np
import pytest

from smarig.core import UsageError
from smarig.exchange import find_tables
from smarig.study import StudyOptions, guess_table
from smarig.study.understanding import understand
from study.known_data import table_of

ROWS = 300
STEP_S = 20.0


def cell(rows=ROWS, current_mA=500.0):
    """Current, charge per row, charge and voltage of a cell that is charged and discharged twice."""
    rng = np.random.default_rng(4)
    current = current_mA * np.where(np.arange(rows) // (rows // 4) % 2 == 0, 1.0, -1.0)
    dq = current * STEP_S / 3600
    charge = np.cumsum(dq)
    state = charge / charge.max()
    voltage = 3.4 + 0.05 * state + 0.02 * np.sign(current) + 1e-4 * rng.standard_normal(rows)
    return current, dq, charge, voltage


def mpt(path, **other):
    """An export of EC-Lab: a header, names with units behind a sign, decimal commas."""
    current, dq, charge, voltage = cell(**other)
    rng = np.random.default_rng(5)
    names = "ox/red\tNs\ttime/s\tcontrol/V/mA\tEwe/V\tdq/mA.h\t(Q-Qo)/mA.h\tI/mA\tTemperature/°C"
    lines = ["EC-Lab ASCII FILE", "Nb header lines : 5", "", "Device : VMP-300", names]
    for k in range(current.size):
        values = [current[k] > 0, 1 + (k > 9), STEP_S * (k + 1), current[k], voltage[k], dq[k], charge[k]]
        values += [current[k], 25 + 0.1 * rng.standard_normal()]
        lines.append("\t".join(f"{value:.9E}".replace(".", ",") for value in map(float, values)))
    path.write_text("\r\n".join(lines) + "\r\n", encoding="latin-1")
    return path


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize(("rows", "current_mA"), [(300, 500.0), (480, 20.0), (120, 3000.0)])
def test_a_cell_is_its_voltage_over_its_charge(tmp_path, rows, current_mA):
    (table,) = find_tables(mpt(tmp_path / "a.mpt", rows=rows, current_mA=current_mA))
    guess = guess_table(table)
    assert (guess.first("input").name, guess.first("input").unit) == ("(Q-Qo)/mA.h", "mAh")
    assert (guess.first("output").name, guess.first("output").unit) == ("Ewe/V", "V")
    assert guess.roles["dq/mA.h"].reason == "rate: its sum is '(Q-Qo)/mA.h'"
    assert not guess.doubts
    assert not [c.name for c in guess.columns if c.quantity == "displacement" or c.unit == "mm"]


@pytest.mark.parametrize("noise", [0.0, 1e-3])
@pytest.mark.parametrize("unit", ["mm", "nC", "N"])
def test_the_step_of_another_column_is_no_output(noise, unit):
    t = np.arange(ROWS) * 0.5
    whole = 5 * np.sin(t / 7) + 0.3 * t
    step = np.diff(whole, prepend=0.0)
    step = step + noise * np.std(step) * np.random.default_rng(1).standard_normal(ROWS)
    current = np.sin(t / 7)
    columns = {"time [s]": t, f"a [{unit}]": step, f"b [{unit}]": whole, "I [A]": current}
    guess = guess_table(table_of(**columns))
    assert guess.roles[f"a [{unit}]"].reason == f"rate: its sum is 'b [{unit}]'"
    assert guess.first("output").name == f"b [{unit}]"


def test_steps_of_a_column_that_differs_stay():
    t = np.arange(ROWS) * 0.5
    whole = 5 * np.sin(t / 7)
    step = np.diff(whole, prepend=0.0) + 0.3 * np.sin(t / 3) * np.std(np.diff(whole))
    columns = {"time [s]": t, "a [mm]": step, "b [mm]": whole, "I [A]": np.cos(t / 7)}
    guess = guess_table(table_of(**columns))
    assert {c.name: c.quantity for c in guess.columns}["a [mm]"] == "displacement"


def test_a_charge_in_coulombs_is_moved_by_a_voltage():
    t = np.arange(ROWS) * 0.5
    columns = {"time [s]": t, "V [V]": np.sin(t / 7), "Q [nC]": np.sin(t / 7 - 0.4)}
    guess = guess_table(table_of(**columns))
    assert guess.first("output").name == "Q [nC]"
    assert guess.first("input").name == "V [V]"


@pytest.mark.parametrize("name", ["control/V/mA", "x [V/mA]", "x [mA.h]", "x [Hz]", "x/W.h"])
def test_a_stated_unit_is_no_displacement(tmp_path, name):
    t = np.arange(ROWS) * 0.5
    path = tmp_path / "a.csv"
    rows = "".join(f"{a},{60 - 35 * np.cos(a / 9):.3f},{3 * np.sin(a / 9 - 1):.4f}\n" for a in t)
    path.write_text(f"time [s],temperature [degC],{name}\n{rows}")
    (table,) = find_tables(path)
    (column,) = [c for c in guess_table(table).columns if c.name == name]
    assert column.quantity != "displacement"
    assert column.unit != "mm"


def test_a_step_alone_is_refused_as_an_output(tmp_path):
    _, dq, charge, _ = cell()
    path = tmp_path / "a.csv"
    rows = "".join(f"{STEP_S * k},{a},{b}\n" for k, (a, b) in enumerate(zip(dq, charge)))
    path.write_text(f"time [s],dq [mAh],Q [mAh]\n{rows}")
    with pytest.raises(UsageError, match="'dq.*' is a rate, not the output"):
        understand([path], StudyOptions())
