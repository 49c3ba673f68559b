"""Rows of results are no curve: a table of one row per specimen or recording is refused, and a record is not."""

import pytest

from smarig.core import UsageError
from smarig.exchange import find_tables
from smarig.study import StudyOptions, study
from smarig.study.result_rows import are_results
from smarig.study.table_guess import guess_table

FORCES = (2.0, 4.0, 8.0, 16.0)


def table(folder, rows, header="sample;force [N];elongation [um];set"):
    file = folder / "summary.txt"
    file.write_text("\n".join([header, *(";".join(map(str, row)) for row in rows)]) + "\n")
    return file


def by_force():
    """Three samples at each force, one force after the other."""
    return [(f"B{k}", f, round(90 * f**0.5 + k, 1), 1) for f in FORCES for k in range(3)]


def by_sample():
    return sorted(by_force(), key=lambda row: row[0])


def falling():
    return by_force()[::-1]


@pytest.mark.parametrize("rows", [by_force, by_sample, falling])
def test_results_of_several_samples_are_refused_with_what_is_needed(tmp_path, rows):
    file = table(tmp_path, rows())
    with pytest.raises(UsageError) as error:
        study([file], tmp_path / "out", StudyOptions(accept=True))
    text = str(error.value)
    assert "these 12 rows look like results" in text
    assert "the same 4 values again and again (2, 4, 8 … N)" in text
    assert "Study the recorded curves" in text
    assert "--input NAME --output NAME" in text


def steps_up_and_down():
    there = [f for f in FORCES for _ in range(3)]
    return [("B1", f, round(30 * f + 7 * (k >= 12), 1), 1) for k, f in enumerate(there + there[::-1])]


def two_branches():
    return [
        (way, 10 * k, 50 * k + (60 if way == "back" else 0), 1) for way in ("there", "back") for k in range(8)
    ]


def many_values():
    return [(f"B{n}", 5 * k, 100 * k + n, 1) for n in range(3) for k in range(12)]


@pytest.mark.parametrize("rows", [steps_up_and_down, two_branches, many_values])
def test_a_record_with_texts_is_no_table_of_results(tmp_path, rows):
    (found,) = find_tables(table(tmp_path, rows()))
    assert not are_results(guess_table(found, input="force [N]", output="elongation [um]"))


def test_columns_that_are_named_are_fitted(tmp_path):
    file = table(tmp_path, by_force())
    options = StudyOptions(input="force [N]", output="elongation [um]", diagnose=False)
    assert study([file], tmp_path / "out", options).goes_one_way
