"""Run files whose database is not what it seems: views, triggers, virtual tables, damaged pages, other things."""

import contextlib
import os
import shutil
import sqlite3
import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np

from hostile.journals import journal_that_names
from hostile.material import Material

Maker = Callable[[Material, Path], None]
_FOREVER = "WITH RECURSIVE r(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM r)"


def later(maker: Callable[[], Maker]) -> Maker:
    """What is large is made when it is asked for: in every worker, the corpus held hundreds of megabytes."""
    return lambda material, path: maker()(material, path)


def sql(*statements: str) -> Maker:
    """A killed run after these statements."""

    def make(m: Material, path: Path) -> None:
        shutil.copy(m.killed, path)
        with contextlib.closing(sqlite3.connect(path, isolation_level=None)) as db:
            db.execute("PRAGMA legacy_alter_table = ON")
            db.execute("PRAGMA writable_schema = ON")
            for statement in statements:
                db.execute(statement)

    return make


def endless_view(table: str, columns: int) -> Maker:
    """A view in place of a table, whose rows never end."""
    row = ", ".join(["x"] * columns)
    return sql(f"DROP TABLE {table}", f"CREATE VIEW {table} AS {_FOREVER} SELECT {row} FROM r")


def counted_view(table: str, names: str) -> Maker:
    """A view that never yields a row and never ends."""
    columns = ", ".join(f'x AS "{n}"' for n in names.split())
    return sql(
        f"DROP TABLE {table}", f"CREATE VIEW {table} AS {_FOREVER} SELECT {columns} FROM r WHERE x < 0"
    )


def with_bytes(change: Callable[[bytearray], object]) -> Maker:
    """A killed run with changed bytes."""

    def make(m: Material, path: Path) -> None:
        data = bytearray(m.killed.read_bytes())
        change(data)
        path.write_bytes(data)

    return make


def random_pages(seed: int) -> Maker:
    """Three pages of noise."""

    def change(data: bytearray) -> None:
        dice = np.random.default_rng(seed)
        for page in dice.integers(1, len(data) // 4096, 3):
            data[page * 4096 : page * 4096 + 4096] = dice.bytes(4096)

    return with_bytes(change)


def page_cycle(data: bytearray) -> None:
    """An interior page of a table whose last child is itself."""
    for begin in range(4096, len(data), 4096):
        if data[begin] == 5:
            data[begin + 8 : begin + 12] = struct.pack(">I", begin // 4096 + 1)


def content(data: bytes) -> Maker:
    """A file of these bytes."""
    return lambda _, path: path.write_bytes(data)


def beside(suffix: str, data: bytes) -> Maker:
    """A run with a file of SQLite beside it."""

    def make(m: Material, path: Path) -> None:
        shutil.copy(m.killed, path)
        path.with_name(path.name + suffix).write_bytes(data)

    return make


def link_beside(suffix: str, target: str) -> Maker:
    """A damaged run with a link beside it, which a recovery would follow."""

    def make(m: Material, path: Path) -> None:
        data = bytearray(m.killed.read_bytes())
        data[18] = data[19] = 2  # write-ahead log
        path.write_bytes(data)
        path.with_name(path.name + suffix).symlink_to(target)

    return make


def deleting_journal(m: Material, path: Path) -> None:
    """A run whose journal belongs to a set: SQLite deletes the file that lists the set."""
    shutil.copy(m.killed, path)
    run = path.read_bytes()
    path.with_name(path.name + "-journal").write_bytes(journal_that_names(m.precious, run))


def large_tail(m: Material, path: Path) -> None:
    """A run with 300 GB of nothing behind it."""
    shutil.copy(m.killed, path)
    os.truncate(path, 300_000_000_000)


def pipe_beside(_: Material, path: Path) -> None:
    """A run with a pipe beside it, which nobody writes."""
    link_beside("-shm", "nowhere")(_, path)
    os.mkfifo(path.with_name(path.name + "-wal"))


def sparse(size: int) -> Maker:
    """A run with a log of many bytes that take no space."""

    def make(m: Material, path: Path) -> None:
        data = bytearray(m.killed.read_bytes())
        data[18] = data[19] = 2  # write-ahead log
        path.write_bytes(data)
        os.truncate(path, size)
        path.with_name(path.name + "-wal").write_bytes(b"x" * 40)

    return make


def other_database(_: Material, path: Path) -> None:
    """Somebody's albums."""
    with contextlib.closing(sqlite3.connect(path)) as db, db:
        db.execute("CREATE TABLE albums (title TEXT)")


STRUCTURES: dict[str, Maker] = {
    "endless sample": endless_view("sample", 12),
    "endless event": endless_view("event", 5),
    "endless step": endless_view("step", 10),
    "endless run": endless_view("run", 2),
    "no sample ever": counted_view(
        "sample",
        "tick t_s step current_command_A current_A voltage_V temperature_degC input counts position "
        "ambient_degC quality",
    ),
    "view of a real table": sql(
        "ALTER TABLE event RENAME TO other", "CREATE VIEW event AS SELECT * FROM other"
    ),
    "trigger empties": sql("CREATE TRIGGER t AFTER DELETE ON run BEGIN DELETE FROM sample; END"),
    "trigger without end": sql(
        f"CREATE TRIGGER t AFTER INSERT ON event BEGIN INSERT INTO step (branch) {_FOREVER} SELECT x FROM r; END"
    ),
    "trigger on another table": sql(
        "CREATE TABLE other (x)", "CREATE TRIGGER t AFTER INSERT ON other BEGIN DELETE FROM sample; END"
    ),
    "trigger redirects": sql(
        "ALTER TABLE event RENAME TO other",
        "CREATE VIEW event AS SELECT * FROM other",
        "CREATE TRIGGER t INSTEAD OF INSERT ON event BEGIN DELETE FROM sample; END",
    ),
    "generated column": sql(
        "DROP TABLE event",
        "CREATE TABLE event (t_s REAL, level TEXT, kind TEXT, text TEXT, "
        "data TEXT GENERATED ALWAYS AS (length(zeroblob(900000000))) VIRTUAL)",
        "INSERT INTO event (t_s) VALUES (0)",
    ),
    "virtual table": sql(
        "DROP TABLE event", "CREATE VIRTUAL TABLE event USING fts5(t_s, level, kind, text, data)"
    ),
    "foreign virtual table": sql("CREATE VIRTUAL TABLE other USING fts5(x)"),
    "statistics as samples": sql("DROP TABLE sample", "CREATE VIRTUAL TABLE sample USING dbstat"),
    "index on an expression": sql("CREATE INDEX i ON sample (abs(position + 1))"),
    "check that fails": sql(
        "DROP TABLE event",
        "CREATE TABLE event (t_s REAL, level TEXT, kind TEXT, text TEXT CHECK (length(text) < 0), data TEXT)",
    ),
    "default without end": sql(
        "DROP TABLE event",
        "CREATE TABLE event (t_s, level, kind, text, data DEFAULT (length(zeroblob(900000000))))",
    ),
    "foreign key": sql(
        "DROP TABLE event",
        "CREATE TABLE event (t_s REAL REFERENCES sample ON DELETE CASCADE, level, kind, text, data)",
    ),
    "unknown collation": sql(
        "UPDATE sqlite_master SET sql = replace(sql, 'level TEXT', 'level TEXT COLLATE x') WHERE name = 'event'"
    ),
    "other columns": sql("DROP TABLE step", 'CREATE TABLE step ("index", attempt)'),
    "more columns": sql("ALTER TABLE step ADD COLUMN more"),
    "no steps": sql("DROP TABLE step"),
    "no table": sql("DROP TABLE step", "DROP TABLE event", "DROP TABLE sample", "DROP TABLE run"),
    "table of nonsense": sql("UPDATE sqlite_master SET sql = 'CREATE TABLE event (' WHERE name = 'event'"),
    "two tables in one place": sql(
        "UPDATE sqlite_master SET rootpage = (SELECT rootpage FROM sqlite_master WHERE name = 'sample') "
        "WHERE name = 'event'"
    ),
    "table in the schema": sql("UPDATE sqlite_master SET rootpage = 1 WHERE name = 'event'"),
    "innocent table": sql("CREATE TABLE other (x)"),
    "pages in a circle": with_bytes(page_cycle),
    **{f"noise in pages {seed}": random_pages(seed) for seed in range(6)},
    "cut in half": with_bytes(lambda data: data.__delitem__(slice(len(data) // 2, None))),
    "a hundred bytes": with_bytes(lambda data: data.__delitem__(slice(100, None))),
    "page size 65536": with_bytes(lambda data: data.__setitem__(slice(16, 18), b"\x00\x01")),
    "other encoding": with_bytes(lambda data: data.__setitem__(slice(56, 60), b"\x00\x00\x00\x02")),
    "newer format": with_bytes(lambda data: data.__setitem__(slice(18, 20), b"\x09\x09")),
    "empty": content(b""),
    "text": content(b"time_s,current_A\n0,1\n" * 100),
    "noise": content(np.random.default_rng(1).bytes(20_000)),
    "compressed": content(b"\x1f\x8b" + bytes(1000)),
    "other database": other_database,
    "journal of noise": beside("-journal", np.random.default_rng(2).bytes(5000)),
    "journal that deletes": deleting_journal,
    "large tail": large_tail,
    "log of noise": beside("-wal", np.random.default_rng(3).bytes(5000)),
    "log without end": link_beside("-wal", "/dev/zero"),
    "journal without end": link_beside("-journal", "/dev/zero"),
    "log is a folder": link_beside("-wal", "/tmp"),
    "log is a pipe": pipe_beside,
    "very large": sparse(300_000_000_000),
    "folder": lambda _, path: path.mkdir(),
    "pipe": lambda _, path: os.mkfifo(path),
    "endless device": lambda _, path: path.symlink_to("/dev/zero"),
    "link to itself": lambda _, path: path.symlink_to(path.name),
}
