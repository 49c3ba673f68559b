"""Hashes of the tables of a closed run: a cell that changes afterwards is noticed when the run is read.

Each block of rows has its own hash, so damage is found to within a block. A row is hashed as SQLite returns it: NULL,
integer, real and text of the same value differ, and so do the same rows in another order.

The bytes are those of ``marshal``, version 2, which has not changed since Python 2.5 and takes a tenth of the time of
any other encoding: a row is "(", its number of cells (4 bytes, the least significant first, as everywhere), its
cells. A cell is "N" for NULL; "i" and 4 bytes for an integer of 32 bits; "g" and the 8 bytes of a real; "u", the
number of bytes (4 bytes) and UTF-8 for a text. "l", the number of digits (4 bytes, negative as the integer) and
digits of 15 bits (2 bytes each) stand for larger integers.
"""

import hashlib
import marshal
import sqlite3
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Any

from smarig.record import schema

KEY = "hashes"  # of table run
BLOCK_ROWS = 1000
_HEX_DIGITS = 16  # 64 bits: chance makes no other block with the same hash
_FIRST_TICK = -(2**63)
_UNKNOWN = 2**63
_OF_OTHER_TABLES = (schema.INSERT_STEP, schema.INSERT_EVENT, schema.UPSERT_KEY)
_LIST_HEAD = 5  # bytes of marshal before the rows of a list


@dataclass(frozen=True)
class DamagedRows:
    """Rows of a table, counted from 0 in the order of reading, of which at least one is not what was stored."""

    table: str
    first: int
    last: int


def block_hashes(rows: Iterable[tuple], progress: Callable[[], object] = lambda: None) -> list[str]:
    """The hash of each block of rows; ``progress`` is called after each."""
    return [_hashed(block, progress) for block in _blocks(rows)]


def _blocks(rows: Iterable[tuple]) -> Iterator[list[tuple]]:
    source = iter(rows)
    while block := list(islice(source, BLOCK_ROWS)):
        yield block


def _hashed(block: list[tuple], progress: Callable[[], object]) -> str:
    digest = hashlib.sha256(memoryview(marshal.dumps(block, 2))[_LIST_HEAD:]).hexdigest()[:_HEX_DIGITS]
    progress()
    return digest


class SampleHashes:
    """Hashes of the samples of a run that is being written: one block at a time, so that closing has little left."""

    def __init__(self) -> None:
        self._hashes: list[str] = []
        self._next_tick = _FIRST_TICK
        self._waiting = _UNKNOWN  # rows that are not hashed: at least as many as there are

    def will_write(self, rows: Sequence[tuple], statements: Sequence[tuple[str, tuple]]) -> None:
        """Start again if these change samples that are hashed."""
        if any(sql not in _OF_OTHER_TABLES for sql, _ in statements) or any(
            not isinstance(row[0], int) or row[0] < self._next_tick for row in rows
        ):
            self._hashes, self._next_tick, self._waiting = [], _FIRST_TICK, _UNKNOWN
        self._waiting += len(rows)

    def hash_block(self, db: sqlite3.Connection) -> None:
        """Hash the next block, if it is full."""
        if self._waiting < BLOCK_ROWS:
            return
        rows = self._rows(db).fetchmany(BLOCK_ROWS)
        if len(rows) < BLOCK_ROWS:
            self._waiting = len(rows)
            return
        self._waiting -= BLOCK_ROWS
        self._hashes += block_hashes(rows)
        self._next_tick = rows[-1][0] + 1

    def finished(self, db: sqlite3.Connection, progress: Callable[[], object] = lambda: None) -> list[str]:
        """The hashes of all samples."""
        return self._hashes + block_hashes(self._rows(db), progress)

    def _rows(self, db: sqlite3.Connection) -> sqlite3.Cursor:
        return db.execute(schema.READ_SAMPLES_FROM, (self._next_tick,))


def hashes_of(
    db: sqlite3.Connection, progress: Callable[[], object] = lambda: None, samples: SampleHashes | None = None
) -> dict[str, list[str]]:
    """The hashes of all tables, as they are read, without the key that holds the hashes."""
    hashes = {
        table: block_hashes(row for row in db.execute(query) if table != "run" or row[0] != KEY)
        for table, query in schema.READ.items()
        if table != "sample"
    }
    return hashes | {"sample": (samples or SampleHashes()).finished(db, progress)}


def damaged_rows(meta: Mapping[str, Any], tables: Mapping[str, Iterable[tuple]]) -> list[DamagedRows]:
    """What is not as it was when the run was closed; empty for a run without hashes (open, or of an older smarig)."""
    if not is_hashed(meta):
        return []
    stored = meta.get(KEY)
    if not isinstance(stored, dict):
        return [DamagedRows("run", 0, 0)]
    without_key = {**tables, "run": [row for row in tables["run"] if row[0] != KEY]}
    return [d for table, rows in without_key.items() for d in _compared(table, stored.get(table), rows)]


def is_hashed(meta: Mapping[str, Any]) -> bool:
    """Whether hashes were stored when the run was closed, even if they are lost."""
    end = meta.get("end")
    return KEY in meta or (isinstance(end, dict) and end.get("hashed") is True)


def _compared(table: str, stored: Any, rows: Iterable[tuple]) -> Iterator[DamagedRows]:
    found = block_hashes(rows)
    before = stored if isinstance(stored, list) else []
    for k in range(max(len(found), len(before))):
        if found[k : k + 1] != before[k : k + 1]:
            yield DamagedRows(table, k * BLOCK_ROWS, (k + 1) * BLOCK_ROWS - 1)
