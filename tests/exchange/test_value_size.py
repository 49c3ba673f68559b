"""Numbers near the largest a computer holds are refused with line and column, and never reach a computation."""

import warnings

import numpy as np
import pytest

from smarig.cli import run as cli
from smarig.core.errors import DataError, UsageError
from smarig.exchange import find_tables, import_file

NAMES = ["time_s", "current_A", "position_mm"]
FORC = """MicroMag 2900/3900 Data File (Series 0015)
First-order reversal curves
Units of measure:  Hybrid SI

"""


@pytest.fixture(autouse=True)
def no_numpy_warning():
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        yield


def table(changed=None, value="1e308", extra=""):
    t = np.arange(0, 300, 1.5)
    drive = 0.4 - 0.4 * np.cos(2 * np.pi * t / 100)
    rows = [[f"{a:g}", f"{b:.5f}", f"{b * b:.5f}"] for a, b in zip(t, drive, strict=True)]
    if changed is not None:
        rows[-1 if changed == 0 else 50][changed] = value
    if extra:
        rows = [[*row, extra if k == 40 else str(k % 7)] for k, row in enumerate(rows)]
    names = [*NAMES, "force_N"] if extra else NAMES
    return "\n".join(",".join(row) for row in [names, *rows]) + "\n"


@pytest.mark.parametrize("command", ["import", "study"])
@pytest.mark.parametrize("column", [0, 1, 2])
def test_a_value_of_1e308_is_refused_with_line_and_column(write, tmp_path, capsys, command, column):
    options = ["--format", "csv"] if command == "import" else ["--yes"]
    status = cli([command, str(write(table(column))), *options, "-o", str(tmp_path / "out")])
    error = capsys.readouterr().err.strip().splitlines()[-1]
    assert status == 4
    assert (
        f"line {201 if column == 0 else 52}, column '{NAMES[column]}': 1e+308 is no measured value" in error
    )


def test_a_large_number_in_an_unused_column_is_a_mark_or_refused(write):
    marked = find_tables(write(table(extra="9.91e37")))
    assert marked[0].names == (*NAMES, "force_N")
    with pytest.raises(DataError, match=r"line 42, column 'force_N': -1.7e\+308 is no measured value"):
        find_tables(write(table(extra="-1.7e308")))


@pytest.mark.parametrize(("field", "moment", "column"), [("0.2", "1e308", "moment"), ("1e999", "1", "field")])
def test_a_reversal_curve_with_such_a_value_is_refused(write, tmp_path, field, moment, column):
    rows = [f"{h:+.3f},{h / 3:+.4f}" for h in np.linspace(-0.1, 0.1, 30)]
    rows[20] = f"{field},{moment}"
    path = write(FORC + "\n".join(rows) + "\n", "curves.forc")
    with pytest.raises(DataError, match=f"line 25, column '{column}': .* is no measured value"):
        import_file(path, format="forc", out=tmp_path / "f.run.sqlite")


def test_a_time_of_millions_of_years_is_a_wrong_unit(write, imported, tmp_path):
    with pytest.raises(DataError, match=r"line 201, column 'time_s': 1e\+20 s as t_s lies outside"):
        imported(write(table(0, "1e20")))
    with pytest.raises(UsageError, match="--t0 is 1e"):
        import_file(write(table()), format="csv", out=tmp_path / "t.run.sqlite", t0=1e300)
    assert imported(write(table(0, "1.7e12")))["t_s"][-1] == 1.7e12  # milliseconds since 1970
