"""One record at several loads, each held for whole cycles: a table for each load."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from smarig.core import Array
from smarig.exchange import FoundTable
from smarig.measurement import noise_range
from smarig.study import quantity_words as q
from smarig.study.column_guess import ColumnGuess
from smarig.study.input_turns import wide_turns
from smarig.study.row_parts import table_of_rows
from smarig.study.signal_columns import holds_still
from smarig.study.table_guess import guess_table

_FEWEST_TURNS = 3  # with both ends: there and back
_FORC = "forc"


def tables_of_loads(table: FoundTable, drive: str | None = None, out: str | None = None) -> list[FoundTable]:
    """The table, or one for each stretch in which its force, stress or field is held for a cycle of the input or more.

    ``drive`` and ``out`` are columns that the user names.
    """
    if table.format == _FORC or len(table) < _FEWEST_TURNS:
        return [table]
    guess = guess_table(table, input=drive, output=out)
    target, used = guess.first("input"), (*guess.of_role("input"), *guess.of_role("output"))
    loads = [c for c in guess.columns if c.quantity in q.LOADS and c not in used and not c.by_numbers]
    if target is None or any(holds_still(load) for load in loads):
        return [table]
    for load in loads:
        parts = [part for part in _held_parts(load.facts.values) if _has_cycle(target, part)]
        if len(parts) > 1 and all(_is_held(table, load, part) for part in parts):
            return [_part(table, load, part, number) for number, part in enumerate(parts, 1)]
    return [table]


def _held_parts(load: Array) -> list[slice]:
    """The rows of each level of a load, one level after the other; between levels is a step of more than the range of
    the noise. Rows on the way from level to level are stretches of their own.
    """
    known = np.flatnonzero(np.isfinite(load))
    x = load[known]
    if x.size < _FEWEST_TURNS:
        return []
    ordered = np.sort(x)
    gaps = np.flatnonzero(np.diff(ordered) > noise_range(x))
    level = np.searchsorted((ordered[gaps] + ordered[gaps + 1]) / 2, x)
    edges = [0, *(np.flatnonzero(np.diff(level)) + 1).tolist(), x.size]
    return [slice(int(known[a]), int(known[b - 1]) + 1) for a, b in pairwise(edges)]


def _has_cycle(drive: ColumnGuess, part: slice) -> bool:
    """Whether the input goes there and back in these rows, as far as it does at all."""
    u = drive.facts.values[part]
    u = u[np.isfinite(u)]
    return bool(u.size > 2 and 2 * np.ptp(u) > drive.facts.span and wide_turns(u).size >= _FEWEST_TURNS)


def _is_held(table: FoundTable, load: ColumnGuess, part: slice) -> bool:
    """Whether the load counts as held in these rows, as in a table of its own."""
    own = next(c for c in guess_table(table_of_rows(table, part)).columns if c.name == load.name)
    return holds_still(own)


def _part(table: FoundTable, load: ColumnGuess, part: slice, number: int) -> FoundTable:
    """The rows as a table whose mapping selects them."""
    level = float(np.nanmedian(load.facts.values[part]))
    title = f"{table.name} {level:.3g} {load.unit}".strip()
    return replace(table_of_rows(table, part), name=f"{title} part {number}")
