"""Pairs of columns side by side in one table, as X Y X Y of a plotting program: each pair is a run of its own."""

import re
from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from smarig.exchange import FoundColumn, FoundTable
from smarig.study.column_guess import conditions_in_name
from smarig.study.input_turns import wide_turns

_AGAIN = re.compile(r"(.+) \((\d+)\)")  # a name that was written before
_FEWEST = 2  # columns of a group, and groups of a table


def tables_of_pairs(table: FoundTable, named: Collection[str | None] = ()) -> list[FoundTable]:
    """A table for each group of columns whose names and units repeat; the table itself if none do.

    The columns of the other groups are kept behind the own ones as texts, so that a mapping lists them. Groups of
    single branches, without a load of their own, may be the branches of one loop: they stay together. So do all if the
    user has ``named`` a column of a later group.
    """
    groups = _groups(table)
    chosen = {column.name for group in groups[1:] for column in group} & set(named)
    if len(groups) < _FEWEST or chosen or not all(_is_run(group) for group in groups):
        return [table]
    return [_table_of(table, groups, k) for k in range(len(groups))]


def comment_of(columns: Sequence[FoundColumn]) -> str:
    """The comment that a file writes under the units of columns, "" without one."""
    return " ".join(dict.fromkeys(column.comment for column in columns if column.comment))


def _groups(table: FoundTable) -> list[tuple[FoundColumn, ...]]:
    """The columns in groups of the shortest period of their names and units; one group if there is none."""
    written = [(_plain(column.name, table.names), column.unit) for column in table.columns]
    width = len(written)
    if "header_line" not in table.layout.get("file", {}):
        return [table.columns]
    for period in range(_FEWEST, width // 2 + 1):
        if width % period == 0 and written == written[:period] * (width // period):
            return [table.columns[k : k + period] for k in range(0, width, period)]
    return [table.columns]


def _plain(name: str, names: Sequence[str]) -> str:
    """A name without the number by which it differs from an earlier equal one."""
    match = _AGAIN.fullmatch(name)
    return match[1] if match and match[1] in names else name


def _is_run(group: Sequence[FoundColumn]) -> bool:
    """Whether a group has a load of its own, or its first column goes up and down."""
    if conditions_in_name(comment_of(group)):
        return True
    x = group[0].values[np.isfinite(group[0].values)]
    return bool(x.size and np.ptp(x) > 0 and wide_turns(x).size > 2)


def _table_of(table: FoundTable, groups: Sequence[tuple[FoundColumn, ...]], number: int) -> FoundTable:
    """The table of one group, under the names of the first one, and its name: the comment or the number."""
    names = [[column.name for column in group] for group in groups]
    order = [number, *(k for k in range(len(groups)) if k != number)]
    new = dict(zip(order, names))
    columns = [
        replace(column, name=name, kind=column.kind if k == number else "text")
        for k in order
        for column, name in zip(groups[k], new[k])
    ]
    entries = table.layout["file"] | {"names": [name for k in range(len(groups)) for name in new[k]]}
    title = comment_of(groups[number]) or f"columns {number + 1}"
    return replace(
        table,
        name=f"{table.name} {title}".strip(),
        columns=tuple(columns),
        layout={**table.layout, "file": entries},
    )
