"""What a file writes of its sensors and channels, their ranges and rates, is no load and no frequency of the wire."""

import numpy as np
import pytest

from smarig.exchange import find_tables
from smarig.study.imported_runs import import_tables
from smarig.study.study_options import StudyOptions
from smarig.study.understanding import understand

U = 70 - 50 * np.cos(np.linspace(0, 12, 120))
FORCE = 40 + 30 * np.tanh((U - 70) / 9)
NAMES, UNITS = ["Zeit", "Temperatur", "Kraft"], ["s", "°C", "N"]


def file_of(tmp_path, above):
    rows = (f"{0.5 * k:.1f}\t{U[k]:.3f}\t{FORCE[k]:.4f}" for k in range(U.size))
    path = tmp_path / "a.txt"
    path.write_text("\n".join(["\t".join(row) for row in above] + [*rows]) + "\n", encoding="utf-8")
    return path


def conditions(path, tmp_path):
    found = understand([path], StudyOptions())
    (table,), _ = import_tables(found.guesses, tmp_path / "out", None, "a")
    return table.run.info.conditions


@pytest.mark.parametrize(
    "comments",
    [
        [["", "Typ K", "U9C/500N"]],
        [["", "", "500 N"]],
        [["", "Typ K", "U9C/500N"], ["2 Hz", "2 Hz", "2 Hz"]],
    ],
)
def test_sensors_ranges_and_rates_are_no_conditions(tmp_path, comments):
    assert conditions(file_of(tmp_path, [NAMES, UNITS, *comments]), tmp_path) == {}


def test_a_load_in_another_unit_is_a_condition(tmp_path):
    path = file_of(tmp_path, [NAMES, UNITS, ["", "", "60 MPa"]])
    assert conditions(path, tmp_path)["stress"]["mean"] == 60.0


def test_names_of_all_columns_win_over_sensors_beside_the_units(tmp_path):
    (table,) = find_tables(file_of(tmp_path, [NAMES, ["", "Typ K", "U9C/500N"], UNITS]))
    assert list(table.names) == NAMES
    assert [c.unit for c in table.columns] == UNITS


def test_a_time_whose_name_holds_a_rate_is_a_time(tmp_path):
    path = file_of(tmp_path, [["Time  1 - default sample rate [s]", "Temp [°C]", "Kraft [N]"]])
    (guess,) = understand([path], StudyOptions()).guesses
    assert guess.first("time") is not None
