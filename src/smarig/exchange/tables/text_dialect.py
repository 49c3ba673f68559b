"""Finds the tables in a text whatever its dialect: delimiter, decimal sign, thousands, headers, units rows."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from smarig.core import DataError
from smarig.exchange.layouts.channel_rows import check_one_channel
from smarig.exchange.layouts.json_document import no_table_in
from smarig.exchange.layouts.table_lines import table_lines
from smarig.exchange.tables.found_table import CLOCK, TEXT, FoundTable, found_columns
from smarig.exchange.tables.labelled_blocks import labelled_blocks
from smarig.exchange.tables.late_thousands import with_late_thousands
from smarig.exchange.tables.lost_rows import without_lost_rows
from smarig.exchange.tables.stated_columns import stated_columns
from smarig.exchange.tables.table_file import read_table
from smarig.exchange.tables.table_structure import (
    FEWEST_ROWS,
    FoundBlock,
    NumberStyle,
    find_blocks,
    rows_above,
)
from smarig.exchange.tables.text_table import (
    DELIMITERS,
    HEADER_WITHIN,
    TableLayout,
    long_cells_refused,
    preamble_keys,
    read_text,
)
from smarig.exchange.text.cell_values import has_thousands
from smarig.exchange.text.table_rows import split
from smarig.exchange.units.unit_systems import units_of_system
from smarig.exchange.units.written_units import known_unit

_SAMPLE = 250  # lines at the beginning, and as many from the rest, by which the dialect is chosen
_MOST_LINES = 40_000  # a longer file counts as one table after its first lines
_STYLES = (
    NumberStyle("."),
    NumberStyle(","),
    *(
        NumberStyle(decimal, thousands)
        for decimal in ".,"
        for thousands in (",", ".", "'", "space")
        if decimal != thousands
    ),
)
_SEPARATOR_LINE = re.compile(r"sep=(.)", re.IGNORECASE)
_LONGEST_START = 60  # characters of a header by which tables of one file are told apart


@dataclass(frozen=True)
class _Dialect:
    delimiter: str  # a key of DELIMITERS
    style: NumberStyle

    def rows(self, lines: Sequence[str]) -> list[list[str]]:
        """The cells of each line."""
        return [split(line, DELIMITERS[self.delimiter]) for line in lines]


def text_tables(path: Path) -> list[FoundTable]:
    """The tables of a text file, in order; DataError if it holds none."""
    text, _ = read_text(path)
    try:
        with long_cells_refused(path):
            return _found_tables(path, table_lines(path, text).lines)
    except DataError:
        if why := no_table_in(text):
            raise DataError(f"{path} holds no table. {why}") from None
        raise


def _found_tables(path: Path, lines: Sequence[str]) -> list[FoundTable]:
    """The tables in lines of text; DataError if there is none."""
    dialect = _chosen(lines)
    blocks = _blocks(lines, dialect) if dialect else []
    if not dialect or not blocks:
        raise DataError(
            f"{path} holds no table: it has no {FEWEST_ROWS} lines that are mostly numbers, two or more. "
            "Give a file of measured columns."
        )
    found: list[FoundTable] = []
    left_out: dict[str, str] = {}
    refused = None
    for block in blocks:
        try:
            table = _table(path, lines, dialect, block, blocks)
        except DataError as error:  # a list of segments, for example, before the readings
            refused = refused or error
            if "text" not in block.kinds:  # lines of a key and its values are no rows
                left_out[_lines_of(block)] = str(error)
            continue
        if table is None:
            left_out[_lines_of(block)] = (
                "no names of columns stand above these rows, and another table stands before them"
            )
        else:
            found.append(table)
    if refused is not None and not found:
        raise refused
    return [replace(found[0], left_out=left_out), *found[1:]]


def _name(block: FoundBlock, blocks: Sequence[FoundBlock]) -> str:
    """The number of a table among those of its columns, as files number them; of other tables than most, its lines."""
    same = [b for b in blocks if b.names == block.names]
    rows = {b.names: sum(o.stop - o.first for o in blocks if o.names == b.names) for b in blocks}
    main = max(rows, key=lambda names: rows[names]) == block.names
    return f"table {same.index(block) + 1}" if main else _lines_of(block)


def _lines_of(block: FoundBlock) -> str:
    return f"lines {block.first + 1} to {block.stop}"


def _blocks(lines: Sequence[str], dialect: _Dialect) -> list[FoundBlock]:
    first = lines[:_MOST_LINES]
    return find_blocks(dialect.rows(first), dialect.style, first)


def _chosen(lines: Sequence[str]) -> _Dialect | None:
    """The dialect in which most cells of the text are numbers."""
    sample = list(lines[:_SAMPLE])
    rest = lines[_SAMPLE:_MOST_LINES]
    middle = max((len(rest) - _SAMPLE) // 2, 0)
    sample += rest[middle : middle + _SAMPLE]
    stated = _SEPARATOR_LINE.fullmatch(lines[0].strip().strip('"')) if lines else None
    delimiters = [name for name, sign in DELIMITERS.items() if not stated or sign == stated[1]] or list(
        DELIMITERS
    )
    best, most = None, 0.0
    for dialect in _different(delimiters, sample):
        style = dialect.style
        rated = _rating(dialect, sample) - 1e-6 * bool(style.thousands) - 1e-7 * _STYLES.index(style)
        if rated > most * (1 + 1e-9) + 1e-9:
            best, most = dialect, rated
    return best and replace(best, style=with_late_thousands(lines, DELIMITERS[best.delimiter], best.style))


def _different(delimiters: Sequence[str], sample: Sequence[str]) -> Iterator[_Dialect]:
    """The dialects that may read the sample differently, the plainest first.

    A sign between thousands that occurs nowhere changes only that numbers with a point are read beside a decimal comma.
    """
    quoted = any('"' in line for line in sample)
    occurring = {
        style.thousands for style in _STYLES if style.thousands and has_thousands(sample, style.thousands)
    }
    for delimiter in delimiters:
        rated: set[tuple[str, str]] = set()
        for style in _STYLES:
            signs = (style.decimal, style.thousands)
            if not quoted and (DELIMITERS[delimiter] in signs or (delimiter == "space" and "space" in signs)):
                continue
            plain = "none" if style.thousands and style.decimal == "," else ""
            effect = (style.decimal, style.thousands if style.thousands in occurring else plain)
            if effect not in rated:
                rated.add(effect)
                yield _Dialect(delimiter, style)


def _rating(dialect: _Dialect, sample: Sequence[str]) -> float:
    """The number of numbers in tables, less that of other texts in their rows."""
    rows = dialect.rows(sample)
    total = 0.0
    for block in find_blocks(rows, dialect.style):
        for row in rows[block.first : block.stop]:
            kinds = [dialect.style.kind(cell) for cell in row if cell]
            signs = sum(cell in ("+", "-") for cell in row)  # of numbers that this delimiter cuts in two
            total += sum(1.0 if kind != TEXT else -0.6 for kind in kinds) - signs
    return total


def _table(
    path: Path,
    lines: Sequence[str],
    dialect: _Dialect,
    block: FoundBlock,
    blocks: Sequence[FoundBlock],
) -> FoundTable | None:
    entries = _entries(lines, dialect, block, blocks)
    if entries is None:
        return None
    check_one_channel(
        path, block.names, (dialect.rows([line])[0] for line in lines[block.first : block.stop])
    )
    kinds = dict(zip(block.names, block.kinds))
    clock = next((name for name, kind in kinds.items() if kind == CLOCK), "")
    layout = TableLayout(
        known=() if "names" in entries else block.names,
        names=tuple(entries.get("names", ())),
        delimiter=dialect.delimiter,
        decimal=dialect.style.decimal,
        header_starts=entries.get("header_starts", ""),
        table=entries.get("table", 1),
        thousands=dialect.style.thousands,
        header_line=entries.get("header_line", 0),
        units_rows=entries.get("units_rows", 0),
        interruptions=entries.get("interruptions", "refuse"),
        no_reading=block.no_reading,
        clock=clock,
        text=tuple(name for name, kind in kinds.items() if kind != "number" and name != clock),
    )
    table = without_lost_rows(read_table(path, layout))
    begin = max((b.stop for b in blocks if b.stop <= block.first), default=0)
    before = lines[begin : block.first if block.header is None else block.header]
    head = lines[: block.first if block.header is None else block.header]
    stated = stated_columns(block.names, head, dialect.rows(head))
    units = _units(block, dialect, lines[: block.first])
    comments = dict(zip(block.names, block.comments))
    for name, unit, comment in zip(block.names, stated.units, stated.comments):
        units[name] = units[name] or unit
        comments[name] = " ".join(filter(None, (comments.get(name), comment)))
    return FoundTable(
        path=path,
        format="csv",
        name=_name(block, blocks) if len(blocks) > 1 else "",
        columns=found_columns(path, table, units, kinds, comments),
        layout={"file": entries},
        header=preamble_keys([line.strip("# ") for line in before if line.strip()]) | dict(block.constants),
        above=rows_above(dialect.rows(before), block),
        breaks=tuple(np.searchsorted(table.line, [k + 1 for k in block.breaks]).tolist()),
    )


def _units(block: FoundBlock, dialect: _Dialect, before: Sequence[str]) -> dict[str, str]:
    """The units of the columns: from the row of units, else from a line such as "Vertical Units,V,V" or "Units of
    measure  cgs" before it.
    """
    units = list(block.units)
    if not any(units):
        units = units_of_system(block.names, before)
    for row in dialect.rows(before) if not any(units) else ():
        if len(row) > 1 and "unit" in row[0].lower() and len(row) <= len(units):
            units = [old or known_unit(cell) for old, cell in zip(units, _of_axis(row, len(units)))]
    return dict(zip(block.names, units))


def _of_axis(row: Sequence[str], width: int) -> list[str]:
    """The cells of a line such as "Vertical Units,V" at their columns: the horizontal axis is the first, and one unit
    of the vertical axis is that of all others.
    """
    if row[0].lower().startswith(("horizontal", "x")):
        return [row[1], *[""] * (width - 1)]
    cells = [*row[1:], *[""] * (width - len(row))]
    return [
        "",
        *([row[1]] * (width - 1) if row[0].lower().startswith("vertical") and len(row) == 2 else cells),
    ]


def _entries(
    lines: Sequence[str], dialect: _Dialect, block: FoundBlock, blocks: Sequence[FoundBlock]
) -> dict | None:
    """The [file] table of a mapping; None for a further table without a header, which no mapping can describe."""
    entries: dict = {"delimiter": dialect.delimiter}
    if block.breaks:
        entries["interruptions"] = "leave out"
    if block.no_reading:
        entries["no_reading"] = list(block.no_reading)
    if dialect.style.decimal != ".":
        entries["decimal"] = dialect.style.decimal
    if dialect.style.thousands:
        entries["thousands"] = dialect.style.thousands
    if block.header is None:
        return entries | {"names": list(block.names)} if block is blocks[0] else None
    if len(blocks) > 1:
        if (
            block is blocks[-1]
            and not block.breaks
            and any(not lines[k].strip() for k in range(block.first, block.stop))
        ):
            return entries | _at_line(block)  # segments with blank lines between them, up to the end
        if block.own_names:
            return entries | _at_line(block) if block in (blocks[0], blocks[-1]) else None
        start = lines[block.header][:_LONGEST_START]
        number = sum(line.startswith(start) for line in lines[: block.header + 1])
        entries |= {"header_starts": start, "table": number}
        return entries | _units_rows(block)
    placed = block.own_names or not _found_by_name(lines, block) or labelled_blocks(block.names)
    return entries | (_at_line(block) if placed else _units_rows(block))


def _found_by_name(lines: Sequence[str], block: FoundBlock) -> bool:
    """Whether the header is near enough to the beginning, and no comment, so that its names identify it."""
    header = block.header or 0
    return header < HEADER_WITHIN and not lines[header].startswith("#")


def _at_line(block: FoundBlock) -> dict:
    return {"header_line": (block.header or 0) + 1, "names": list(block.names)} | _units_rows(block)


def _units_rows(block: FoundBlock) -> dict:
    skipped = block.first - (block.header or 0) - 1
    return {"units_rows": skipped} if skipped else {}
