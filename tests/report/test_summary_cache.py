"""The index reads only runs that changed, and what is kept beside it is never trusted further than it can be."""

import dataclasses
import json
import os

import numpy as np
import pytest

from record.runs import edited
from smarig.record import load_run, stored_run
from smarig.record.new_run_file import write_run
from smarig.report import folder_report
from smarig.report.folder_report import report_folder
from smarig.report.runs.run_summary import CACHE_FILE, SummaryCache, file_state, summary_of

META = {
    "source": "twin",
    "rig": "r",
    "protocol": "validation",
    "notes": "first note",
    "input": {"quantity": "temperature", "unit": "K"},
    "output": {"quantity": "displacement", "unit": "mm"},
}
STEPS = [(k, 0, 0, "up", 10.0 * k, 1.0 * k, k + 0.9, "settled", 0.1 * k, 5) for k in range(4)]


def make(path, steps, n=500):
    """A run of a loop with gaps, marks, and an ambient temperature that drifts."""
    t = np.linspace(0, 2 * np.pi, n)
    position = 5 - 5 * np.cos(t - 0.3)
    position[7] = np.nan
    columns = {
        "tick": np.arange(n),
        "t_s": np.where(np.arange(n) == 0, np.nan, 0.1 * np.arange(n)),
        "input": 50 - 50 * np.cos(t),
        "position": position,
        "quality": np.arange(n) % 8,
    }
    write_run(path, META, columns, steps, force=True)
    return path


@pytest.fixture
def folder(tmp_path):
    """Two runs with pages that are newer, in a folder and below it."""
    (tmp_path / "night").mkdir()
    make(tmp_path / "a.run.sqlite", STEPS)
    make(tmp_path / "night" / "b.run.sqlite", [])
    report_folder(tmp_path)
    for page in (tmp_path / "a.html", tmp_path / "night" / "b.html"):
        os.utime(page, (4e9, 4e9))
    return tmp_path


def index(folder) -> str:
    """The text of the index after an update."""
    return report_folder(folder).index.read_text(encoding="utf-8")


@pytest.fixture
def reads(monkeypatch):
    """The names of the runs that are read."""
    names = []
    for reader in ("load_run", "stored_run"):
        original = getattr(folder_report, reader)
        monkeypatch.setattr(
            folder_report,
            reader,
            lambda file, read=original, **how: names.append(file.name) or read(file, **how),
        )
    return names


@pytest.mark.parametrize("steps", [STEPS, []])
def test_the_summary_of_a_file_is_that_of_the_run_in_memory(tmp_path, steps):
    path = make(tmp_path / "a.run.sqlite", steps)
    with stored_run(path) as stored:
        found, expected = summary_of(stored), summary_of(load_run(path))
    for field in dataclasses.fields(expected):
        got, wanted = getattr(found, field.name), getattr(expected, field.name)
        assert np.array_equal(got, wanted), field.name
        assert type(got) is type(wanted), field.name
    assert expected.flagged == 250 + 250 + 248  # of 500 marks from 0 to 7, by bit
    assert expected.duration_s == pytest.approx(49.8)


def test_what_has_not_changed_is_not_read_again(folder, reads):
    before = (folder / "index.html").read_text(encoding="utf-8")
    cache = (folder / CACHE_FILE).read_bytes()
    assert index(folder) == before
    assert reads == []
    assert (folder / CACHE_FILE).read_bytes() == cache
    assert not list((folder / "night").glob("*.json"))


def test_a_run_that_was_touched_is_read_again(folder, reads):
    with edited(folder / "a.run.sqlite") as db:
        db.execute("UPDATE run SET value = ? WHERE key = 'notes'", [json.dumps("other note")])
    later = (folder / "a.run.sqlite").stat().st_mtime_ns + 10**9
    os.utime(folder / "a.run.sqlite", ns=(later, later))
    assert "other note" in index(folder)
    assert reads == ["a.run.sqlite"]
    index(folder)
    assert reads == ["a.run.sqlite"]


def test_size_time_and_log_of_a_file_count(tmp_path):
    file = tmp_path / "a.run.sqlite"
    states = [file_state(file)]
    for data, when in ((b"1234", 10), (b"1234", 11), (b"12345", 11)):
        file.write_bytes(data)
        os.utime(file, ns=(when, when))
        states.append(file_state(file))
    file.with_name("a.run.sqlite-wal").write_bytes(b"rows")
    states.append(file_state(file))
    assert len({tuple(state) for state in states}) == len(states)


def test_runs_that_are_gone_are_forgotten(folder):
    (folder / "night" / "b.run.sqlite").unlink()
    index(folder)
    assert list(json.loads((folder / CACHE_FILE).read_text())["runs"]) == ["a.run.sqlite"]


def changed(change):
    """A cache whose content was changed."""

    def damage(file):
        content = json.loads(file.read_text())
        change(content, content["runs"]["a.run.sqlite"]["summary"])
        file.write_text(json.dumps(content))

    return damage


DAMAGE = {
    "cut off": lambda file: file.write_bytes(file.read_bytes()[:200]),
    "empty": lambda file: file.write_bytes(b""),
    "no text": lambda file: file.write_bytes(b"\xff\xfe\x00\x01"),
    "another kind": lambda file: file.write_text("[1, 2]"),
    "too deep": lambda file: file.write_text("[" * 10**5),
    "no runs": changed(lambda content, _: content.update(runs=[])),
    "another version": changed(lambda content, a: (content.update(smarig="0.0.1"), a.update(wire="wrong"))),
    "another layout": changed(lambda content, a: (content.update(layout=0), a.update(wire="wrong"))),
    "other fields": changed(lambda content, a: (content["fields"].pop(), a.update(wire="wrong"))),
    "an entry of another kind": changed(lambda content, _: content["runs"].update({"a.run.sqlite": 7})),
    "a missing value": changed(lambda _, a: a.pop("cause")),
    "a value of another type": changed(lambda _, a: a.update(samples="many")),
    "texts as points": changed(lambda _, a: a.update(u=["1"] * len(a["u"]))),
    "infinite points": changed(lambda _, a: a.update(u=[float("inf")] * len(a["u"]))),
    "points without a partner": changed(lambda _, a: a.update(u=a["u"][1:])),
    "three axes": changed(lambda _, a: a.update(axes=["a", "b", "c"])),
}


@pytest.mark.parametrize("kind", DAMAGE)
def test_a_damaged_cache_is_made_again(folder, reads, kind: str):
    before = (folder / "index.html").read_text(encoding="utf-8")
    cache = (folder / CACHE_FILE).read_bytes()
    DAMAGE[kind](folder / CACHE_FILE)
    assert index(folder) == before
    assert "a.run.sqlite" in reads
    assert (folder / CACHE_FILE).read_bytes() == cache


def test_a_folder_that_takes_no_cache_costs_only_time(folder, reads):
    (folder / CACHE_FILE).unlink()
    (folder / CACHE_FILE).mkdir()
    assert "a.html" in index(folder)
    assert reads == ["a.run.sqlite", "b.run.sqlite"]


def test_what_a_cache_says_is_text_and_no_markup(folder):
    changed(lambda _, a: a.update(notes="<script>x</script>", rig='"><b>'))(folder / CACHE_FILE)
    text = index(folder)
    assert "<script>x" not in text
    assert '"><b>' not in text


def test_summaries_come_back_as_they_were(tmp_path):
    path = make(tmp_path / "a.run.sqlite", [])
    summary = summary_of(load_run(path))
    cache = SummaryCache(tmp_path)
    cache.keep(path, file_state(path), summary)
    cache.write()
    back = SummaryCache(tmp_path).of(path)
    assert back is not None
    for field in dataclasses.fields(summary):
        assert np.array_equal(getattr(back, field.name), getattr(summary, field.name)), field.name
