"""Groups of columns side by side in one table, as X Y X Y of a plotting program, or time, force and stroke of one
specimen after the other: each group is a run of its own.
"""

import re
from collections.abc import Collection, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from smarig.core import Array
from smarig.exchange import FoundColumn, FoundTable, LabelledBlock, labelled_blocks
from smarig.study.branch_pairs import comes_back, goes_through
from smarig.study.column_facts import column_facts, counts_rows
from smarig.study.input_turns import wide_turns
from smarig.study.quantity_words import without_branch
from smarig.study.row_parts import table_of_rows
from smarig.study.stated_conditions import conditions_in_comments
from smarig.study.table_guess import TableGuess, guess_table

_AGAIN = re.compile(r"(.+) \((\d+)\)")  # a name that was written before
_NAMELESS = re.compile(r"column \d+")  # the name of a column that has none
_FEWEST = 2  # columns of a group, and groups of a table


def tables_of_pairs(table: FoundTable, named: Collection[str | None] = ()) -> list[FoundTable]:
    """A table for each group of columns whose names and units repeat, but for a label; the table itself if none do.

    The columns of the other groups are kept behind the own ones as texts, so that a mapping lists them. Two groups that
    are the way there and the way back are one. Other groups of single branches, without a load or a clock of their own,
    may be the branches of one loop: they stay together. So do all if the user has ``named`` a column of a later group.
    """
    single = _groups(table)
    groups = _with_the_way_back(single)
    if len(groups) < _FEWEST:
        return _labelled_records(table, named) or [table]
    chosen = {column.name for group in groups[1:] for column in group} & set(named)
    if chosen:
        return [table]
    loops = len(groups) < len(single)
    guesses = [guess_table(_part(table, group)) for group in groups]
    if not (loops or _have_own_clocks(guesses) or all(map(_is_run, groups, guesses))):
        return [table]
    return [_table_of(table, groups, k) for k in range(len(groups))]


def comment_of(columns: Sequence[FoundColumn]) -> str:
    """The comment that a file writes under the units of columns, "" without one."""
    return " ".join(dict.fromkeys(column.comment for column in columns if column.comment))


def _groups(table: FoundTable) -> list[tuple[FoundColumn, ...]]:
    """The columns in groups of the shortest period of their names and units; one group if there is none. A counter of
    rows in front and columns of other names behind are in no group.
    """
    if not _has_heading(table):
        return [table.columns]
    columns = [column for column in table.columns[_counters(table) :] if not _divides(column)]
    written = [(_plain(column.name, table.names), column.unit) for column in columns]
    for period in range(_FEWEST, len(written) // 2 + 1):
        number = next(
            (
                k
                for k in range(1, len(written) // period)
                if written[k * period :][:period] != written[:period]
            ),
            len(written) // period,
        )
        behind = written[number * period :]
        if number >= _FEWEST and len(behind) < period and not set(behind) & set(written[:period]):
            return [tuple(columns[k * period :][:period]) for k in range(number)]
    return [table.columns]


def _divides(column: FoundColumn) -> bool:
    """Whether a column without a name and without numbers only divides the groups beside it."""
    nameless = _NAMELESS.fullmatch(column.name) is not None and not column.unit
    return nameless and not np.isfinite(column.values).any()


def _with_the_way_back(groups: Sequence[tuple[FoundColumn, ...]]) -> list[tuple[FoundColumn, ...]]:
    """The groups, with one for each two neighbours if all of them are the branches of a loop, at one load each."""
    doubled = [(*a, *b) for a, b in zip(groups[::2], groups[1::2])]
    if len(groups) == 2 * len(doubled) > _FEWEST and all(map(_is_loop, groups[::2], groups[1::2])):
        return doubled
    return list(groups)


def _is_loop(there: Sequence[FoundColumn], back: Sequence[FoundColumn]) -> bool:
    """Whether a group goes one way through the range of its first column, and the next one comes back at its load."""
    ways = [column.values[np.isfinite(column.values)] for column in (there[0], back[0])]
    loads = [conditions_in_comments(group) for group in (there, back)]
    return loads[0] == loads[1] and all(goes_through(x) for x in ways) and comes_back(*ways)


def _labelled_records(table: FoundTable, named: Collection[str | None]) -> list[FoundTable]:
    """A table for each block of columns whose names differ by a label from those of the others, if each is a record: it
    has a clock, an input and an output. None if the labels are those of branches, which may be one loop, or if the user
    has ``named`` a column with its label: it is in one table.
    """
    blocks = labelled_blocks(table.names)
    of_branches = any(block.label and not without_branch(block.label) for block in blocks)
    if not blocks or of_branches or not _places(table) or set(table.names) & set(named):
        return []
    width = len(blocks[0].names)
    units = {tuple(c.unit for c in table.columns[k : k + width]) for k in range(0, len(table.columns), width)}
    found = [_labelled_record(table, blocks, number) for number in range(len(blocks))]
    guesses = [guess_table(record) for record in found]
    complete = all(guess.first(role) for guess in guesses for role in ("time", "input", "output"))
    return found if complete and len(units) == 1 else []


def _places(table: FoundTable) -> str:
    """The part of the layout in which a mapping may name the columns in their order; "" if none does."""
    of_text = "header_line" in table.layout.get("file", {})
    return "file" if of_text else "workbook" if "workbook" in table.layout else ""


def _labelled_record(table: FoundTable, blocks: Sequence[LabelledBlock], number: int) -> FoundTable:
    """The table of one block, whose columns have their names without the label; those of the others keep it."""
    titles = [block.label or f"columns {k + 1}" for k, block in enumerate(blocks)]
    names = [f"{title}: {name}" for title, each in zip(titles, blocks) for name in each.names]
    width = len(blocks[0].names)
    own = slice(number * width, (number + 1) * width)
    names[own] = blocks[number].names
    columns = [replace(column, name=name) for column, name in zip(table.columns, names)]
    others = [replace(column, kind="text") for column in (*columns[: own.start], *columns[own.stop :])]
    place = _places(table)
    found = replace(
        table,
        name=f"{table.name} {titles[number]}".strip(),
        columns=(*columns[own], *others),
        layout={**table.layout, place: table.layout[place] | {"names": names}},
        titles=(*table.titles, titles[number]),
    )
    return table_of_rows(found, _filled(columns[own]))


def _counters(table: FoundTable) -> int:
    """The number of columns in front that count the rows."""
    facts = map(column_facts, table.columns)
    return next((k for k, f in enumerate(facts) if not counts_rows(f)), 0)


def _has_heading(table: FoundTable) -> bool:
    """Whether names stand in a row above the numbers of a text or a sheet."""
    text, sheet = (table.layout.get(key, {}) for key in ("file", "workbook"))
    return "header_line" in text or sheet.get("header_row", 0) > 0


def _plain(name: str, names: Sequence[str]) -> str:
    """A name without the number by which it differs from an earlier equal one."""
    match = _AGAIN.fullmatch(name)
    return match[1] if match and match[1] in names else name


def _part(table: FoundTable, group: Sequence[FoundColumn]) -> FoundTable:
    """The columns of a group, as far as one of them has a number: specimens differ in their rows."""
    return table_of_rows(replace(table, columns=tuple(group)), _filled(group))


def _filled(group: Sequence[FoundColumn]) -> slice:
    """The rows from the first number of a group to its last one."""
    rows = np.flatnonzero(np.isfinite([column.values for column in group]).any(axis=0))
    return slice(int(rows[0]), int(rows[-1]) + 1) if rows.size else slice(0, 0)


def _is_run(group: Sequence[FoundColumn], guess: TableGuess) -> bool:
    """Whether a group has a load of its own, or its input or its first column goes up and down."""
    if conditions_in_comments(group):
        return True
    drive = guess.first("input")
    return _turns(group[0].values) or (drive is not None and _turns(drive.facts.values))


def _turns(values: Array) -> bool:
    x = values[np.isfinite(values)]
    return bool(x.size and np.ptp(x) > 0 and wide_turns(x).size > 2)


def _have_own_clocks(guesses: Sequence[TableGuess]) -> bool:
    """Whether each group has a clock, and none goes on where the clock of the group before it ended."""
    clocks = [clock.facts for guess in guesses if (clock := guess.first("time"))]
    return len(clocks) == len(guesses) and all(b.known[0] <= a.known[-1] for a, b in pairwise(clocks))


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
    grouped = {column.name for group in groups for column in group}
    columns += [replace(column, kind="text") for column in table.columns if column.name not in grouped]
    renamed = {old: own for k, group in enumerate(names) for old, own in zip(group, new[k])}
    key = next(key for key in ("file", "workbook") if key in table.layout)
    entries = table.layout[key] | {"names": [renamed.get(name, name) for name in table.names]}
    titles = _titles(table, groups)
    title = comment_of(groups[number]) or (titles[number] if titles else f"columns {number + 1}")
    found = replace(
        table,
        name=f"{table.name} {title}".strip(),
        columns=tuple(columns),
        layout={**table.layout, key: entries},
        titles=(*table.titles, *titles[number : number + 1]),
    )
    rows = _filled(groups[number])
    return found if rows == slice(0, len(table)) else table_of_rows(found, rows)


def _titles(table: FoundTable, groups: Sequence[Sequence[FoundColumn]]) -> list[str]:
    """What a row above the names says of each group, as names of specimens; [] unless it differs for each."""
    place = {name: k for k, name in enumerate(table.names)}
    places = [[place[column.name] for column in group] for group in groups]
    for row in table.above:
        cells = [[row[k] for k in group if k < len(row) and row[k]] for group in places]
        titles = [" ".join(words) for words in cells]
        if all(len(words) == 1 for words in cells) and len(set(titles)) == len(titles):
            return titles
    return []
