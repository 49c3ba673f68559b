"""Reads the table of samples into columns of floats, block by block, so that the rows are never all in memory."""

import sqlite3
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from smarig.core import Array
from smarig.record.schema import SAMPLE_COLUMNS
from smarig.record.table_hashes import BLOCK_ROWS

LARGEST = 1e30  # in any unit: nothing measured is larger, and the square of a larger number may overflow
_STEP_NUMBERS = ("target", "t_start_s", "t_end_s", "position")
READ_ROWS = BLOCK_ROWS  # rows of Python objects at a time, as they are hashed: larger blocks are slower


def read_columns(
    db: sqlite3.Connection,
    names: Sequence[str] = SAMPLE_COLUMNS,
    seen: Callable[[list[tuple]], object] = len,
    rows: int = READ_ROWS,
) -> dict[str, Array]:
    """The columns (n,) of all samples, NaN where NULL or over ``LARGEST``.

    ``seen`` is called with the rows of each block as stored.

    Raises ValueError or TypeError if a cell is no number.
    """
    (n,) = db.execute("SELECT count(*) FROM sample").fetchone()
    data = np.empty((len(names), n))
    filled = 0
    for block in row_blocks(db, names, rows):
        seen(block)
        if filled + len(block) > data.shape[1]:  # a run that is being recorded
            data = np.pad(data[:, :filled], ((0, 0), (0, filled // 4 + len(block))))
        _fill(data[:, filled : filled + len(block)], block)
        filled += len(block)
    return {name: data[k, :filled] for k, name in enumerate(names)}


def column_blocks(db: sqlite3.Connection, names: Sequence[str], rows: int) -> Iterator[dict[str, Array]]:
    """The same columns in blocks of that many rows, each in arrays of its own."""
    pieces: list[Array] = []
    filled = 0
    for block in row_blocks(db, names, min(rows, READ_ROWS)):
        while block:
            taken, block = block[: rows - filled], block[rows - filled :]
            pieces.append(np.empty((len(names), len(taken))))
            _fill(pieces[-1], taken)
            filled += len(taken)
            if filled == rows:
                yield _joined(names, pieces)
                pieces, filled = [], 0
    if pieces:
        yield _joined(names, pieces)


def row_blocks(db: sqlite3.Connection, names: Sequence[str], rows: int) -> Iterator[list[tuple]]:
    """Rows of samples in the order of their ticks, as SQLite returns them."""
    found = db.execute(f"SELECT {','.join(names)} FROM sample ORDER BY tick")
    while block := found.fetchmany(rows):
        yield block


def _fill(columns: Array, rows: list[tuple]) -> None:
    for column, cells in zip(columns, zip(*rows, strict=True), strict=True):
        numbers = np.array(cells, dtype=float)  # None becomes NaN
        column[:] = np.where(np.abs(numbers) <= LARGEST, numbers, np.nan)


def count_unmeasurable(db: sqlite3.Connection) -> int:
    """The number of samples and steps with a number over ``LARGEST``, which is read as missing."""
    count = 0
    for table, names in (("sample", SAMPLE_COLUMNS), ("step", _STEP_NUMBERS)):
        tests = (f'"{name}" > {LARGEST} OR "{name}" < -{LARGEST}' for name in names)
        count += db.execute(f"SELECT count(*) FROM {table} WHERE {' OR '.join(tests)}").fetchone()[0]
    return count


def _joined(names: Sequence[str], pieces: list[Array]) -> dict[str, Array]:
    whole = pieces[0] if len(pieces) == 1 else np.concatenate(pieces, axis=1)
    return {name: whole[k] for k, name in enumerate(names)}
