"""Hashes the samples of a run while it is recorded, block by block, so that closing has little left to do."""

import sqlite3
from collections.abc import Callable, Sequence

from smarig.record import schema
from smarig.record.table_hashes import BLOCK_ROWS, block_hash, blocks

_BEFORE_ALL_TICKS = -(2**63)
_UNKNOWN = 2**63
_OF_OTHER_TABLES = (schema.INSERT_STEP, schema.SUSPECT_STEPS, schema.INSERT_EVENT, schema.UPSERT_KEY)


class SampleHashes:
    """``hashes`` of the blocks in the order of ticks; ``ticks`` are the first of each, and the last of all."""

    def __init__(self) -> None:
        self._start_again()

    def _start_again(self) -> None:
        self.hashes: list[str] = []
        self.ticks: list[int] = []
        self._last_tick = _BEFORE_ALL_TICKS
        self._waiting = _UNKNOWN  # rows that are not hashed: at least as many as there are

    def will_write(self, rows: Sequence[tuple], statements: Sequence[tuple[str, tuple]]) -> None:
        """Start again if these change samples that are hashed."""
        if any(sql not in _OF_OTHER_TABLES for sql, _ in statements) or any(
            not isinstance(row[0], int) or row[0] <= self._last_tick for row in rows
        ):
            self._start_again()
        self._waiting += len(rows)

    def hash_block(self, db: sqlite3.Connection) -> None:
        """Hash the next block, if it is full."""
        if self._waiting < BLOCK_ROWS:
            return
        rows = self._rows(db).fetchmany(BLOCK_ROWS)
        if len(rows) < BLOCK_ROWS:
            self._waiting = len(rows)
        else:
            self._add(rows)

    def hash_rest(self, db: sqlite3.Connection, progress: Callable[[], object] = lambda: None) -> None:
        """Hash everything that is left; the last of all calls."""
        for block in blocks(self._rows(db)):
            self._add(block)
            progress()
        if self.ticks:
            self.ticks.append(self._last_tick)

    def _add(self, block: list[tuple]) -> None:
        self._waiting -= len(block)
        self.hashes.append(block_hash(block))
        self.ticks.append(block[0][0])
        self._last_tick = block[-1][0]

    def _rows(self, db: sqlite3.Connection) -> sqlite3.Cursor:
        return db.execute(schema.READ_SAMPLES_AFTER, (self._last_tick,))
