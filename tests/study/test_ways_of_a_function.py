"""The way there and the way back of a function side by side in a sheet, beside notes and above a row of means."""

import numpy as np
import pytest

from smarig.exchange import find_tables
from smarig.study import guess_table

UP, DOWN = np.linspace(12, 68, 22), np.linspace(66, 13.5, 17)


def pressure(u):
    return 40 * np.exp(u / 24)


@pytest.mark.parametrize("heads", [("T / K", "p / hPa"), ("bath temp / °C", "gas pressure / kPa")])
def test_two_ways_of_a_vapour_are_one_loop(tmp_path, heads):
    openpyxl = pytest.importorskip("openpyxl", reason="needs openpyxl (extra 'files')")
    book = openpyxl.Workbook()
    sheet = book.active
    sheet.append(["Experiment 3"])
    sheet.append([])
    sheet.append(["there", None, None, None, None, "back"])
    sheet.append([*heads, None, None, None, *heads, None, "remarks"])
    shift = 273.15 if "K" in heads[0] else 0.0
    for k, u in enumerate(UP):
        back = [DOWN[k] + shift, pressure(DOWN[k])] if k < DOWN.size else [None, None]
        remark = ["calibrated last year"] if k == 2 else []
        sheet.append([u + shift, pressure(u), "leaks" if k == 5 else None, None, None, *back, None, *remark])
    sheet.append([])
    sheet.append(["mean", 7.0, None, None, None, None, 8.0])
    book.save(path := tmp_path / "sheet.xlsx")
    guess = guess_table(find_tables(path)[0])
    assert [guess.first(role).name for role in ("input", "output")] == list(heads)
    assert guess.branches == {head: f"{head} (2)" for head in heads}
    assert (len(guess.table), guess.first("time"), guess.doubts) == (UP.size, None, [])


def test_a_second_head_keeps_the_unit_that_stands_in_it(tmp_path):
    path = tmp_path / "two.csv"
    rows = [f"{k},{k % 9},{20 + k % 30},{25 + k % 28}\n" for k in range(90)]
    path.write_text("t/s,x / mm,T / °C,T / °C\n" + "".join(rows), encoding="utf-8")
    guess = guess_table(find_tables(path)[0])
    assert [c.unit for c in guess.columns] == ["s", "mm", "degC", "degC"]
