"""Columns of several specimens side by side are records: no column of one is another's load."""

import numpy as np
import pytest

from smarig.study.imported_runs import import_tables
from smarig.study.study_options import StudyOptions
from smarig.study.understanding import understand

ROWS = (90, 80, 60)
NAMES = ["Time", "Force", "Stroke"]


def specimens(turning=True):
    """Time, force and stroke of each specimen; a pull and its return, or the pull alone."""
    for k, rows in enumerate(ROWS):
        s = np.linspace(0, 2, rows)
        stroke = 3 - 3 * np.abs(s - 1) if turning else 3 * s
        lag = np.where(s <= 1, -0.3, 0.3) if turning else 0.0
        yield np.array([0.1 * np.arange(rows), (50 + k) * np.tanh(stroke / 2 + lag), stroke])


def file_of(tmp_path, above, records):
    lines = [*above, ",".join(NAMES * len(records)), ",".join(["sec", "N", "mm"] * len(records))]
    for k in range(max(ROWS)):
        cells = [f"{x[k]:.4f}" if k < x.size else "" for record in records for x in record]
        lines.append(",".join(cells))
    path = tmp_path / "pulls.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize("turning", [True, False])
def test_each_specimen_is_a_record_with_its_rows_and_its_name(tmp_path, turning):
    records = list(specimens(turning))
    path = file_of(tmp_path, ['"1 _ 1",,,"1 _ 2",,,"1 _ 3",,'], records)
    found = understand([path], StudyOptions(accept=True))
    assert [g.table.name for g in found.guesses] == ["1 _ 1", "1 _ 2", "1 _ 3"]
    for guess, record in zip(found.guesses, records, strict=True):
        assert not guess.of_role("condition")
        used = {role: guess.first(role).name for role in ("time", "input", "output")}
        assert sorted(used.values()) == sorted(NAMES)
        force = next(c.values for c in guess.table.columns if c.name == "Force")
        np.testing.assert_allclose(force, record[1], atol=1e-4)
    tables, left_out = import_tables(found.guesses, tmp_path / "out", None, "pulls")
    assert not left_out
    assert [len(table.run["input"]) for table in tables] == list(ROWS)


def test_without_names_of_specimens_records_are_numbered(tmp_path):
    path = file_of(tmp_path, ["Operator,MK"], list(specimens()))
    found = understand([path], StudyOptions())
    assert [g.table.name for g in found.guesses] == ["columns 1", "columns 2", "columns 3"]


def test_clocks_that_go_on_leave_branches_together(tmp_path):
    first, second, _ = specimens(turning=False)
    second[0] += first[0, -1] + 0.1
    path = file_of(tmp_path, [], [first, second])
    assert len(understand([path], StudyOptions(accept=True)).guesses) == 1


def test_a_second_held_load_is_no_second_condition(tmp_path):
    u = 70 - 50 * np.cos(np.linspace(0, 12, 200))
    x = np.tanh((u - 70) / 9)
    rows = (f"{0.5 * k},{u[k]:.3f},{x[k]:.4f},20.{k % 2},21.{k % 2}" for k in range(200))
    path = tmp_path / "cells.csv"
    path.write_text("\n".join(["Time (s),T (degC),Stroke (mm),Load 1 (N),Load 2 (N)", *rows]) + "\n")
    (guess,) = understand([path], StudyOptions()).guesses
    assert [c.name for c in guess.of_role("condition")] == ["Load 1 (N)"]
    import_tables([guess], tmp_path / "out", None, "cells")


LABELS = [
    "Latest: {};Take 4: {};Take 5: {}",
    "a7_{};a8_{};a12_{}",
    "{} (dry);{} (wet);{} (oiled)",
    "{};{}.1;{}.2",
]


def labelled(tmp_path, pattern, records):
    names = [form.format(name) for form in pattern.split(";") for name in NAMES]
    lines = [";".join(names)]
    for k in range(max(ROWS)):
        lines.append(";".join(f"{x[k]:.4f}" if k < x.size else "" for record in records for x in record))
    path = tmp_path / "pulls.txt"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize("pattern", LABELS)
def test_blocks_whose_names_differ_by_a_label_are_records(tmp_path, pattern):
    records = list(specimens())
    found = understand([labelled(tmp_path, pattern, records)], StudyOptions(accept=True))
    for guess, record in zip(found.guesses, records, strict=True):
        used = {role: guess.first(role).name for role in ("time", "input", "output")}
        assert sorted(used.values()) == sorted(NAMES)
        np.testing.assert_allclose(
            guess.table.columns[guess.table.names.index("Force")].values, record[1], atol=1e-4
        )
    tables, left_out = import_tables(found.guesses, tmp_path / "out", None, "pulls")
    assert not left_out
    assert [len(table.run["input"]) for table in tables] == list(ROWS)


def test_records_have_the_names_of_their_labels(tmp_path):
    found = understand([labelled(tmp_path, LABELS[0], list(specimens()))], StudyOptions(accept=True))
    assert [guess.table.name for guess in found.guesses] == ["Latest", "Take 4", "Take 5"]


def test_a_column_that_is_named_with_its_label_stays_in_one_table(tmp_path):
    path = labelled(tmp_path, LABELS[1], list(specimens()))
    (guess,) = understand([path], StudyOptions(accept=True, input="a8_Stroke", output="a8_Force")).guesses
    assert (guess.first("input").name, guess.first("output").name) == ("a8_Stroke", "a8_Force")


def test_blocks_without_a_clock_are_no_records(tmp_path):
    path = labelled(tmp_path, "{} 1;{} 2;{} 3", list(specimens()))
    path.write_text(path.read_text().replace("Time", "Field"))
    assert len(understand([path], StudyOptions(accept=True)).guesses) == 1


@pytest.mark.parametrize("words", ["heating;cooling", "Up;Down"])
def test_labels_of_branches_are_no_records(tmp_path, words):
    pattern = ";".join(f"{word} {{}}" for word in words.split(";"))
    path = labelled(tmp_path, pattern, list(specimens(turning=False))[:2])
    assert len(understand([path], StudyOptions(accept=True)).guesses) == 1


def test_blocks_of_a_sheet_are_records(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    records, book = list(specimens()), openpyxl.Workbook()
    book.active.append([f"Go {k}: {name}" for k in range(3) for name in NAMES])
    for k in range(max(ROWS)):
        book.active.append([float(x[k]) if k < x.size else None for record in records for x in record])
    book.save(tmp_path / "pulls.xlsx")
    found = understand([tmp_path / "pulls.xlsx"], StudyOptions(accept=True))
    tables, _ = import_tables(found.guesses, tmp_path / "out", None, "pulls")
    assert [len(table.run["input"]) for table in tables] == list(ROWS)
