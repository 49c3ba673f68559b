"""A column that is not used is told as what the file states of it: nothing is assumed for it."""

import numpy as np
import pytest

from smarig.exchange import FoundColumn, FoundTable
from smarig.study import guess_table
from study.test_noise_columns import K, T, X, roles, table

USED = [("t (s)", K), ("T (degC)", T), ("x (mm)", X)]
SLOW = np.sin(K / 90)


def ignored(tmp_path, name, values, used=USED):
    (_, guess) = roles(tmp_path, [*used, (name, values)])
    (column,) = [c for c in guess.columns if c.name == name]
    assert guess.roles[name].role == "ignored"
    return column, guess.roles[name].reason


@pytest.mark.parametrize(("name", "size"), [("foo", 0.02), ("bar", 8.0), ("sigma", 40.0)])
@pytest.mark.parametrize("used", [USED, [*USED[:2], ("strain 1 (%)", X)]])
def test_no_unit_is_assumed(tmp_path, name, size, used):
    assert ignored(tmp_path, name, size * (2 + SLOW), used)[0].unit == ""


def test_a_stated_unit_stays(tmp_path):
    assert ignored(tmp_path, "foo (V)", SLOW)[0].unit == "V"


@pytest.mark.parametrize("name", ["foo", "bar (%)"])
def test_numbers_alone_give_no_quantity(tmp_path, name):
    reason = ignored(tmp_path, name, 0.02 * (2 + SLOW))[1]
    assert reason == "its meaning is not clear, and it is not needed"


@pytest.mark.parametrize("unit", ["um/min", "mm/s", "%/h", "mm s⁻¹", "foo/s"])
def test_a_unit_per_time_is_that_of_a_rate(tmp_path, unit):
    reason = ignored(tmp_path, f"bar ({unit})", 3 * SLOW)[1]
    assert reason == f"rate: its unit {unit}"


@pytest.mark.parametrize("name", ["Total Cycles", "Cycles", "cycle no"])
def test_a_count_of_cycles_is_no_signal(tmp_path, name):
    column, reason = ignored(tmp_path, name, K // 120, [*USED[:2], ("strain (mm/mm)", 0.01 * X)])
    assert reason.startswith("cycle number")
    assert column.unit == ""


def test_a_column_without_numbers_has_no_unit(tmp_path):
    dates = FoundColumn("Date", "mm", np.full(K.size, np.nan), kind="text")
    found = table(tmp_path, USED)
    guess = guess_table(FoundTable(found.path, "csv", "", (*found.columns, dates), found.layout, {}))
    assert guess.roles["Date"].reason == "no numbers"
    assert guess.columns[-1].unit == ""
