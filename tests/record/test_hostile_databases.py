"""Run files that would execute something are refused for reading and for continuing, in bounded time."""

import os
import shutil
import signal
import sqlite3
from pathlib import Path

import pytest

from hostile.journals import journal_of_a_page, journal_that_names
from record.runs import META, edited, sample, unhash
from smarig.core import DataError, UsageError
from smarig.record import Continuation, Recorder, load_run
from smarig.record.guarded_database import bounded, restrict

FOREVER = "WITH RECURSIVE r(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM r)"


@pytest.fixture
def path(tmp_path) -> Path:
    """A finished run of 100 samples."""
    own = Recorder(tmp_path / "a.run.sqlite", META)
    for tick in range(100):
        own.sample(sample(tick), 0, 0.0)
    own.close()
    return own.path


def execute(path: Path, *statements: str) -> None:
    db = sqlite3.connect(path, isolation_level=None)
    db.execute("PRAGMA legacy_alter_table = ON")
    for statement in statements:
        db.execute(statement)
    db.close()


UNREADABLE: dict[str, tuple[str, tuple[str, ...]]] = {
    "view": (
        "the view 'event'",
        ("DROP TABLE event", f"CREATE VIEW event AS {FOREVER} SELECT x, x, x, x, x FROM r"),
    ),
    "view that yields nothing": (
        "the view 'event'",
        ("DROP TABLE event", f"CREATE VIEW event AS {FOREVER} SELECT x, x, x, x, x FROM r WHERE x < 0"),
    ),
    "trigger": (
        "the trigger 't'",
        ("CREATE TRIGGER t AFTER DELETE ON run BEGIN DELETE FROM sample; END",),
    ),
    "trigger elsewhere": (
        "the trigger 't'",
        ("CREATE TABLE o (x)", "CREATE TRIGGER t AFTER INSERT ON o BEGIN DELETE FROM sample; END"),
    ),
    "virtual": ("'sample' is virtual", ("DROP TABLE sample", "CREATE VIRTUAL TABLE sample USING dbstat")),
    "virtual elsewhere": ("'o' is virtual", ("CREATE VIRTUAL TABLE o USING fts5(x)",)),
    "computed": (
        "'event' has other columns",
        ("DROP TABLE event", "CREATE TABLE event (t_s, level, kind, text, data AS (length(zeroblob(9))))"),
    ),
    "more columns": ("'step' has other columns", ("ALTER TABLE step ADD COLUMN more",)),
    "index": ("the index 'i'", ("CREATE INDEX i ON sample (abs(position))",)),
}
UNWRITABLE: dict[str, str] = {
    "check": "CREATE TABLE event (t_s, level, kind, text, data CHECK (length(data) < 0))",
    "reference": "CREATE TABLE event (t_s REFERENCES sample ON DELETE CASCADE, level, kind, text, data)",
    "default": "CREATE TABLE event (t_s, level, kind, text, data DEFAULT (length(zeroblob(9))))",
}


@pytest.mark.parametrize("kind", UNREADABLE)
def test_what_would_execute_something_is_refused_for_reading_and_for_continuing(path, kind):
    says, statements = UNREADABLE[kind]
    execute(path, *statements)
    before = path.read_bytes()
    with pytest.raises(DataError, match=says) as refusal:
        load_run(path)
    assert str(refusal.value).startswith(f"{path} is not a run file, or is damaged: ")
    assert path.read_bytes() == before
    with pytest.raises(DataError, match=says):
        Recorder(path, META, continuation=Continuation())


@pytest.mark.parametrize("kind", UNWRITABLE)
def test_tables_that_only_writing_would_execute_are_read_but_not_continued(path, kind):
    unhash(path)
    execute(path, "DROP TABLE event", UNWRITABLE[kind])
    assert len(load_run(path)) == 100
    with pytest.raises(DataError, match="'event' is not as a recorder creates it"):
        Recorder(path, META, continuation=Continuation())


def test_a_table_of_somebody_else_is_no_harm(path):
    execute(path, "CREATE TABLE other (x)", "INSERT INTO other VALUES (1)")
    assert len(load_run(path)) == 100
    Recorder(path, META, continuation=Continuation()).close()


def test_a_query_without_end_is_stopped_by_its_bound(path):
    """Beyond what any schema allows: a bound that the file's size gives."""
    db = sqlite3.connect(path)
    with pytest.raises(DataError, match="takes longer than any run of its size"), bounded(db, path):
        db.execute(f"{FOREVER} SELECT x FROM r WHERE x < 0").fetchall()
    db.close()


@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
def test_a_signal_ends_a_query(path):
    """As Ctrl-C and SIGTERM do: the signal arrives while SQLite computes, started by the query itself."""
    db = sqlite3.connect(path)
    before = signal.signal(signal.SIGALRM, signal.default_int_handler)
    db.create_function("start", 0, lambda: signal.setitimer(signal.ITIMER_REAL, 0.01)[0])
    os.truncate(path, 10_000_000_000)  # a bound of minutes
    try:
        with pytest.raises(KeyboardInterrupt), bounded(db, path):
            db.execute(f"{FOREVER} SELECT start() UNION ALL SELECT x FROM r WHERE x < 0").fetchall()
    finally:
        signal.signal(signal.SIGALRM, before)
        db.close()


def test_no_text_of_a_file_is_too_long_for_the_memory(path):
    db = sqlite3.connect(path)
    restrict(db)
    with pytest.raises(sqlite3.DataError, match="too big"):
        db.execute("SELECT zeroblob(100000000)").fetchone()
    db.close()


@pytest.mark.parametrize(
    ("statement", "says"),
    [
        ("INSERT INTO run VALUES ('notes', ?)", "its key 'notes' is not a string of at most 1000000"),
        ("INSERT INTO run VALUES ('protocol', ?)", "its key 'protocol' is not a string of at most 10000"),
        ("INSERT INTO event VALUES (0, 'info', 'x', ?, '{}')", "has more than 10000 characters"),
        ("INSERT INTO event VALUES (0, 'info', ?, 'x', '{}')", "has more than 10000 characters"),
    ],
)
def test_long_texts_are_refused_with_their_limit(path, statement, says):
    with edited(path) as db:
        db.execute("DELETE FROM run WHERE key = 'protocol'")
        db.execute(statement, ('"' + "n" * 2_000_000 + '"',))
    with pytest.raises(DataError, match=says):
        load_run(path)


def test_a_long_cause_is_shortened_when_it_is_written_so_that_the_run_can_be_read(tmp_path):
    own = Recorder(tmp_path / "b.run.sqlite", META)
    own.event(0.0, "driver", "e" * 1_000_000)
    own.close("c" * 1_000_000)
    run = load_run(own.path)
    assert run.cause.startswith("cccc")
    assert run.events[0].text.endswith("eeee")


def test_a_description_that_could_not_be_read_again_is_refused_before_the_experiment(tmp_path):
    with pytest.raises(UsageError, match="'notes' is not a string of at most"):
        Recorder(tmp_path / "b.run.sqlite", {**META, "notes": "n" * 2_000_000})
    assert not list(tmp_path.iterdir())


# --- what stands beside a file ---------------------------------------------------------------------------------


@pytest.mark.parametrize("read", [load_run, lambda path: Recorder(path, META, continuation=Continuation())])
def test_no_journal_deletes_another_file(path, tmp_path, read):
    victim = tmp_path / "thesis.txt"
    victim.write_text("years of work\n" * 10)
    path.with_name(path.name + "-journal").write_bytes(journal_that_names(victim, path.read_bytes()))
    with pytest.raises(DataError, match="a.run.sqlite-journal belongs to several databases"):
        read(path)
    assert victim.exists()


@pytest.mark.skipif(os.name == "nt", reason="symbolic links need rights there")
@pytest.mark.parametrize("suffix", ["-wal", "-journal", "-shm"])
def test_links_beside_a_run_are_not_followed(path, tmp_path, suffix):
    path.with_name(path.name + suffix).symlink_to("/dev/zero")
    with pytest.raises(DataError, match="is not a regular file"):
        load_run(path)


def test_a_journal_that_its_recorder_removes_meanwhile_is_no_fault(path, monkeypatch):
    """A run is looked at while it starts: the journal is there at the first look and gone at the next."""
    journal = path.with_name(path.name + "-journal")
    journal.write_bytes(b"begun")
    look = Path.lstat

    def and_gone(self):
        found = look(self)
        if self == journal:
            journal.unlink()
        return found

    monkeypatch.setattr(Path, "lstat", and_gone)
    assert len(load_run(path)["t_s"])
    assert not journal.exists()


@pytest.mark.parametrize("log", [False, True])
def test_a_file_with_much_behind_its_database_is_refused(path, log):
    """Its hash would take hours."""
    if log:
        data = bytearray(path.read_bytes())
        data[18] = data[19] = 2  # write-ahead log
        path.write_bytes(data)
        path.with_name(path.name + "-wal").write_bytes(b"x" * 40)
    os.truncate(path, 300_000_000_000)
    with pytest.raises(DataError, match="its database ends after|are needed in"):
        load_run(path)


def test_a_copy_that_would_fill_the_disk_is_not_made(path, monkeypatch):
    path.with_name(path.name + "-journal").write_bytes(journal_of_a_page(path.read_bytes()))
    assert len(load_run(path)) == 100
    usage = shutil.disk_usage(path)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: usage._replace(free=100))
    with pytest.raises(DataError, match="was left open. To read it, 0 MB are needed"):
        load_run(path)
