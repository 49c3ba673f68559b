"""Titles of segments between the rows of a table end no table; what is left out of a file is reported."""

import numpy as np
import pytest

from smarig.exchange import find_tables
from smarig.study.heat_flow_header import heat_flow_header
from smarig.study.study_options import StudyOptions
from smarig.study.understanding import understand

T_DEGC = np.r_[np.linspace(20, 120, 40), np.linspace(120, 20, 40)]
ROWS = [f"{0.5 * k:.1f}\t{u:.3f}\t{4 - np.tanh((u - 70) / 9):.4f}" for k, u in enumerate(T_DEGC)]
HEAD = ["Sample Weight: 12.3 mg", "", "Time\tTemperature\tStrain", "s\t°C\t%"]
TITLE = "{}) Heat from 20.00°C to 120.00°C at 10.00°C/min"


def file_of(tmp_path, lines, name="wire.txt"):
    path = tmp_path / name
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize(
    "between",
    [
        [TITLE.format(2)],
        ["", TITLE.format(2), ""],
        [TITLE.format(2), "Sample Weight: 12.3 mg"],
        ["Sample Weight:\t12.3 mg"],
        ["Rate:\t10.0 K\tper minute"],
        [TITLE.format(2), ROWS[40], TITLE.format(3)],  # a segment of one row
    ],
)
def test_titles_of_segments_end_no_table(tmp_path, between):
    rest = ROWS[41:] if ROWS[40] in between else ROWS[40:]
    path = file_of(tmp_path, [*HEAD, TITLE.format(1), *ROWS[:40], *between, *rest])
    (table,) = find_tables(path)
    assert table.names == ("Time", "Temperature", "Strain")
    np.testing.assert_allclose(table.columns[1].values, T_DEGC, atol=1e-3)
    assert heat_flow_header(table).mass_mg == pytest.approx(12.3)


@pytest.mark.parametrize("title", [TITLE.format(2), "Second cooling of the same wire"])
def test_sentences_between_rows_of_blanks_are_no_names(tmp_path, title):
    rows = [" ".join(row.split("\t")) for row in ROWS]
    path = file_of(tmp_path, ["Time Temp Strain", *rows[:40], title, *rows[40:]])
    (table,) = find_tables(path)
    assert table.names == ("Time", "Temp", "Strain")
    assert len(table) == 80


def test_other_names_begin_another_table(tmp_path):
    path = file_of(tmp_path, [*HEAD, *ROWS[:40], "Second run", "Time\tForce\tStroke", *ROWS[40:]])
    assert [table.names[1] for table in find_tables(path)] == ["Temperature", "Force"]


def test_rows_that_no_mapping_can_describe_are_reported(tmp_path):
    pairs = [f"{k}\t{k + 1}" for k in range(9)]
    path = file_of(tmp_path, [*HEAD, *ROWS, "", "Calibration", *pairs])
    tables = find_tables(path)
    assert [len(table) for table in tables] == [80]
    assert list(tables[0].left_out) == ["lines 87 to 95"]
    found = understand([path], StudyOptions())
    assert list(found.left_out) == ["wire.txt lines 87 to 95"]


def test_closed_loops_below_titles_are_records_of_their_own(tmp_path):
    path = file_of(tmp_path, [*HEAD, "Specimen 1", *ROWS, "Specimen 2", *ROWS])
    found = understand([path], StudyOptions())
    assert [(g.table.name, g.table.layout["rows"]) for g in found.guesses] == [
        ("part 1", {"first": 1, "last": 80}),
        ("part 2", {"first": 81, "last": 160}),
    ]


def test_a_clock_that_starts_again_with_each_segment_is_one_record(tmp_path):
    again = [f"{0.5 * k:.1f}\t{row.split(chr(9), 1)[1]}" for k, row in enumerate(ROWS[40:])]
    path = file_of(tmp_path, [*HEAD, TITLE.format(1), *ROWS[:40], TITLE.format(2), *again])
    (guess,) = understand([path], StudyOptions()).guesses
    assert len(guess.table) == 80
    assert "rows" not in guess.table.layout
