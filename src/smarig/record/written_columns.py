"""Writes columns into the table of samples, block by block: arrays are never in memory as Python numbers."""

import sqlite3
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from smarig.record.schema import SAMPLE_COLUMNS

BLOCK_ROWS = 10_000
_EXACT = 2.0**53  # smaller whole numbers are exact as floats
_WHOLE = ("tick", "step", "counts", "quality")  # integers in the file


def insert_columns(db: sqlite3.Connection, columns: Mapping[str, Any]) -> None:
    """Insert columns under names of SAMPLE_COLUMNS, which are sequences of one length; absent ones are NULL.

    Without quality, all samples are good. Raises ValueError if a column has another length than ``tick``.
    """
    n = len(columns["tick"])
    given = {name: _sequence(columns[name], n) for name in SAMPLE_COLUMNS if columns.get(name) is not None}
    places = ",".join("?" * len(given))
    for a in range(0, n, BLOCK_ROWS):
        block = [_cells(name, values[a : a + BLOCK_ROWS]) for name, values in given.items()]
        rows: Iterator[tuple] = zip(*block, strict=True)
        db.executemany(f"INSERT INTO sample ({','.join(given)}) VALUES ({places})", rows)


def _sequence(column: Any, n: int) -> Sequence[Any] | np.ndarray:
    values = column if isinstance(column, np.ndarray) else list(column)
    if len(values) != n:
        raise ValueError(f"a column has {len(values)} values, but there are {n} ticks")
    return values


def _cells(name: str, values: Sequence[Any] | np.ndarray) -> Sequence[Any]:
    if not isinstance(values, np.ndarray):
        return values
    if name not in _WHOLE or values.dtype.kind != "f":
        return values.tolist()  # SQLite stores NaN as NULL
    if (np.abs(values) < _EXACT).all():
        return values.astype(np.int64).tolist()
    return [None if v != v else int(v) for v in values.tolist()]
