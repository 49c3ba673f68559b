"""One record at several loads, each held for whole cycles: a table for each load."""

from dataclasses import replace

import numpy as np

from smarig.exchange import FoundTable
from smarig.study import quantity_words as q
from smarig.study.column_guess import ColumnGuess
from smarig.study.held_quantities import held_levels, holds_still
from smarig.study.row_parts import table_of_rows
from smarig.study.table_guess import guess_table

_FORC = "forc"


def tables_of_loads(table: FoundTable, drive: str | None = None, out: str | None = None) -> list[FoundTable]:
    """The table, or one for each stretch in which its force, stress, field or temperature is held for a cycle of the
    input or more.

    ``drive`` and ``out`` are columns that the user names.
    """
    if table.format == _FORC or not len(table):
        return [table]
    guess = guess_table(table, input=drive, output=out)
    target, used = guess.first("input"), (*guess.of_role("input"), *guess.of_role("output"))
    signals = {c.quantity for c in used}
    loads = [c for c in guess.columns if c.quantity in q.HELD and c not in used and not c.by_numbers]
    loads = [c for c in loads if c.quantity != q.TEMPERATURE or c.quantity not in signals]
    if target is None or any(holds_still(load) for load in loads):
        return [table]
    for load in loads:
        if parts := held_levels(load, target):
            return [_part(table, load, part, number) for number, part in enumerate(parts, 1)]
    return [table]


def _part(table: FoundTable, load: ColumnGuess, part: slice, number: int) -> FoundTable:
    """The rows as a table whose mapping selects them."""
    level = float(np.nanmedian(load.facts.values[part]))
    title = f"{table.name} {float(f'{level:.3g}'):g} {load.unit}".strip()
    return replace(table_of_rows(table, part), name=f"{title} part {number}")
