"""Units before the names of columns, as loggers write them, and names that only begin with the letter of a unit."""

import numpy as np
import pytest

from smarig.exchange import find_tables
from smarig.study import guess_table

WAY = np.r_[np.linspace(0, 1, 40), np.linspace(1, 0, 40), np.linspace(0, 1, 40)]
K = np.arange(WAY.size)


def guess(tmp_path, head, *columns):
    path = tmp_path / "logger.txt"
    rows = ["\t".join(f"{v:.6g}" for v in row) for row in zip(*columns, strict=True)]
    path.write_text("\n".join([head, *rows, ""]), encoding="utf-8")
    return guess_table(find_tables(path)[0])


@pytest.mark.parametrize(
    ("suction", "unit", "content"),
    [
        ("hPa Water Potential", "hPa", "cm³/cm³ Moisture Content"),
        ("MPa Matric Potential", "MPa", "% VWC"),
        ("kPa Saugspannung", "kPa", "m³/m³ Wassergehalt"),
    ],
)
def test_water_is_read_against_the_potential_that_holds_it(tmp_path, suction, unit, content):
    head = f"h Time\t% Cell Level\tmbar Air Pressure\t{content}\t{suction}\tdS/m Pore EC\t°F Bed Temperature"
    wet = 0.4 - 0.3 * np.tanh(3 * WAY)
    found = guess(tmp_path, head, K / 4, 80 - K / 9, 1000 + K % 5, wet, -900 * WAY - 1, wet / 3, 60 + K % 7)
    assert [found.first(role).name for role in ("time", "input", "output")] == ["h Time", suction, content]
    assert (found.first("input").unit, found.first("output").unit) == (unit, "%" if "%" in content else "1")
    assert found.first("time").unit == "h"
    assert not found.doubts


def test_letters_before_names_are_no_units(tmp_path):
    found = guess(tmp_path, "s\tT wire\tV supply\tmm stroke", K, 30 + 50 * WAY, 5 + 0 * K, np.tanh(2 * WAY))
    assert next(c for c in found.columns if c.name == "T wire").quantity == "temperature"
    assert all(c.unit != "T" for c in found.columns)
