"""Finds the tables in rows of cells: blocks of numbers, the names above them, and units between both.

Names and units may be divided by another sign than the numbers: what counts is that there are as many as columns.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

from smarig.exchange.tables.column_levels import column_levels
from smarig.exchange.tables.found_table import CLOCK, NUMBER, TEXT
from smarig.exchange.tables.header_rows import (
    HEADER_ROWS,
    filled_from,
    has_cells,
    header_cells,
    header_rows,
    listed_names,
    names_each,
    stated_units,
    unbracketed,
    unique_names,
)
from smarig.exchange.tables.number_style import NumberStyle
from smarig.exchange.tables.rare_texts import rare_texts
from smarig.exchange.tables.stacked_headings import stacked_heading
from smarig.exchange.text.cell_values import is_number
from smarig.exchange.text.header_words import has_bracketed_units, words_below
from smarig.exchange.text.interruptions import names_columns
from smarig.exchange.text.no_reading import is_missing
from smarig.exchange.text.table_rows import rows_end
from smarig.exchange.units.written_units import without_markup

FEWEST_ROWS = 3  # of a table


@dataclass(frozen=True)
class FoundBlock:
    """A table in rows (0 is the first): row of its names (None without), first row of numbers, and the row after it.

    ``names`` are unique; ``own_names`` says that they differ from the cells of the header. ``units`` are the cells of
    a row of units, "" where there is none, ``constants`` the numbers there by name ("Increment" of an oscilloscope),
    and ``comments`` those of the rows below it. ``kinds`` are those of the columns. ``breaks`` are the first rows after
    lines of text between the rows, and ``no_reading`` the texts in few cells of columns of numbers.
    """

    header: int | None
    first: int
    stop: int
    names: tuple[str, ...]
    units: tuple[str, ...]
    kinds: tuple[str, ...]
    own_names: bool
    comments: tuple[str, ...] = ()
    constants: tuple[tuple[str, str], ...] = ()
    breaks: tuple[int, ...] = ()
    no_reading: tuple[str, ...] = ()


def find_blocks(
    rows: Sequence[Sequence[str]], style: NumberStyle, lines: Sequence[str] = ()
) -> list[FoundBlock]:
    """The tables in rows of cells, in order; trailing empty cells are left out of the rows.

    ``lines`` are the lines of the rows in a text, where names may be divided by another sign than numbers.
    """
    kinds = _with_unread_rows(rows, [_row_kind(row, style) for row in rows], style)
    start = kinds.index("data") if "data" in kinds else 0
    titles = {tuple(row) for row in rows[:start] if row}
    runs: list[list[int]] = []
    breaks: list[int] = []
    for k, kind in enumerate(kinds):
        if kind != "data":
            continue
        if runs and _joined(rows, kinds, runs[-1][1], k, titles):
            breaks += [k] if _starts_again(rows, kinds, runs[-1][1], k) else []
            runs[-1][1] = k + 1
        elif runs and lines and _goes_on(rows, lines, runs[-1][1], k, style):
            runs[-1][1] = k + 1
            breaks.append(k)
        else:
            runs.append([k, k + 1])
    ends = [rows_end(rows[:b], a, style) for a, b in runs]
    found = [_block(rows, kinds, a, b, style, lines) for (a, _), b in zip(runs, ends)]
    return [
        replace(block, breaks=tuple(k for k in breaks if block.first < k < block.stop))
        for block in found
        if block is not None
    ]


def rows_above(before: Sequence[Sequence[str]], block: FoundBlock) -> tuple[tuple[str, ...], ...]:
    """The cells of the rows above the names of a table, the nearest first, each as wide as the table."""
    width = len(block.names)
    near = [row for row in before[::-1][:HEADER_ROWS] if 1 < len(row) <= width]
    return tuple((*row, *[""] * (width - len(row))) for row in near)


def _row_kind(row: Sequence[str], style: NumberStyle) -> str:
    """ "data" for a row that holds mostly numbers, "text", or "blank"."""
    filled = [style.kind(cell) if cell else "" for cell in row]
    used = [kind for kind in filled if kind]
    if row and row[0].startswith("#"):
        return "text"
    if not used:
        return "blank"
    numbers = sum(kind != TEXT for kind in used)
    real = any(
        kind == CLOCK or (kind == NUMBER and not is_missing(cell)) for kind, cell in zip(filled, row) if cell
    )
    return "data" if real and 2 * numbers > len(used) else "text"


def _with_unread_rows(rows: Sequence[Sequence[str]], kinds: Sequence[str], style: NumberStyle) -> list[str]:
    """The kinds of rows, where one below numbers is data too if it has numbers in most of their columns (its other
    cells could not be read; no names are numbers), or begins with one and has words only where no numbers stand, as
    events do.
    """
    out, width, first = list(kinds), 0, 0
    for k in range(1, len(rows)):
        row, before = rows[k], rows[k - 1]
        if out[k] == "data" and out[k - 1] != "data":
            width, first = len(before) if out[k - 1] == "text" else 0, k
        if out[k] != "text" or out[k - 1] != "data" or row[0].startswith("#"):
            continue
        of_numbers = [j for j, cell in enumerate(before) if cell and style.kind(cell) != TEXT]
        same = sum(bool(row[j]) and style.kind(row[j]) != TEXT for j in of_numbers if j < len(row))
        same_columns = len(row) == len(before) and 2 * same > len(of_numbers)
        event = len(row) <= max(width, len(before)) and _is_event(row, rows[first], style)
        out[k] = "data" if same_columns or event else "text"
    return out


def _is_event(row: Sequence[str], first: Sequence[str], style: NumberStyle) -> bool:
    """Whether a row begins with a number and has words only where the first row of its table has no number."""
    words = [j for j, cell in enumerate(row) if cell and style.kind(cell) == TEXT]
    numbers = [bool(cell) and style.kind(cell) != TEXT for cell in first]
    return bool(row[0]) and 0 not in words and not any(numbers[j] for j in words if j < len(numbers))


def _joined(
    rows: Sequence[Sequence[str]], kinds: Sequence[str], end: int, k: int, titles: set[tuple[str, ...]]
) -> bool:
    """Whether rows ``end`` … ``k`` between two blocks are only blank, or only the header (one of
    ``titles``) once more."""
    between = [
        i for i in range(end, k) if not (rows[i] and rows[i][0].startswith("#"))
    ]  # comments do not count
    if all(kinds[i] == "blank" for i in between):
        return len(between) == 0 or len(rows[end - 1]) == len(rows[k])
    if any(kinds[i] == "blank" for i in between):
        return False
    return all(tuple(rows[i]) in titles for i in between)


def _starts_again(rows: Sequence[Sequence[str]], kinds: Sequence[str], end: int, k: int) -> bool:
    """Whether rows ``end`` … ``k`` hold more than the names of the columns once more, as what a board writes when it
    starts.
    """
    return (
        len({tuple(rows[i]) for i in range(end, k) if kinds[i] == "text" and not rows[i][0].startswith("#")})
        > 1
    )


def _goes_on(
    rows: Sequence[Sequence[str]], lines: Sequence[str], end: int, k: int, style: NumberStyle
) -> bool:
    """Whether row ``k`` has the columns of the rows before ``end``, and the lines between both name no others."""
    before, row = rows[end - 1], rows[k]
    if len(before) != len(row) or len(row) < 2:
        return False
    same = all((style.kind(a) == TEXT) == (style.kind(b) == TEXT) for a, b in zip(before, row))
    return same and not any(names_columns(rows[i], lines[i], len(row)) for i in range(end, k) if rows[i])


def _block(
    rows: Sequence[Sequence[str]],
    kinds: Sequence[str],
    first: int,
    stop: int,
    style: NumberStyle,
    lines: Sequence[str],
) -> FoundBlock | None:
    original = rows
    data = [row for k, row in enumerate(rows[first:stop], first) if kinds[k] == "data"]
    width = Counter(len(row) for row in data).most_common(1)[0][0] if data else 0
    width = max([width, *(len(row) for row in data)])
    if len(data) < FEWEST_ROWS or width < 2:
        return None
    levels = column_levels(rows, kinds, first, width, style)
    above = header_cells(rows, kinds, first, width, style, lines) if levels is None else {}
    rows = [above.get(k, row) for k, row in enumerate(rows)]
    stacked = stacked_heading(rows, kinds, first)
    if stacked is not None and stacked.combined:
        rows = [stacked.names if k == stacked.row else row for k, row in enumerate(rows)]
    cells = [[row[k] for row in data if k < len(row)] for k in range(width)]
    texts = [rare_texts(column, style) for column in cells]
    columns = tuple(NUMBER if t else _column_kind(column, style) for t, column in zip(texts, cells))
    no_reading = tuple(dict.fromkeys(text for found in texts for text in found))
    if levels is not None:
        names, units = unique_names(levels.names, width)[0], tuple(map(unbracketed, levels.units))
        return FoundBlock(levels.row, first, stop, names, units, columns, True, no_reading=no_reading)
    header, unit_row = header_rows(rows, kinds, first, columns, style)
    if stacked is not None and header == first - 1:  # the units are no names
        header, unit_row = stacked.row, first - 1
    end, listed = listed_names(rows, kinds, first, lines, width, style)
    stated = listed and has_bracketed_units(listed)
    plain = header is not None and has_cells(rows[header], width)
    plain = plain and (not stated or names_each(rows[header or 0], width, style))
    if listed and (header is None or header < end or not plain):  # a header below the list counts
        names = unique_names(listed, width)[0]
        return FoundBlock(None, first, stop, names, ("",) * width, columns, True, no_reading=no_reading)
    written = list(rows[header]) if header is not None else []
    below = rows[unit_row] if unit_row is not None else []
    if lines and header is not None and unit_row is not None and len(written) == width > len(below):
        below = words_below(lines[header], lines[unit_row], width) or below
    filled = filled_from(written, below)
    names, own = unique_names(filled, width)
    own = own or filled != written or (header is not None and rows[header] is not original[header])
    units = [without_markup(cell) for cell in stated_units(below, written, columns, style)]
    units = [unbracketed(cell) for cell in units] + [""] * (len(names) - len(units))
    last = unit_row if unit_row is not None or header is None else header
    comments = _comments(rows[last + 1 : first], len(names)) if last is not None else ()
    constants = tuple((name, cell) for name, cell in zip(names, below) if is_number(cell, style.decimal))
    return FoundBlock(
        header,
        first,
        stop,
        names,
        tuple(units[: len(names)]),
        columns,
        own,
        comments,
        constants,
        no_reading=no_reading,
    )


def _comments(rows: Sequence[Sequence[str]], width: int) -> tuple[str, ...]:
    """What rows below the units say of each column; a row of one cell, or of more words than there are columns, is a
    title, and says nothing of a column.
    """
    cells = [[*row, *[""] * width][:width] for row in rows if 1 < len(row) <= width]
    return tuple(without_markup(" ".join(filter(None, column))) for column in zip(*cells))


def _column_kind(cells: Sequence[str], style: NumberStyle) -> str:
    """The kind of a column: that of most of its cells that are not missing. A column that is blank, as that of
    comments, may hold a text further down.
    """
    if cells and not any(cells):
        return TEXT
    found = Counter(style.kind(cell) for cell in [cell for cell in cells if not is_missing(cell)][:5000])
    if not found:
        return NUMBER
    if found[TEXT]:
        return TEXT
    return CLOCK if found[CLOCK] > found[NUMBER] else NUMBER
