"""Blocks of one text that are one record, as the steps of a program of ramps: their clock or their input goes on."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from smarig.exchange import FoundColumn, FoundTable
from smarig.study.column_guess import ColumnGuess
from smarig.study.row_parts import table_of_rows
from smarig.study.table_guess import TableGuess, guess_table

FEWEST_ROWS = 3  # by which columns are guessed


def joined_blocks(tables: Sequence[FoundTable]) -> list[FoundTable]:
    """The tables of a file in order; neighbours with equal names and units that go on are joined to one, and a table
    is divided at lines of text where it does not go on.
    """
    if len(tables) == 1:
        return _divided(tables[0])
    if not all("header_starts" in table.layout.get("file", {}) for table in tables):
        return list(tables)
    guesses = [guess_table(table) for table in tables]
    records: list[list[TableGuess]] = [guesses[:1]]
    for before, after in pairwise(guesses):
        if _goes_on(before, after) or _restarts(before, after):
            records[-1].append(after)
        else:
            records.append([after])
    last = _number(tables[-1])
    found = [_joined([guess.table for guess in parts], last) for parts in records]
    return [replace(found[0], name="")] if len(found) == 1 else found


def _divided(table: FoundTable) -> list[FoundTable]:
    """The records of a table: another begins below a line of text where neither its clock nor its input goes on."""
    edges = [0, *table.breaks, len(table)]
    parts = [(a, b) for a, b in pairwise(edges) if b - a >= FEWEST_ROWS]
    guesses = [guess_table(table_of_rows(table, slice(a, b))) for a, b in parts]
    starts = [
        a
        for (before, after), (a, _) in zip(pairwise(guesses), parts[1:])
        if not (_goes_on(before, after) or _restarts(before, after))
    ]
    if not starts:
        return [table]
    records = [slice(a, b) for a, b in pairwise([0, *starts, len(table)])]
    return [replace(table_of_rows(table, rows), name=f"part {k}") for k, rows in enumerate(records, 1)]


def _restarts(before: TableGuess, after: TableGuess) -> bool:
    """Whether the clock starts again, but a branch starts where the one before ended."""
    if _written(before.table) != _written(after.table):
        return False
    return not _other_load(before, after) and _branch_goes_on(before, after)


def _goes_on(before: TableGuess, after: TableGuess) -> bool:
    """Whether a block continues the one before: by its clock; without one, a branch that starts where the one before
    ended. Blocks at another load are records of their own, and so are closed loops.
    """
    if _written(before.table) != _written(after.table) or _other_load(before, after):
        return False
    clocks = before.first("time"), after.first("time")
    if clocks[0] is not None and clocks[1] is not None:
        a, b = (clock.facts for clock in clocks if clock is not None)
        return a.name == b.name and "clock" not in (a.kind, b.kind) and bool(b.known[0] > a.known[-1])
    return clocks == (None, None) and _branch_goes_on(before, after)


def _branch_goes_on(before: TableGuess, after: TableGuess) -> bool:
    """Whether both blocks are single branches of one input, and the second starts where the first ended."""
    ends = before.first("input"), after.first("input")
    if ends[0] is None or ends[1] is None or ends[0].name != ends[1].name:
        return False
    return _one_way(ends[0]) and _one_way(ends[1]) and _starts_at_end(ends[0], ends[1])


def _written(table: FoundTable) -> list[tuple[str, str, str]]:
    kinds = [column.kind if np.isfinite(column.values).any() else "" for column in table.columns]
    return [(column.name, column.unit, kind) for column, kind in zip(table.columns, kinds)]


def _other_load(before: TableGuess, after: TableGuess) -> bool:
    """Whether a load that was held in both blocks has no value in common."""
    later = {c.name: c.facts for c in after.of_role("condition")}
    held = [(c.facts, later[c.name]) for c in before.of_role("condition") if c.name in later]
    return any(a.low > b.high or b.low > a.high for a, b in held)


def _one_way(drive: ColumnGuess) -> bool:
    """Whether an input travels no further than from its first to its last value, but for steps back of noise."""
    x = drive.facts.known
    return bool(abs(x[-1] - x[0]) >= drive.facts.span - 2 * drive.facts.step > 0)


def _starts_at_end(before: ColumnGuess, after: ColumnGuess) -> bool:
    steps = np.abs(np.diff(before.facts.known)).max(), np.abs(np.diff(after.facts.known)).max()
    return bool(abs(after.facts.known[0] - before.facts.known[-1]) <= max(steps))


def _number(table: FoundTable) -> int:
    """The number of a block among those with its header, from 1."""
    return int(table.layout["file"]["table"])


def _joined(parts: Sequence[FoundTable], last: int) -> FoundTable:
    """The blocks as one table; its layout has their number, 0 for all up to the ``last`` of the file."""
    if len(parts) == 1:
        return parts[0]
    columns = tuple(
        FoundColumn(same[0].name, same[0].unit, np.concatenate([c.values for c in same]), same[0].kind)
        for same in zip(*(part.columns for part in parts), strict=True)
    )
    first, end = _number(parts[0]), _number(parts[-1])
    entries = parts[0].layout["file"] | {"tables": 0 if end == last else end - first + 1}
    return replace(parts[0], columns=columns, layout={**parts[0].layout, "file": entries})
