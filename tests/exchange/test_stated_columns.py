"""A list of channels with units before a table, or units by words of names, are those of its columns."""

import numpy as np
import pytest

from smarig.exchange import find_tables
from smarig.study import guess_table

K = np.arange(240)
T = np.round(60 - 35 * np.cos(K / 20), 2)
Y = np.round(3 + 2 * np.tanh((T - np.where(np.gradient(T) > 0, 66, 54)) / 6), 4)


def written(path, head, names, sign, columns=(K, T, Y, 0.3 * Y)):
    rows = [sign.join(f"{x:g}" for x in row) for row in zip(*columns)]
    path.write_text("\n".join([*head, sign.join(names), *rows]) + "\n", encoding="utf-8")
    return path


NAMES = ("Zeit", "A1:3", "B7:1", "B7:2")


@pytest.mark.parametrize("sign", [",", ";", "\t"])
@pytest.mark.parametrize("unit", ["Unit", "Einheit", "Eng. Units", "Unité"])
@pytest.mark.parametrize("place", [0, 2])
def test_a_list_of_channels_gives_units_and_labels(tmp_path, sign, unit, place):
    heading = ["Signal", "Rate", unit, "Remark"]
    channels = [
        ["B7:1", "5 Hz", "µε", "wire"],
        ["A1:3", "1 Hz", "°F", "bath"],
        ["B7:2", "5 Hz", "µε", "dummy"],
    ]
    lists = [sign.join(row[place:] + row[:place]) for row in (heading, *channels)]
    head = ["Node 5", "", "Channels", *lists, "", "Data"]
    (table,) = find_tables(written(tmp_path / "a.csv", head, NAMES, sign))
    assert [c.unit for c in table.columns] == ["", "°F", "µε", "µε"]
    assert [c.comment for c in table.columns] == ["", "bath", "wire", "dummy"]
    guess = guess_table(table)
    assert [c.name for c in guess.of_role("input")] == ["A1:3"]
    assert [(c.name, c.quantity) for c in guess.of_role("output")] == [("B7:1", "strain")]
    assert not guess.doubts


def test_a_list_of_other_channels_is_none(tmp_path):
    head = ["Signal,Unit", "X1,mm", "X2,N", ""]
    (table,) = find_tables(written(tmp_path / "a.csv", head, NAMES, ","))
    assert [c.unit for c in table.columns] == [""] * 4


@pytest.mark.parametrize("line", ["REM units: axis 2 MM, heater V", "# Units = heater [V]; axis 2 [mm]"])
def test_units_by_words_of_the_names(tmp_path, line):
    names = ("No", "Heater 1", "Position of axis 2", "Target of axis 2")
    (table,) = find_tables(written(tmp_path / "a.csv", [line, ""], names, ","))
    assert [c.unit for c in table.columns] == ["", "V", "mm", "mm"]


@pytest.mark.parametrize("line", ["units: as usual, see below", "unit: 7", "units of heater: V/mA or so"])
def test_other_lines_state_no_units(tmp_path, line):
    names = ("No", "Heater 1", "Position of axis 2", "Target of axis 2")
    (table,) = find_tables(written(tmp_path / "a.csv", [line, ""], names, ","))
    assert [c.unit for c in table.columns] == [""] * 4
