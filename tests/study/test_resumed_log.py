"""A log that was interrupted and resumed is one record of one wire: its clock goes on, and this is said."""

from pathlib import Path

import numpy as np
import pytest

from smarig.core import ConfigError, DataError
from smarig.exchange import FoundColumn, FoundTable, find_tables, import_file
from smarig.record import load_run
from smarig.study import StudyOptions, guess_table, mapping_draft, study
from study.known_data import displacements, temperatures

U = temperatures()
X = displacements(U)
PERIOD = 0.5
NAMES = "time_s,temperature_C,displacement_mm"


def log(parts, *, names_again=True, first=0.0):
    """A log of that many parts, each with a clock of its own."""
    lines = [NAMES]
    for k, rows in enumerate(np.array_split(np.arange(U.size), parts)):
        lines += [NAMES] if k and names_again else []
        lines += [f"{first + PERIOD * n:.1f},{U[row]:.3f},{X[row]:.4f}" for n, row in enumerate(rows)]
    return "\n".join(lines) + "\n"


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("first", [0.0, 0.5, 12.0])
@pytest.mark.parametrize("names_again", [True, False])
@pytest.mark.parametrize("parts", [2, 3, 5])
def test_the_parts_are_one_record(tmp_path, parts, names_again, first):
    path = tmp_path / "a.csv"
    path.write_text(log(parts, names_again=names_again, first=first))
    (table,) = find_tables(path)
    guess = guess_table(table)
    assert guess.first("time").name == "time_s"
    draft = tmp_path / "m.toml"
    draft.write_text(mapping_draft(guess, "m"), encoding="utf-8")
    report = import_file(path, format="csv", out=tmp_path / "a.run.sqlite", mapping=str(draft))
    run = load_run(report.run)
    np.testing.assert_allclose(run["t_s"], first + PERIOD * np.arange(U.size))
    np.testing.assert_allclose(run["input"], U, atol=1e-3)
    (said,) = [w for w in report.warnings if "starts again" in w]
    where = -(-U.size // parts) + 2 + names_again
    assert f"'time_s' starts again at {first:g} s in line {where}" in said
    assert ("more times" in said) == (parts > 2)
    assert "joined to one record" in said


def test_a_mapping_without_the_key_still_refuses(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(log(2))
    (table,) = find_tables(path)
    draft = tmp_path / "m.toml"
    text = mapping_draft(guess_table(table), "m")
    draft.write_text("\n".join(line for line in text.splitlines() if not line.startswith("restarts")))
    with pytest.raises(DataError, match="goes back from"):
        import_file(path, format="csv", out=tmp_path / "a.run.sqlite", mapping=str(draft))
    draft.write_text(text.replace('"join"', '"perhaps"'))
    with pytest.raises(ConfigError, match=r"time\.restarts"):
        import_file(path, format="csv", out=tmp_path / "a.run.sqlite", mapping=str(draft))


def test_a_clock_that_falls_elsewhere_is_none():
    t = PERIOD * np.arange(U.size)
    t[40:] -= 10.0  # back by twenty rows: not to its beginning
    columns = {NAMES.split(",")[k]: values for k, values in enumerate((t, U, X))}
    found = tuple(FoundColumn(name, "", values) for name, values in columns.items())
    guess = guess_table(FoundTable(Path("a.csv"), "csv", "", found, {"file": {}}, {}))
    assert guess.first("time") is None


def test_a_study_says_so(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(log(2))
    result = study([path], tmp_path / "out", StudyOptions(diagnose=False))
    (said,) = [hint for hint in result.hints() if "starts again" in hint]
    assert "keeps its state" in said
    assert not any("No time is recorded" in hint for hint in result.hints())


def test_the_given_log(shared_data, tmp_path):
    path = shared_data / "field_cases" / "restart_clock" / "log.csv"
    if not path.is_file():
        pytest.skip(f"no {path.name} in {path.parent}")
    result = study([path], tmp_path / "out", StudyOptions(diagnose=False))
    assert any("'time_s' starts again at 0 s in line 164" in hint for hint in result.hints())
    assert float(result.tables[0].run["t_s"][-1]) == 160.0
