"""Files of a cryostat: a held field is a condition, a comment refuses no file, and rows without a time are left out."""

import numpy as np
import pytest

from smarig.exchange import find_tables
from smarig.exchange.tables.table_structure import NumberStyle, find_blocks
from smarig.study.imported_runs import import_tables
from smarig.study.study_options import StudyOptions
from smarig.study.understanding import understand

HEAD = "[Header]\nTITLE,NiTi\n[Data]\nComment,Time Stamp (sec),Temperature (K),Magnetic Field (Oe),{}\n"
T_K = 330 - 40 * np.cos(np.linspace(0, 4 * np.pi, 160))
NOISE = np.random.default_rng(2).normal(0, 0.3, T_K.size)


def rows(field, start=0):
    """Two cycles of temperature in a field; the clock counts from 1904."""
    y = 1 + 0.1 * np.tanh((T_K - 330) / 6)
    return [
        f",{3.8e9 + 2.01 * (start + k):.2f},{T_K[k]:.3f},{field + NOISE[k]:.3f},{y[k]:.6f}"
        for k in range(T_K.size)
    ]


def file_of(tmp_path, lines, output="Resistance (ohms)"):
    path = tmp_path / "a.dat"
    path.write_text(HEAD.format(output) + "\n".join(lines) + "\n")
    return path


@pytest.mark.parametrize("output", ["Resistance (ohms)", "Moment (emu)"])
@pytest.mark.parametrize("field", [0.0, 500.0, -20000.0])
def test_a_held_field_is_a_condition_and_no_input(tmp_path, output, field):
    (guess,) = understand([file_of(tmp_path, rows(field), output)], StudyOptions()).guesses
    assert guess.first("input").name == "Temperature (K)"
    assert guess.first("time").name == "Time Stamp (sec)"
    (table,), _ = import_tables([guess], tmp_path / "out", None, "a")
    assert table.run.info.conditions["magnetic_field"]["mean"] == pytest.approx(field, abs=0.2)


def test_each_level_of_a_field_is_a_record(tmp_path):
    lines = [*rows(0.0), *rows(10_000.0, 160), *rows(50_000.0, 320)]
    found = understand([file_of(tmp_path, lines)], StudyOptions())
    assert [len(guess.table) for guess in found.guesses] == [160, 160, 160]


def test_a_field_that_sweeps_stays_the_input(tmp_path):
    lines = [
        f",{3.8e9 + k},300.0{k % 2},{h:.2f},{np.tanh(h / 900):.5f}"
        for k, h in enumerate(3000 * np.sin(T_K / 9))
    ]
    (guess,) = understand([file_of(tmp_path, lines, "Moment (emu)")], StudyOptions()).guesses
    assert guess.first("input").name == "Magnetic Field (Oe)"


def test_a_text_in_a_blank_column_refuses_no_file():
    """It may stand below the rows by which tables are found."""
    head, *cells = [line.split(",") for line in [HEAD.format("R").split("\n")[3], *rows(0.0)]]
    (block,) = find_blocks([head, *cells], NumberStyle())
    assert block.kinds == ("text", *["number"] * 4)


def test_a_row_without_a_time_is_left_out_and_the_clock_kept(tmp_path):
    lines = rows(500.0)
    lines[70] = ",," + lines[70].split(",", 2)[2]
    (guess,) = understand([file_of(tmp_path, lines)], StudyOptions()).guesses
    assert guess.first("time").name == "Time Stamp (sec)"
    (table,), _ = import_tables([guess], tmp_path / "out", None, "a")
    assert len(table.run["input"]) == 159
    assert "1 of 160 rows are left out, because 'Time Stamp (sec)' is empty there." in table.warnings


def test_a_time_that_runs_backwards_is_no_nearly_constant_column(tmp_path):
    lines = rows(500.0)
    lines[70], lines[90] = lines[90], lines[70]
    path = file_of(tmp_path, lines)
    assert len(find_tables(path)) == 1
    (guess,) = understand([path], StudyOptions()).guesses
    assert guess.roles["Time Stamp (sec)"].reason == "a time that runs backwards, so it is no clock"
