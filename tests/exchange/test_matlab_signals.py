"""Signals of ControlDesk and of scopes of Simulink: arrays of structs, each with its name and its values."""

import numpy as np
import pytest
from scipy.io import savemat

from smarig.exchange import find_tables
from smarig.study.imported_runs import import_tables
from smarig.study.study_options import StudyOptions
from smarig.study.understanding import understand

T_S = 0.1 * np.arange(160)
U = 70 - 50 * np.cos(np.linspace(0, 12, 160))
Y = np.tanh((U - np.where(np.gradient(U) > 0, 76, 64)) / 6)


def structs(fields, rows):
    found = np.zeros((1, len(rows)), dtype=[(field, object) for field in fields])
    for k, row in enumerate(rows):
        found[0, k] = tuple(row)
    return found


def control_desk(unit=True):
    rows = [("Model Root/Temperature/Out1", U, "degC"), ("Model Root/Displacement/Out1", Y, "mm")]
    fields = ["Name", "Data", "Unit"] if unit else ["Name", "Data"]
    own = [(name, x.reshape(1, -1), of)[: len(fields)] for name, x, of in rows]
    clock = [("Time", T_S.reshape(1, -1), "s")[: len(fields)]]
    return {"rec1": {"X": structs(fields, clock), "Y": structs(fields, own), "Info": "a rig"}}


def scope():
    rows = [(U.reshape(-1, 1), "Temperature"), (Y.reshape(-1, 1), "Displacement")]
    return {"scope": {"time": T_S.reshape(-1, 1), "signals": structs(["values", "label"], rows)}}


CASES = {
    "ControlDesk": (control_desk(), "Model Root/Displacement/Out1 [mm]"),
    "ControlDesk without units": (control_desk(unit=False), "Model Root/Displacement/Out1"),
    "scope": (scope(), "signals/Displacement"),
    "tout and yout": ({"tout": T_S.reshape(-1, 1), "yout": np.c_[U, Y]}, "column 2"),
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("packed", [False, True])
def test_signals_are_read_under_their_names(tmp_path, case, packed):
    path = tmp_path / "a.mat"
    content, output = CASES[case]
    savemat(path, content, do_compression=packed)
    (guess,) = understand([path], StudyOptions()).guesses
    assert guess.first("output").name.endswith(output)
    (table,), _ = import_tables([guess], tmp_path / "out", None, "a")
    np.testing.assert_allclose(table.run["t_s"], T_S)
    np.testing.assert_allclose(table.run["input"], U)
    np.testing.assert_allclose(table.run["position"], Y)


def test_signals_without_or_with_equal_names_are_numbered(tmp_path):
    x = [values.reshape(-1, 1) for values in (T_S, U, Y)]
    savemat(tmp_path / "a.mat", {"s": structs(["values", "label"], [(x[0], ""), (x[1], "a"), (x[2], "a")])})
    (table,) = find_tables(tmp_path / "a.mat")
    assert table.names == ("s/1/values", "s/a", "s/3/values")
