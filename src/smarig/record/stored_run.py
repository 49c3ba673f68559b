"""A run whose samples stay in its file: its columns are read when they are used, one by one or in blocks.

For whatever needs the description or passes over the samples once: a run of a day takes a few megabytes.
"""

import contextlib
import sqlite3
from collections.abc import Iterator, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

from smarig.core import Array
from smarig.record.any_run import BLOCK_ROWS, AnyRun
from smarig.record.opened_run import opened_for_reading
from smarig.record.run import (
    Event,
    Step,
    check_column,
    existing_file,
    read_description,
    reading,
    refuse_damage,
)
from smarig.record.sample_columns import LARGEST, READ_ROWS, column_blocks, read_columns, row_blocks
from smarig.record.schema import SAMPLE_COLUMNS
from smarig.record.table_hashes import block_hash, is_hashed


class StoredRun(AnyRun):
    """A run in its open file, as it was when it was opened; ``with stored_run(path) as run``."""

    def __init__(self, path: Path, db: sqlite3.Connection) -> None:
        self.path, self._db = path, db
        self.meta: dict[str, Any]
        self.steps: tuple[Step, ...]
        self.events: tuple[Event, ...]
        with reading(path):
            db.execute("BEGIN")  # whatever is read is of one moment, also while the run is recorded
            self.meta, self.steps, self.events = read_description(path, db)

    def verify(self) -> None:
        """Raise DataError if a sample is not as it was when the run was closed."""
        if is_hashed(self.meta):
            with reading(self.path):
                hashes = [block_hash(b) for b in row_blocks(self._db, SAMPLE_COLUMNS, READ_ROWS)]
            refuse_damage(self.path, self.meta, {"sample": hashes})

    def __getitem__(self, name: str) -> Array:
        check_column(name)
        with reading(self.path):
            return read_columns(self._db, [name])[name]

    @cached_property
    def _size(self) -> int:
        return self._rows("SELECT count(*) FROM sample")[0][0]

    def __len__(self) -> int:
        return self._size

    def has(self, name: str) -> bool:
        """Whether a channel was measured."""
        check_column(name)
        return bool(self._rows(f"SELECT 1 FROM sample WHERE {_finite(name)} LIMIT 1"))

    def blocks(self, names: Sequence[str], rows: int = BLOCK_ROWS) -> Iterator[dict[str, Array]]:
        """The named columns in blocks of that many rows, in order."""
        for name in names:
            check_column(name)
        with reading(self.path):
            yield from column_blocks(self._db, names, rows)

    def extremes(self, name: str) -> tuple[float, float] | None:
        """The smallest and the largest value of a channel; None if it was not measured."""
        check_column(name)
        low, high = self._rows(f"SELECT min({name}), max({name}) FROM sample WHERE {_finite(name)}")[0]
        return None if low is None else (float(low), float(high))

    def marked(self, *marks: int) -> tuple[int, ...]:
        """The number of samples with each of these quality marks."""
        sums = ", ".join(f"total((quality & {int(mark)}) != 0)" for mark in marks)
        return tuple(map(int, self._rows(f"SELECT {sums} FROM sample")[0]))

    @property
    def span_s(self) -> float:
        """Time from the first to the last sample that has one; 0 if none has."""
        query = f"SELECT t_s FROM sample WHERE {_finite('t_s')} ORDER BY tick"
        ends = [self._rows(f"{query} {order} LIMIT 1") for order in ("", "DESC")]
        return float(ends[1][0][0] - ends[0][0][0]) if ends[0] else 0.0

    @cached_property
    def first_sample(self) -> tuple[int, float | None] | None:
        """Tick and time of the first sample; None without samples."""
        found = self._rows("SELECT tick, t_s FROM sample ORDER BY tick LIMIT 1")
        return None if not found else (int(found[0][0]), None if found[0][1] is None else float(found[0][1]))

    def _rows(self, query: str) -> list[tuple]:
        with reading(self.path):
            return self._db.execute(query).fetchall()


def _finite(name: str) -> str:
    """The SQL condition that a cell of a column is a number that is read as one."""
    return f"{name} BETWEEN {-LARGEST!r} AND {LARGEST!r}"


@contextlib.contextmanager
def stored_run(path: str | Path, *, verify: bool = True) -> Iterator[StoredRun]:
    """Open a run file, finished, running or interrupted, and close it after the block.

    Raises DataError if it is not one or was changed, and whenever its samples turn out not to be numbers. Without
    ``verify``, the samples are not compared with their hashes: for runs that were just written or read before.
    """
    file = existing_file(path)
    with contextlib.ExitStack() as opened:
        with reading(file):
            db = opened.enter_context(opened_for_reading(file))
        run = StoredRun(file, db)
        if verify:
            run.verify()
        yield run
