"""Columns of a MultiIndex of pandas: names of all levels, the level of units, and the name of the index."""

import numpy as np
import pytest

from smarig.exchange import find_tables, import_file
from smarig.record import load_run
from smarig.study import guess_table, mapping_draft

N = 120
T = np.round(45 - 25 * np.cos(np.linspace(0, 4 * np.pi, N)), 2)
S = np.round(3 + 2 * np.tanh((T - np.where(np.gradient(T) > 0, 50, 38)) / 4), 3)
DEVICE = ["device", "oven", "wire", "wire"]
QUANTITY = ["quantity", "temperature", "temperature", "stroke"]
UNIT = ["unit", "degC", "degC", "mm"]
PLAIN = ("oven temperature", "wire temperature", "wire stroke")


def stamp(k):
    return f"2024-03-05 09:{k // 30:02}:{2 * (k % 30):02}"


def table(above, sign, clock=stamp):
    rows = [[clock(k), f"{t + 1:.2f}", str(t), str(s)] for k, (t, s) in enumerate(zip(T, S))]
    return "\n".join(sign.join(row) for row in [*above, *rows]) + "\n"


def unnamed(levels):
    return [["", *level[1:]] for level in levels]


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("sign", [",", ";", "\t"])
@pytest.mark.parametrize("clock", [stamp, lambda k: f"{2.0 * k:.1f}"], ids=["stamp", "seconds"])
@pytest.mark.parametrize(
    ("levels", "index", "names", "units"),
    [
        ([DEVICE, QUANTITY, UNIT], "time", PLAIN, True),
        (unnamed([DEVICE, QUANTITY, UNIT]), "time", PLAIN, True),
        ([UNIT, DEVICE, QUANTITY], "elapsed time", PLAIN, True),
        ([DEVICE, QUANTITY], "time", PLAIN, False),
        ([["sensor", "oven", "wire", "stroke"], UNIT[:3] + [""]], None, None, True),
    ],
)
def test_levels_of_names_are_combined(write, sign, clock, levels, index, names, units):
    above = [*levels, [index, "", "", ""]] if index else levels
    (found,) = find_tables(path := write(table(above, sign, clock)))
    if index:
        assert found.names == (index, *names)
        assert [column.unit for column in found.columns][1:] == (
            ["degC", "degC", "mm"] if units else [""] * 3
        )
    else:
        assert found.names[1:] == ("oven", "wire", "stroke")
    assert len(found) == N
    if not index or clock is not stamp or not units:
        return
    mapping = path.with_suffix(".toml")
    mapping.write_text(mapping_draft(guess_table(found), "m"), encoding="utf-8")
    run = load_run(
        import_file(path, format="csv", out=path.with_suffix(".run.sqlite"), mapping=str(mapping)).run
    )
    np.testing.assert_allclose(run["position"], S)
    np.testing.assert_allclose(run["t_s"], 2.0 * np.arange(N))


def test_a_title_below_a_row_of_names_is_no_name(write):
    names, units = ["Zeit", "Ofen", "Draht", "Weg"], ["s", "°C", "°C", "mm"]
    (found,) = find_tables(write(table([names, units, ["Messung 1"]], ";", lambda k: str(2 * k))))
    assert "Messung 1" not in found.names


def test_a_table_without_names_may_begin_with_clock_times(write):
    (found,) = find_tables(write(table([], ",")))
    np.testing.assert_allclose(found.columns[0].values, 2.0 * np.arange(N))
    np.testing.assert_allclose(found.columns[3].values, S)
