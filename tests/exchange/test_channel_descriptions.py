"""Rows of text between the names and the numbers describe the channels: the first full row holds the names."""

from itertools import permutations

import numpy as np
import pytest

from smarig.exchange import find_tables

T = np.round(60 - 30 * np.cos(np.linspace(0, 12, 60)), 3)
NAMES = ["Zeit  1 - Rate", "T_Probe", "T_Ofen", "Weg_WA20", "Kraft"]
ROWS = {
    "channel": ["Zeit", "Kanal 1", "Kanal 2", "Kanal 3", "Kanal 4"],
    "rate": ["Rate: 1 Hz"] * 5,
    "serial": ["-", "SN 0014", "SN 0014", "SN 2231", "SN 9910"],
    "filter": ["off", "Bessel", "Bessel", "Butterworth", "off"],
    "range": ["0-1e6", "K", "K", "20 mm", "50 N"],
}
UNITS = ["s", "°C", "°C", "mm", "N"]


def found(tmp_path, rows, delimiter):
    head = ["MEASUREMENT V5", "Projekt: A", "Kommentar:", ""]
    lines = [delimiter.join(row) for row in rows]
    data = [
        delimiter.join([f"{k}.5", f"{T[k]}", f"{T[k] + 2}", f"{T[k] / 90:.4f}", "49.1"]) for k in range(60)
    ]
    path = tmp_path / "a.asc"
    path.write_text("\n".join([*head, *lines, "", *data]) + "\n", encoding="utf-8")
    (table,) = find_tables(path)
    np.testing.assert_array_equal(table.columns[1].values, T)
    return table


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("delimiter", ["\t", ";"])
@pytest.mark.parametrize("order", list(permutations(["channel", "rate", "serial"])))
def test_units_below_the_names(tmp_path, order, delimiter):
    table = found(tmp_path, [NAMES, UNITS, *(ROWS[key] for key in order)], delimiter)
    assert list(table.names) == NAMES
    assert [c.unit for c in table.columns] == UNITS
    assert "SN 2231" in table.columns[3].comment


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("delimiter", ["\t", ";"])
@pytest.mark.parametrize("order", list(permutations(["channel", "rate", "serial"])))
def test_units_below_the_descriptions_or_in_brackets(tmp_path, order, delimiter):
    rows = [ROWS[key] for key in order]
    assert list(found(tmp_path, [NAMES, *rows, UNITS], delimiter).names) == NAMES
    assert list(found(tmp_path, [NAMES, *rows], delimiter).names) == NAMES
    with_units = [f"{name} [{unit}]" for name, unit in zip(NAMES, UNITS)]
    assert list(found(tmp_path, [with_units, *rows], delimiter).names) == with_units


@pytest.mark.parametrize("keys", [["filter"], ["filter", "range", "serial", "rate", "channel", "rate"]])
def test_however_many_they_are(tmp_path, keys):
    table = found(tmp_path, [NAMES, UNITS, *(ROWS[key] for key in keys)], "\t")
    assert list(table.names) == NAMES
    assert [c.unit for c in table.columns] == UNITS


def test_numbers_of_channels_above_the_names_are_no_names(tmp_path):
    table = found(tmp_path, [ROWS["channel"], NAMES, UNITS], "\t")
    assert list(table.names) == NAMES
