"""A sign between thousands belongs to numbers wherever it first appears, as in a clock that passes 1,000."""

import numpy as np
import pytest

from smarig.exchange import find_tables, import_file
from smarig.record import load_run
from smarig.study import guess_table, mapping_draft

N = 1300
T = np.round(58 - 33 * np.cos(np.linspace(0, 6 * np.pi, N)), 2)
S = np.round(2 + 1.5 * np.tanh((T - np.where(np.gradient(T) > 0, 63, 47)) / 7), 4)


def written(first, decimal, sign, delimiter, decimals=1, quote=""):
    """Rows of a clock that begins at ``first``, grouped by ``sign`` from 1000 on."""
    rows = [["time (s)", "T (degC)", "x (mm)"]]
    for t, *values in zip(first + np.arange(N), T, S):
        clock = f"{t:,.{decimals}f}".replace(".", "d").replace(",", sign).replace("d", decimal)
        rows.append([clock, *(f"{v:.4f}".replace(".", decimal) for v in values)])
    return "\n".join(delimiter.join(f"{quote}{cell}{quote}" for cell in row) for row in rows) + "\n"


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("first", [0, 340, 990])
@pytest.mark.parametrize(
    ("decimal", "sign", "delimiter", "quote"),
    [(".", ",", ",", '"'), (",", ".", ";", ""), (".", "'", "\t", "")],
)
def test_rows_go_on_where_thousands_begin(write, first, decimal, sign, delimiter, quote):
    path = write(written(first, decimal, sign, delimiter, quote=quote))
    (table,) = find_tables(path)
    np.testing.assert_allclose(table.columns[0].values, first + np.arange(N))
    mapping = path.with_suffix(".toml")
    mapping.write_text(mapping_draft(guess_table(table), "m"), encoding="utf-8")
    report = import_file(path, format="csv", out=path.with_suffix(".run.sqlite"), mapping=str(mapping))
    np.testing.assert_allclose(load_run(report.run)["position"], S)
    assert not [f.text for f in report.findings if "after the table" in f.text]


def test_numbers_without_decimals_beside_others_with_some(write):
    (table,) = find_tables(write(written(0, ".", ",", ",", decimals=0, quote='"')))
    np.testing.assert_allclose(table.columns[0].values, np.arange(N))


def test_three_decimals_of_another_sign_are_no_thousands(write):
    lines = written(0, ".", "", ";").splitlines()
    lines[1100] = lines[1100].rsplit(";", 1)[0] + ";1,234"
    (table,) = find_tables(write("\n".join(lines) + "\n"))
    assert not np.isin(1234.0, table.columns[2].values)
