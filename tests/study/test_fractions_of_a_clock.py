"""A column of fractions of a second beside a clock of whole seconds is one clock with it."""

import numpy as np
import pytest

from smarig.core import ConfigError
from smarig.exchange import find_tables, import_file, load_mapping
from smarig.record import load_run
from smarig.study import guess_table, mapping_draft

ROWS = 240
U = np.round(60 - 35 * np.cos(np.linspace(0, 4 * np.pi, ROWS)), 1)
X = np.round(3 + 2 * np.tanh((U - np.where(np.gradient(U) > 0, 66, 54)) / 6), 3)


def log(path, period_s, head="ms", per_second=1000, start=0.2):
    """Rows of a logger: whole seconds of the day, and their fraction in its own column."""
    t_s = np.round(start + period_s * np.arange(ROWS), 6)
    rows = [
        f"2021/06/21 23:{59 - (t < 20):02d}:{int(t + 40) % 60:02d},{round((t % 1) * per_second, 3):g},{u},{x}"
        for t, u, x in zip(t_s, U, X)
    ]
    path.write_text("\n".join([f"Date&Time,{head},T [degC],x [mm]", *rows]) + "\n")
    return path


def imported(path):
    (table,) = find_tables(path)
    guess, mapping = guess_table(table), path.with_suffix(".toml")
    mapping.write_text(mapping_draft(guess, "m"), encoding="utf-8")
    report = import_file(path, format="csv", out=path.with_suffix(".run.sqlite"), mapping=str(mapping))
    return guess, load_run(report.run)


@pytest.mark.parametrize("period_s", [0.05, 0.1, 0.25])
@pytest.mark.parametrize(("head", "per_second"), [("ms", 1000), ("Fractional Seconds [s]", 1), ("us", 1e6)])
def test_each_row_has_its_own_time(tmp_path, period_s, head, per_second):
    guess, run = imported(log(tmp_path / "a.csv", period_s, head, per_second))
    assert [c.name for c in guess.of_role("fraction")] == [head]
    np.testing.assert_allclose(run["t_s"], period_s * np.arange(ROWS), atol=2e-6)
    np.testing.assert_array_equal(run["position"], X)


@pytest.mark.parametrize("cell", ["0", "250", "1500"])
def test_a_column_that_orders_no_rows_is_no_fraction(tmp_path, cell):
    path = log(tmp_path / "a.csv", 0.25)
    lines = path.read_text().splitlines()
    cells = [line.split(",") for line in lines[1:]]
    path.write_text("\n".join([lines[0], *(f"{a},{cell},{c},{d}" for a, _, c, d in cells)]) + "\n")
    guess, run = imported(path)
    assert not guess.of_role("fraction")
    assert len(run) == len({line[0] for line in cells}), "rows of one second are averaged"


def test_a_fraction_needs_its_column(tmp_path):
    log(tmp_path / "a.csv", 0.25)
    imported(tmp_path / "a.csv")
    draft = (tmp_path / "a.toml").read_text()
    bad = tmp_path / "bad.toml"
    bad.write_text(draft.replace('fraction_unit = "ms"', 'fraction_unit = "mm"'))
    with pytest.raises(ConfigError, match="fraction_unit"):
        load_mapping(str(bad))
    bad.write_text(draft.replace('column = "Date&Time"', "period_s = 0.25").replace('written = "clock"', ""))
    with pytest.raises(ConfigError, match="'fraction' is added to a column of whole seconds"):
        load_mapping(str(bad))
