"""Rows of a table that hold no reading: every channel reads exactly 0 there, far from the rows around them.

Instruments write such a row where a segment begins, as TA does with -2 for the time, and loggers where a device does
not answer. Clocks and counters, which go on or hold a mark, are no channels.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.exchange.checks.dropped_readings import drops
from smarig.exchange.tables.text_table import Table

_FEWEST = 2  # channels that drop out together: one alone is a fault of its own


def without_lost_rows(table: Table) -> Table:
    """The table without the rows that hold no reading, and a finding that counts them."""
    lost = lost_rows(table.columns)
    if not lost.any():
        return table
    kept = ~lost
    number = int(lost.sum())
    note = (
        f"{number} {'rows hold' if number > 1 else 'row holds'} no reading: every channel reads exactly 0 there, far "
        f"from the rows around them (first: line {table.line[lost][0]}). They are left out."
    )
    return replace(
        table,
        columns={name: x[kept] for name, x in table.columns.items()},
        line=table.line[kept],
        notes=(*table.notes, note),
        loop=None if table.loop is None else table.loop[kept],
    )


def lost_rows(columns: Mapping[str, Array]) -> NDArray[np.bool_]:
    """Mask of the rows (n,) that hold no reading.

    >>> x = np.linspace(20.0, 30.0, 11)
    >>> x[[0, 4]] = 0
    >>> lost_rows({"t": np.where(x == 0, -2, np.arange(11.0)), "T": x, "F": 3 * x}).nonzero()[0].tolist()
    [0, 4]
    """
    every = list(columns.values())
    zeros = np.sum([x == 0 for x in every], axis=0) if every else np.zeros(0)
    able = zeros >= _FEWEST
    if not able.any() or able.all():
        return np.zeros(zeros.size, dtype=bool)
    others = every[1:]  # a mark may stand in the first
    dropped = np.array([drops(x) for x in others])
    spared = np.array([np.isnan(x) | _only_rises(x[~able]) for x in others])
    far = (dropped.sum(axis=0) >= _FEWEST) & (dropped | spared).all(axis=0)
    sure = able & far & _is_between(~able)
    return sure | _is_repeated(every, sure)


def _only_rises(x: Array) -> bool:
    """Whether a column never falls, as a clock, a counter or a constant does."""
    known = x[np.isfinite(x)]
    return bool((np.diff(known) >= 0).all())


def _is_between(kept: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Mask of the rows (n,) from the first to the last that is kept: a record may begin at 0."""
    rows = np.flatnonzero(kept)
    found = np.zeros(kept.size, dtype=bool)
    if rows.size:
        found[rows[0] : rows[-1] + 1] = True
    return found


def _is_repeated(every: list[Array], sure: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Mask of the rows (n,) that are equal to a row that holds no reading in every column: where a channel is near 0 as
    well, and at the ends, the mark tells it.
    """
    found = np.zeros(sure.size, dtype=bool)
    for row in np.unique(np.array([x[sure] for x in every]).T, axis=0):
        found |= np.all([x == value for x, value in zip(every, row)], axis=0)
    return found
