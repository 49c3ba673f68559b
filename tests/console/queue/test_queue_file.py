"""The file of a queue: damaged, of a later version, of another program, and on a full disk."""

import sqlite3
from contextlib import closing

import pytest

from console.queue.entries import opened, request
from smarig.console.queue.queue_file import QueueFile
from smarig.core import DataError, InUse, StorageError, UsageError


@pytest.fixture
def file(tmp_path):
    with opened(tmp_path) as queue:
        queue.add(request("a"))
    return tmp_path / "queue.sqlite"


def change(file, *statements):
    with closing(sqlite3.connect(file, isolation_level=None)) as db:
        for statement in statements:
            db.execute(statement)


def test_a_later_version_is_refused(file, tmp_path):
    change(file, "PRAGMA user_version = 2")
    before = file.read_bytes()
    with pytest.raises(
        UsageError, match="has version 2, and this smarig knows versions up to 1. Update smarig.$"
    ):
        opened(tmp_path)
    assert file.read_bytes() == before


@pytest.mark.parametrize(
    "damage",
    [
        lambda data: b"not a database".ljust(len(data)),
        lambda data: data[:100] + b"\xff" * (len(data) - 100),
        lambda data: data[: len(data) // 2],
    ],
    ids=["other bytes", "pages", "cut"],
)
def test_damage_is_one_sentence_and_the_file_is_left(file, tmp_path, damage):
    damaged = damage(file.read_bytes())
    file.write_bytes(damaged)
    with pytest.raises(DataError, match=r"queue.sqlite is damaged \(.*\). Move it elsewhere"):
        opened(tmp_path)
    assert file.read_bytes() == damaged


def test_damage_of_a_page_that_opening_does_not_need_is_found(file, tmp_path):
    with opened(tmp_path) as queue:
        for k in range(50):
            queue.add(request(f"r{k}", notes="n" * 500))
    data = bytearray(file.read_bytes())
    data[-3000:] = b"\xff" * 3000
    file.write_bytes(data)
    with pytest.raises(DataError, match="is damaged"):
        opened(tmp_path)


@pytest.mark.parametrize(
    "text", ["{", "[]", "{}", '{"kind": "protocol"}', '{"kind": "x", "effects": []}', "null"]
)
def test_damaged_arguments_are_one_sentence(file, tmp_path, text):
    change(file, f"UPDATE entry SET request = '{text}'")
    with opened(tmp_path) as queue, pytest.raises(DataError, match="arguments .* of a queue are damaged"):
        queue.entries()


def test_a_damaged_value_of_the_queue_is_one_sentence(file, tmp_path):
    change(file, "INSERT INTO queue VALUES ('paused', 'no json')")
    with opened(tmp_path) as queue, pytest.raises(DataError, match="'paused' cannot be read"):
        queue.state()


def test_a_state_that_does_not_exist_cannot_be_stored(file):
    with pytest.raises(sqlite3.IntegrityError):
        change(file, "UPDATE entry SET state = 'lost'")


def test_the_database_of_another_program_is_left(tmp_path):
    change(tmp_path / "queue.sqlite", "CREATE TABLE addresses (name TEXT)")
    with pytest.raises(DataError, match="is an SQLite database, but no queue of smarig"):
        opened(tmp_path)


def test_a_full_disk_changes_nothing_and_later_there_is_room(file, tmp_path):
    with opened(tmp_path) as queue:
        db = queue._file._db
        pages = db.execute("PRAGMA page_count").fetchone()[0]
        db.execute(f"PRAGMA max_page_count = {pages}")
        with pytest.raises(StorageError, match="queue.sqlite cannot be read or written: .*full"):
            queue.add(request("b", notes="n" * 40_000))
        assert [entry.id for entry in queue.entries()] == [1]
        db.execute(f"PRAGMA max_page_count = {pages + 100}")
        queue.add(request("b", notes="n" * 40_000))
        assert len(queue.entries()) == 2


def test_a_file_that_another_process_keeps_busy_is_one_sentence(file, tmp_path):
    with closing(sqlite3.connect(file, isolation_level=None)) as other, QueueFile(tmp_path) as mine:
        mine._db.execute("PRAGMA busy_timeout = 50")
        other.execute("BEGIN IMMEDIATE")
        with pytest.raises(InUse, match="is being changed by another process"):
            mine.set(paused=None)
        assert mine.entries  # reading goes on
        assert mine.get("paused") is None


def test_it_is_stored_as_power_cuts_need_it(file, tmp_path):
    with QueueFile(tmp_path) as mine:
        assert mine._pragma("journal_mode") == "wal"
        assert mine._pragma("synchronous") == 2  # FULL
