"""Files of one channel each that share a clock, as oscilloscopes write them: they are one record of all channels."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import numpy as np

from smarig.core import atomic_file
from smarig.exchange import FoundColumn, FoundTable, find_tables
from smarig.study import quantity_words as q
from smarig.study.column_guess import guess_columns

JOINED = "joined.txt"


@dataclass(frozen=True, eq=False)
class JoinedChannels:
    """The tables of a study, and a sentence if files were joined to one record, "" otherwise."""

    tables: list[FoundTable]
    sentence: str = ""


def joined_channels(tables: Sequence[FoundTable], folder: Path | None) -> JoinedChannels:
    """The tables; those of several files with equal clocks and other names of their channels as one, which is written
    to the folder of the study.
    """
    if folder is None or len(tables) < 2 or len({table.path for table in tables}) < len(tables):
        return JoinedChannels(list(tables))
    clocks = [_clock(table) for table in tables]
    if not all(map(_share_a_clock, *zip(*combinations(clocks, 2), strict=True))):
        return JoinedChannels(list(tables))
    channels = [[c for c in table.columns if c is not clock] for table, clock in zip(tables, clocks)]
    names = {c.name for each in channels for c in each}
    if clocks[0] is None or any(len(each) != 1 for each in channels) or len(names) < len(tables):
        return JoinedChannels(list(tables))
    path = _written(folder / JOINED, [clocks[0], *(c for each in channels for c in each)])
    files = ", ".join(table.path.name for table in tables)
    sentence = (
        f"{files} have equal clocks, so they are channels of one record, which is written to {path.name}."
    )
    return JoinedChannels(find_tables(path), sentence)


def _clock(table: FoundTable) -> FoundColumn | None:
    """The column of times that rises from row to row."""
    guesses = guess_columns(table, {}) if table.columns and table.format == "csv" else []
    rising = [g.name for g in guesses if g.quantity == q.TIME and g.facts.rising and not g.facts.missing]
    return next((c for c in table.columns if c.name in rising[:1]), None)


def _share_a_clock(a: FoundColumn | None, b: FoundColumn | None) -> bool:
    return a is not None and b is not None and a.unit == b.unit and np.array_equal(a.values, b.values)


def _written(path: Path, columns: Sequence[FoundColumn]) -> Path:
    names = [f"{c.name} [{c.unit}]" if c.unit else c.name for c in columns]
    rows = zip(*(c.values.tolist() for c in columns), strict=True)
    path.parent.mkdir(parents=True, exist_ok=True)
    with atomic_file(path, force=True) as part:
        lines = ["\t".join(names), *("\t".join(map(repr, row)) for row in rows)]
        part.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path
