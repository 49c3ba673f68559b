"""A file that states its system of units asks nobody; a loop that is imported as reversal curves is called one."""

import numpy as np
import pytest

from smarig.core import DataError
from smarig.exchange import find_tables, import_file, read_forc
from smarig.study import guess_table

H = 0.5 * np.cos(np.linspace(0, 2 * np.pi, 80))
M = 2e-6 * np.tanh(H / 0.1)
SYSTEMS = {
    "Hybrid SI": ("T", "A m^2"),
    "SI": ("A/m", "A m^2"),
    "cgs": ("Oe", "emu"),
    "CGS": ("Oe", "emu"),
    "SiMuNaughtH": ("T", "A m^2"),
}
LINES = ("Units of measure        {}", "Units of measure: {}", "Unit system = {}", "# Units: {}")


def instrument(statement, names=("Field", "Moment"), title="Hysteresis loop"):
    head = ["Magnetometer Data File (Series 15)", f"Direct moment vs. field; {title}", "", "INSTRUMENT"]
    head += ["Configuration           VSM", statement, "", "    ".join(names)]
    rows = [f"{h:+.6E},{m:+.6E}" for h, m in zip(H, M)]
    return "\n".join([*head, *rows, "", "Data File ends"]) + "\n"


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("names", [("Field", "Moment"), ("Applied field", "Adjusted moment")])
@pytest.mark.parametrize("line", LINES)
@pytest.mark.parametrize("system", SYSTEMS)
def test_a_stated_system_gives_the_units(write, system, line, names):
    (table,) = find_tables(write(instrument(line.format(system), names), "a.loop"))
    guess = guess_table(table)
    assert not guess.doubts
    drive, out = guess.first("input"), guess.first("output")
    assert (drive.name, out.name) == names
    assert (drive.unit, out.unit) == SYSTEMS[system]


def test_units_of_the_columns_count_more(write):
    text = instrument(LINES[0].format("cgs"), ("Field (mT)", "Moment (A m^2)"))
    (table,) = find_tables(write(text, "a.loop"))
    guess = guess_table(table)
    assert (guess.first("input").unit, guess.first("output").unit) == ("mT", "A m^2")


@pytest.mark.parametrize(
    "statement", ["Units of measure        of its own", "Units of the house: cgs and others"]
)
def test_an_unknown_system_is_none(write, statement):
    (table,) = find_tables(write(instrument(statement), "a.loop"))
    assert [column.unit for column in table.columns] == ["", ""]
    assert "unit Moment" in guess_table(table).doubts


def test_a_loop_is_no_file_of_reversal_curves(write, tmp_path):
    path = write(instrument(LINES[0].format("cgs")), "a.loop")
    with pytest.raises(DataError, match=r"holds a hysteresis loop.*`smarig study a\.loop`.*--format csv"):
        import_file(path, format="forc", out=tmp_path / "a.run.sqlite")


def test_reversal_curves_that_mention_a_loop_are_read(write):
    text = instrument(LINES[0].format("cgs"), title="First-order reversal curves")
    text = text.replace("INSTRUMENT", "Hysteresis loop?        No")
    assert read_forc(write(text.replace("Field    Moment", ""), "a.frc")).units == ("Oe", "emu")


def test_the_given_loop(shared_data, tmp_path):
    path = shared_data / "field_cases" / "micromag_series_0015" / "VM1BX.loop"
    if not path.is_file():
        pytest.skip(f"no {path.name} in {path.parent}")
    table = max(find_tables(path), key=len)
    guess = guess_table(table)
    assert not guess.doubts
    assert (guess.first("input").unit, guess.first("output").unit) == ("T", "A m^2")
    with pytest.raises(DataError, match="smarig study"):
        import_file(path, format="forc", out=tmp_path / "a.run.sqlite")
