"""Channels one below another, each below its name and with its own times, are columns of one table."""

import numpy as np
import pytest

from smarig.exchange import find_tables

FAST = np.cumsum(np.where(np.arange(80) % 3, 1.0, 1.2))
SLOW = FAST[4:-4:2] + 0.2
SERIES = {
    "oven.bar": (FAST, 50 - 20 * np.cos(FAST / 14), "degC"),
    "gauge 2": (SLOW, np.tanh(SLOW / 40 - 1), "mm"),
}


def day(t):
    return f"2023-05-04 07:{int(t) // 60:02d}:{t % 60:06.3f}"


HEAD, NAMES = "## Signal name = {name}", "# Timestamp;Reading [{unit}];Quality"


def text(head=HEAD, names=NAMES, clock=day, order=(0, 1), extra="good"):
    lines = ["# exported by archive", "# from 07:00 to 08:00", "#"]
    for name in (list(SERIES)[k] for k in order):
        t, x, unit = SERIES[name]
        lines += ["#", head.format(name=name), "#", names.format(unit=unit)]
        lines += [
            ";".join(filter(None, (clock(a), f"{b:.4f}", extra))) for a, b in zip(t.tolist(), x.tolist())
        ]
    return "\n".join(lines) + "\n"


def table_of(tmp_path, written):
    path = tmp_path / "archive.txt"
    path.write_text(written, encoding="utf-8")
    return find_tables(path)


def check(tables, order=(0, 1)):
    (table,) = tables
    named = [(name, SERIES[name][2]) for name in (list(SERIES)[k] for k in order)]
    assert table.names == ("time", *(f"{name} [{unit}]" for name, unit in named))
    columns = {c.name: c.values for c in table.columns}
    np.testing.assert_allclose(columns["time"] - columns["time"][0], FAST - FAST[0], atol=2e-3)
    np.testing.assert_allclose(columns["oven.bar [degC]"], SERIES["oven.bar"][1], atol=1e-4)
    gauge = columns["gauge 2 [mm]"]
    assert np.flatnonzero(np.isfinite(gauge)).tolist() == list(range(4, 76, 2))
    np.testing.assert_allclose(gauge[np.isfinite(gauge)], SERIES["gauge 2"][1], atol=1e-4)


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
@pytest.mark.parametrize(
    "head", ["## Signal name = {name}", "# Channel: {name}", "Tag: {name}", "# PV: {name}"]
)
def test_channels_are_joined_on_time(tmp_path, head, order):
    check(table_of(tmp_path, text(head=head, order=order)), order)


def test_clocks_may_be_numbers_below_a_name_that_says_so(tmp_path):
    check(table_of(tmp_path, text(clock=lambda t: f"{t:.3f}", names="time;value ({unit})", extra="")))


def test_what_is_no_time_is_not_joined(tmp_path):
    tables = table_of(tmp_path, text(clock=lambda t: f"{t:.3f}", names="Voltage;value ({unit})", extra=""))
    assert not any("gauge 2 [mm]" in table.names for table in tables)


def test_rows_of_several_values_are_tables(tmp_path):
    tables = table_of(tmp_path, text(names="# Timestamp;a [{unit}];b", extra="1.5"))
    assert not any("gauge 2 [mm]" in table.names for table in tables)
