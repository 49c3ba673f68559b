"""Recording a run: every channel is read back, the file is readable at once, and closing leaves one file."""

import math
import sqlite3
from itertools import count

import numpy as np
import pytest

from record.runs import META, beside, result, sample, until
from smarig.core.command import StepVerdict
from smarig.core.errors import StorageError, UsageError
from smarig.core.sample import NAN, Quality
from smarig.record import Recorder, load_run, recorder
from smarig.record.schema import SAMPLE_COLUMNS


def test_every_channel_comes_back(tmp_path):
    path = tmp_path / "a.run.sqlite"
    rec = Recorder(path, META)
    rec.sample(sample(1), None, 12.5)
    rec.sample(sample(2, temperature_degC=61.25, quality=Quality.RETRIED | Quality.SATURATED), 3, NAN)
    rec.sample(sample(3, voltage_V=NAN, ambient_degC=NAN, position=math.pi), 3, -1e-300)
    rec.close()
    run = load_run(path)
    assert set(run.columns) == set(SAMPLE_COLUMNS)
    assert run["tick"].tolist() == [1, 2, 3]
    assert run["t_s"].tolist() == [0.1, 0.2, 0.3]
    assert run["current_command_A"].tolist() == [0.5] * 3
    assert run["current_A"].tolist() == [0.501, 0.502, 0.503]
    assert run["counts"].tolist() == [7, 14, 21]
    assert run["quality"].tolist() == [0, 5, 0]
    assert run["position"][2] == math.pi
    np.testing.assert_array_equal(run["step"], [NAN, 3, 3])
    np.testing.assert_array_equal(run["input"], [12.5, NAN, -1e-300])
    np.testing.assert_array_equal(run["temperature_degC"], [NAN, 61.25, NAN])
    np.testing.assert_array_equal(run["voltage_V"], [2.4, 2.4, NAN])
    np.testing.assert_array_equal(run["ambient_degC"], [22.0, 22.0, NAN])
    assert run.has("temperature_degC")


def test_what_was_not_measured_is_null_in_the_file(tmp_path):
    """NaN is no number for SQL: absent channels are NULL, so that AVG() and other tools leave them out."""
    path = tmp_path / "a.run.sqlite"
    rec = Recorder(path, META)
    rec.sample(sample(1), None, 0.0)
    rec.sample(sample(2, temperature_degC=50.0), None, 0.0)
    rec.close()
    db = sqlite3.connect(path)
    assert db.execute("SELECT AVG(temperature_degC), COUNT(temperature_degC) FROM sample").fetchone() == (
        50.0,
        1,
    )
    assert db.execute("SELECT typeof(step), typeof(counts), typeof(tick) FROM sample").fetchone() == (
        "null",
        "integer",
        "integer",
    )
    db.close()


def test_steps_events_and_description_come_back(tmp_path):
    path = tmp_path / "a.run.sqlite"
    rec = Recorder(path, META)
    rec.step(result(0), branch="rise", target=43.5)
    rec.step(result(1, StepVerdict.TIMED_OUT), branch="fall", target=None)
    rec.event(3.5, "zero", "Encoder <zeroed> — “here”.", counts=12)
    rec.event(4.5, "trip", "Too hot.", level="error")
    rec.describe("notes", "wire № 3")
    rec.close("stopped: because", t_s=9.0)
    run = load_run(path)
    first, second = run.steps
    assert (first.index, first.branch, first.target, first.verdict, first.position, first.n) == (
        0,
        "rise",
        43.5,
        "settled",
        1.5,
        250,
    )
    assert (first.t_start_s, first.t_end_s, first.attempt, first.void) == (0.0, 9.9, 0, False)
    assert (second.target, second.verdict) == (None, "timed_out")
    zero, trip, end = run.events
    assert (zero.t_s, zero.level, zero.kind, zero.text, zero.data) == (
        3.5,
        "info",
        "zero",
        "Encoder <zeroed> — “here”.",
        {"counts": 12},
    )
    assert trip.level == "error"
    assert (end.t_s, end.level, end.kind) == (9.0, "warning", "end")
    assert (run.meta["notes"], run.meta["rig"], run.meta["schema_version"]) == ("wire № 3", "bench", 1)
    assert (run.complete, run.cause, run.twin, run.unit, run.input_unit) == (
        True,
        "stopped: because",
        True,
        "mm",
        "K",
    )


# --- while it is written --------------------------------------------------------------------------------


def test_a_run_being_written_is_readable(tmp_path):
    """Rows are committed while the recorder lives; a step is committed at once, with what came before it."""
    path = tmp_path / "a.run.sqlite"
    rec = Recorder(path, META)
    assert len(load_run(path)) == 0
    for tick in range(100):
        rec.sample(sample(tick), 0, 0.0)
    rec.step(result(0), branch="rise", target=1.0)
    until(lambda: len(load_run(path).steps) == 1)
    run = load_run(path)
    assert len(run) == 100
    assert not run.complete
    assert run.cause.startswith("incomplete")
    rec.sample(sample(100), 1, 0.0)
    until(lambda: len(load_run(path)) == 101)  # nothing but time makes it commit
    rec.close()
    assert load_run(path).complete


def test_a_reader_that_stays_does_not_spoil_the_end(tmp_path):
    """A viewer holds the file open while the run is closed: all is written, its -wal goes with the viewer."""
    path = tmp_path / "a.run.sqlite"
    rec = Recorder(path, META)
    viewer = sqlite3.connect(path)
    viewer.execute("SELECT COUNT(*) FROM sample").fetchone()
    rec.sample(sample(1), None, 0.0)
    rec.close()
    viewer.close()
    assert beside(path) == ["a.run.sqlite"]
    assert load_run(path).complete
    assert len(load_run(path)) == 1


# --- the end --------------------------------------------------------------------------------------------


def test_closing_leaves_one_file(tmp_path):
    path = tmp_path / "deep" / "er" / "a.run.sqlite"
    rec = Recorder(path, META)
    for tick in range(2000):
        rec.sample(sample(tick), None, 0.0)
    rec.close()
    assert beside(path) == ["a.run.sqlite"]
    assert len(load_run(path)) == 2000
    with sqlite3.connect(path) as db:
        assert db.execute("PRAGMA journal_mode").fetchone() == ("delete",)
        assert db.execute("PRAGMA integrity_check").fetchone() == ("ok",)
    db.close()


def test_closing_twice_is_closing_once(tmp_path):
    path = tmp_path / "a.run.sqlite"
    rec = Recorder(path, META)
    rec.close("interrupted")
    rec.close("done")
    run = load_run(path)
    assert run.cause == "interrupted"
    assert [e.kind for e in run.events] == ["end"]


# --- refusals and failures --------------------------------------------------------------------------------


def test_an_existing_file_is_kept(tmp_path):
    path = tmp_path / "a.run.sqlite"
    Recorder(path, META).close()
    before = path.read_bytes()
    with pytest.raises(
        UsageError, match=r"a\.run\.sqlite exists. Give another name, or --force to replace it"
    ):
        Recorder(path, META)
    assert path.read_bytes() == before
    rec = Recorder(path, {**META, "rig": "other"}, force=True)
    rec.sample(sample(1), None, 0.0)
    rec.close()
    assert (load_run(path).meta["rig"], len(load_run(path))) == ("other", 1)


@pytest.mark.parametrize("force", [False, True])
def test_a_folder_is_not_replaced(tmp_path, force: bool):
    with pytest.raises(StorageError if force else UsageError):
        Recorder(tmp_path, META, force=force)
    assert tmp_path.is_dir()


def test_a_place_that_cannot_be_is_one_sentence(tmp_path):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(StorageError, match=r"Run file .*a\.run\.sqlite cannot be created: "):
        Recorder(tmp_path / "file" / "a.run.sqlite", META)


@pytest.fixture
def small_disk(monkeypatch):
    """Databases that may not grow beyond so many pages of 4 KiB; returns a function that enlarges them."""
    opened, made = recorder.opened_for_recording, []

    def limited(*args):
        db = opened(*args)
        db.execute("PRAGMA max_page_count=24")
        made.append(db)
        return db

    monkeypatch.setattr(recorder, "opened_for_recording", limited)
    return lambda: made[-1].execute("PRAGMA max_page_count=100000")


def fill(rec: Recorder, path) -> int:
    """Record until the disk is full: ten samples that are committed, then until sample() refuses."""
    ticks = count()
    for _ in range(10):
        rec.sample(sample(next(ticks)), None, 0.0)
    rec.step(result(0), branch="rise", target=1.0)
    until(lambda: len(load_run(path)) == 10)
    for _ in range(3000):
        rec.sample(sample(next(ticks)), None, 0.0)
    rec.step(result(1), branch="fall", target=0.0)
    until(lambda: rec._failure is not None)
    with pytest.raises(StorageError, match=r"a\.run\.sqlite cannot be written: database or disk is full"):
        rec.sample(sample(next(ticks)), None, 0.0)
    return next(ticks) - 1


def test_a_full_disk_is_reported_and_what_was_committed_stays(tmp_path, small_disk):
    path = tmp_path / "a.run.sqlite"
    rec = Recorder(path, META)
    fill(rec, path)
    with pytest.raises(
        StorageError, match=r"The end of run .* could not be written: database or disk is full"
    ):
        rec.close("stopped: the disk is full")
    rec.close()
    assert beside(path) == ["a.run.sqlite"]
    run = load_run(path)
    assert run["tick"].tolist() == list(range(10))
    assert (len(run.steps), run.complete) == (1, False)


def test_a_disk_that_recovers_gets_what_it_refused(tmp_path, small_disk):
    """A batch that failed is kept: when there is room again at the end, nothing is missing, in order."""
    path = tmp_path / "a.run.sqlite"
    rec = Recorder(path, META)
    accepted = fill(rec, path)
    small_disk()
    rec.close("stopped: the disk was full")
    run = load_run(path)
    assert run["tick"].tolist() == list(range(accepted))
    assert [s.index for s in run.steps] == [0, 1]
    assert run.cause == "stopped: the disk was full"


def test_recording_stops_while_there_is_room_to_close(tmp_path, monkeypatch):
    path = tmp_path / "a.run.sqlite"
    rec = Recorder(path, META)
    usage = recorder.shutil.disk_usage(tmp_path)
    monkeypatch.setattr(recorder.shutil, "disk_usage", lambda _: usage._replace(free=5_000_000))
    rec.sample(sample(1), None, 0.0)
    rec.step(result(0), branch="rise", target=1.0)
    until(lambda: rec._failure is not None)
    with pytest.raises(StorageError, match=r"only 5\.0 MB left on the disk"):
        rec.sample(sample(2), None, 0.0)
    rec.close("stopped")
    assert len(load_run(path)) == 1
    assert load_run(path).complete


@pytest.mark.parametrize("tick", [2, 2**63])
def test_a_sample_that_no_file_can_keep_costs_no_other(tmp_path, tick):
    """A clock that repeats itself, or runs away: all others are kept, and the run's end is."""
    path = tmp_path / "a.run.sqlite"
    rec = Recorder(path, META)
    for k in (1, 2, tick, 3):
        rec.sample(sample(k), 0, 0.0)
    rec.event(0.3, "mark", "something")
    with pytest.raises(StorageError, match=f"1 samples were not recorded; the first has tick {tick}"):
        rec.close("stopped")
    run = load_run(path)
    assert run["tick"].tolist() == [1, 2, 3]
    assert run.cause == "stopped"
    assert "something" in [e.text for e in run.events]


def test_the_file_alone_is_a_run_while_it_is_written(tmp_path):
    """Whoever copies a run that is being recorded without its -wal loses the last minute, not the run."""
    path, copy = tmp_path / "a.run.sqlite", tmp_path / "copy.run.sqlite"
    rec = Recorder(path, META)
    copy.write_bytes(path.read_bytes())
    assert load_run(copy).meta["rig"] == META["rig"]
    for k in range(1, 20_000):
        rec.sample(sample(k), 0, 0.0)
        if k % 100 == 0:
            rec._commit()
    copy.write_bytes(path.read_bytes())
    assert len(load_run(copy)) > 15_000
    rec.close()


def test_a_twin_that_is_faster_than_the_disk_waits_for_it(tmp_path, monkeypatch):
    """Samples waiting for the writer are bounded, so that memory does not grow with the run."""
    monkeypatch.setattr(recorder, "MOST_WAITING", 50)
    rec = Recorder(tmp_path / "a.run.sqlite", META)
    most = 0
    for tick in range(3000):
        rec.sample(sample(tick), None, 0.0)
        most = max(most, len(rec._rows))
    rec.close()
    assert most <= 51
    assert load_run(rec.path)["tick"].tolist() == list(range(3000))
