"""Blocks of one text that are one record, as the steps of a program of ramps: their clock or their input goes on."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from smarig.exchange import FoundColumn, FoundTable
from smarig.study.column_guess import ColumnGuess
from smarig.study.table_guess import TableGuess, guess_table


def joined_blocks(tables: Sequence[FoundTable]) -> list[FoundTable]:
    """The tables of a file in order; neighbours with equal names and units that go on are joined to one."""
    if len(tables) < 2 or not all("header_starts" in table.layout.get("file", {}) for table in tables):
        return list(tables)
    guesses = [guess_table(table) for table in tables]
    records: list[list[TableGuess]] = [guesses[:1]]
    for before, after in pairwise(guesses):
        if _goes_on(before, after):
            records[-1].append(after)
        else:
            records.append([after])
    last = _number(tables[-1])
    found = [_joined([guess.table for guess in parts], last) for parts in records]
    return [replace(found[0], name="")] if len(found) == 1 else found


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
    ends = before.first("input"), after.first("input")
    if clocks != (None, None) or ends[0] is None or ends[1] is None or ends[0].name != ends[1].name:
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
