"""Keys and values in cells beside the readings are lines before the table; other empty cells stay cells."""

import numpy as np
import pytest

from smarig.exchange import find_tables

KEYS = [
    ("Record Length", "400"),
    ("Sample Interval", "0.002"),
    ("", ""),
    ("Source", "CH3"),
    ("Vertical Units", "mV"),
]
KEYS += [("Vertical Scale", "5.0e-1"), ("Horizontal Units", "s"), ("", ""), ("Model Number", "XY12")]


def text_of(t, y, keys, *, sign=",", unit_cell=True, end=""):
    rows = []
    for k, (a, b) in enumerate(zip(t, y)):
        key, value = keys[k] if k < len(keys) else ("", "")
        beside = [key, value, ""] if unit_cell else [key, value]
        rows.append(sign.join([*beside, f"{a:.6f}", f" {b:.5f}"]) + end)
    return "\n".join(rows) + "\n"


@pytest.mark.parametrize("sign", [",", ";", "\t"])
@pytest.mark.parametrize(("unit_cell", "end"), [(True, ""), (False, ""), (True, "sign")])
def test_the_readings_are_a_table_below_the_keys(tmp_path, sign, unit_cell, end):
    t = np.arange(400) * 0.002 - 0.1
    y = np.sin(9 * t)
    path = tmp_path / "a.csv"
    path.write_text(text_of(t, y, KEYS, sign=sign, unit_cell=unit_cell, end=sign if end else ""))
    (table,) = find_tables(path)
    assert [(c.name, c.unit) for c in table.columns] == [("Horizontal", "s"), ("CH3", "mV")]
    np.testing.assert_allclose(table.columns[0].values, t, atol=1e-6)
    np.testing.assert_allclose(table.columns[1].values, y, atol=1e-5)


def test_a_column_of_remarks_is_none(tmp_path):
    path = tmp_path / "a.csv"
    rows = [f"{'heater on' if k == 30 else ''},{k},{k % 7}" for k in range(60)]
    path.write_text("remark,t [s],x [mm]\n" + "\n".join(rows) + "\n")
    (table,) = find_tables(path)
    assert [c.name for c in table.columns] == ["remark", "t [s]", "x [mm]"]
