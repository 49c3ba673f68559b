"""``smarig check RUN``: plain sentences, one JSON object, and a status that tells whether the file is whole."""

import json
import sqlite3

import pytest

from record.runs import META, sample
from smarig.cli import run
from smarig.record import Recorder, load_run, run_check
from smarig.record.run import MOST_ROWS


@pytest.fixture
def whole(tmp_path):
    own = Recorder(tmp_path / "whole.run.sqlite", META)
    for tick in range(500):
        own.sample(sample(tick), 0, 0.0)
    own.close()
    return own.path


@pytest.fixture
def damaged(whole, tmp_path):
    """Without the page of some samples."""
    with sqlite3.connect(whole) as db:
        (page,) = db.execute("SELECT max(pageno) FROM dbstat WHERE name = 'sample'").fetchone()
    db.close()
    image = bytearray(whole.read_bytes())
    image[(page - 1) * 4096 : page * 4096] = bytes(4096)
    path = tmp_path / "damaged.run.sqlite"
    path.write_bytes(image)
    return path


def test_sentences_and_status(whole, damaged, tmp_path, capsys):
    out = tmp_path / "saved.run.sqlite"
    assert run(["check", str(whole)]) == 0
    assert "The file is whole." in capsys.readouterr().out
    assert run(["check", str(damaged)]) == 4
    assert f"smarig check {damaged} -o NEW.run.sqlite" in capsys.readouterr().out
    assert not out.exists()
    assert run(["check", str(damaged), "-o", str(out)]) == 4
    assert "are missing" in capsys.readouterr().out
    assert run(["check", str(out)]) == 0
    assert 0 < len(load_run(out)) < 500


def test_a_whole_run_is_copied(whole, tmp_path):
    out = tmp_path / "saved.run.sqlite"
    assert run(["check", str(whole), "-o", str(out)]) == 0
    assert len(load_run(out)) == 500


def test_what_is_refused_by_usage(whole, damaged, tmp_path, capsys):
    before = damaged.read_bytes()
    assert run(["check", str(damaged), "-o", str(damaged), "--force"]) == 2
    assert run(["check", str(damaged), "-o", str(whole)]) == 2  # exists
    assert run(["check", str(damaged), "--yes"]) == 2
    assert run(["check", "one_wire_twin", "-o", str(tmp_path / "new.run.sqlite")]) == 2
    assert run(["check", str(tmp_path / "none.run.sqlite")]) == 2
    assert "There is no run file" in capsys.readouterr().err
    assert damaged.read_bytes() == before


def test_a_run_file_of_any_name_is_known_by_its_content(whole, capsys):
    renamed = whole.rename(whole.with_name("measured"))
    assert run(["check", str(renamed)]) == 0
    assert "whole" in capsys.readouterr().out


def test_json_is_one_object(damaged, capsys):
    status = run(["check", str(damaged), "--json"])
    found = json.loads(capsys.readouterr().out)
    assert (status, found["whole"], found["hashes"], found["damaged_tables"]) == (
        4,
        False,
        "wrong",
        ["sample"],
    )
    assert [set(r) for r in found["missing_ticks"]] == [{"from", "to"}]


def test_more_rows_than_a_run_is_read_with_are_counted(whole, monkeypatch, capsys):
    """They are neither read nor salvaged, which takes a minute where they are a million."""
    monkeypatch.setitem(MOST_ROWS, "event", 0)
    monkeypatch.setattr(run_check, "salvage", lambda _: pytest.fail("salvaged"))
    assert run(["check", str(whole), "--json"]) == 4
    found = json.loads(capsys.readouterr().out)
    assert (found["samples"], found["events"], found["closed"], found["cause"]) == (500, 1, True, "done")
    assert (found["last_s"], found["hashes"]) == (49.9, "not_compared")
    assert found["problems"] == ["table 'event' has 1 rows; a run is read with at most 0"]
