"""Finds the tables in rows of cells: blocks of numbers, the names above them, and units between both.

Names and units may be divided by another sign than the numbers: what counts is that there are as many as columns.
"""

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

from smarig.exchange.cell_values import is_missing, is_number
from smarig.exchange.clock_cells import clock_seconds
from smarig.exchange.found_table import CLOCK, NUMBER, TEXT
from smarig.exchange.header_words import has_bracketed_units, with_brackets_joined, words_below
from smarig.exchange.interruptions import names_columns
from smarig.exchange.text_table import HEADER_WITHIN
from smarig.exchange.written_units import is_unit, is_units_row, without_markup

FEWEST_ROWS = 3  # of a table
_HEADER_ROWS = 4  # rows above the numbers that are searched for names and units
_COMMENT = re.compile(r"^\s*(?:#+|%+|//+|;+|\*+)\s*")
_ALIGNED = r"\s{2,}|\t"  # what stands between words that blanks align over their columns
# Between the names of columns, the rarest in a name first:
_HEADER_SIGNS = (_ALIGNED, ";", ",", r"\|", r"\s+")
# Sig1 Time (min); # 2: Force [N]
_LISTED = re.compile(r"(\D{0,40}?)\s*(\d{1,4})\s*(?:[:=.)\]\t,;]|\s)\s*(\S.*)")
_BRACKETED = re.compile(r"[\[(<{](.*)[\])>}]")


@dataclass(frozen=True)
class NumberStyle:
    """How a table writes numbers: decimal sign, and what stands between thousands."""

    decimal: str = "."
    thousands: str = ""

    def kind(self, cell: str) -> str:
        """Whether a cell is a number (or a word for a missing one), a clock time or another text."""
        mixed = self.decimal == "," and "." in cell and "," not in cell and not self.thousands
        if (is_number(cell, self.decimal, self.thousands) and not mixed) or is_missing(cell):
            return NUMBER
        return CLOCK if clock_seconds(cell) is not None else TEXT


@dataclass(frozen=True)
class FoundBlock:
    """A table in rows (0 is the first): row of its names (None without), first row of numbers, and the row after it.

    ``names`` are unique; ``own_names`` says that they differ from the cells of the header. ``units`` are the cells of
    a row of units, "" where there is none, ``constants`` the numbers there by name ("Increment" of an oscilloscope),
    and ``comments`` those of the rows below it. ``kinds`` are those of the columns. ``breaks`` are the first rows after
    lines of text between the rows.
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
            runs[-1][1] = k + 1
        elif runs and lines and _goes_on(rows, lines, runs[-1][1], k, style):
            runs[-1][1] = k + 1
            breaks.append(k)
        else:
            runs.append([k, k + 1])
    found = [_block(rows, kinds, a, b, style, lines) for a, b in runs]
    return [
        replace(block, breaks=tuple(k for k in breaks if block.first < k < block.stop))
        for block in found
        if block is not None
    ]


def rows_above(before: Sequence[Sequence[str]], block: FoundBlock) -> tuple[tuple[str, ...], ...]:
    """The cells of the rows above the names of a table, the nearest first, each as wide as the table."""
    width = len(block.names)
    near = [row for row in before[::-1][:_HEADER_ROWS] if 1 < len(row) <= width]
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
    above = _header_cells(rows, kinds, first, width, style, lines)
    rows = [above.get(k, row) for k, row in enumerate(rows)]
    columns = tuple(_column_kind([row[k] for row in data if k < len(row)], style) for k in range(width))
    header, unit_row = _header_rows(rows, kinds, first, columns, style)
    end, listed = _listed_names(rows, first, lines, width, style)
    stated = listed and has_bracketed_units(listed)
    plain = header is not None and (not stated or _names_each(rows[header], width, style))
    if listed and (header is None or header < end or not plain):  # a header below the list counts
        names = _names(listed, width)[0]
        return FoundBlock(None, first, stop, names, ("",) * width, columns, True)
    written = list(rows[header]) if header is not None else []
    below = rows[unit_row] if unit_row is not None else []
    if lines and header is not None and unit_row is not None and len(written) == width > len(below):
        below = words_below(lines[header], lines[unit_row], width) or below
    filled = _filled_from(written, below)
    names, own = _names(filled, width)
    own = own or filled != written or (header is not None and rows[header] is not original[header])
    units = [without_markup(cell) for cell in (below if is_units_row(below) else _units_in(below, columns))]
    units = [_unbracketed(cell) for cell in units] + [""] * (len(names) - len(units))
    last = unit_row if unit_row is not None or header is None else header
    comments = _comments(rows[last + 1 : first], len(names)) if last is not None else ()
    constants = tuple((name, cell) for name, cell in zip(names, below) if is_number(cell, style.decimal))
    return FoundBlock(
        header, first, stop, names, tuple(units[: len(names)]), columns, own, comments, constants
    )


def _comments(rows: Sequence[Sequence[str]], width: int) -> tuple[str, ...]:
    """What rows below the units say of each column; a row of one cell, or of more words than there are columns, is a
    title, and says nothing of a column.
    """
    cells = [[*row, *[""] * width][:width] for row in rows if 1 < len(row) <= width]
    return tuple(without_markup(" ".join(filter(None, column))) for column in zip(*cells))


def _header_cells(
    rows: Sequence[Sequence[str]],
    kinds: Sequence[str],
    first: int,
    width: int,
    style: NumberStyle,
    lines: Sequence[str],
) -> dict[int, Sequence[str]]:
    """The cells of the rows above the numbers that another sign divides into as many words as there are columns.

    Blanks align such words anywhere above the numbers; any sign may divide them next to the numbers, and above units.
    """
    found: dict[int, Sequence[str]] = {}
    nearest = True
    for k in range(first - 1, max(first - 3 - _HEADER_ROWS, -1), -1):
        if kinds[k] == "data":
            break
        if kinds[k] == "blank":
            continue
        line = lines[k] if lines else rows[k][0] if len(rows[k]) == 1 else ""
        signs = _HEADER_SIGNS if nearest else _HEADER_SIGNS[:1]
        if words := _words(rows[k], line, width, signs, style):
            found[k] = words
        nearest = nearest and is_units_row(found.get(k, rows[k]))
    return found


def _words(
    row: Sequence[str], line: str, width: int, signs: Sequence[str], style: NumberStyle
) -> list[str] | None:
    """The words of a line, none of them a number, if a sign divides it into as many as there are columns; None for a
    row that has as many cells already, or that the sign of the numbers divides. A sign of comments is left out.
    """
    start = _COMMENT.sub("", row[0]) if row else ""
    if len(row) == width:
        return [start, *row[1:]] if start not in ("", row[0]) else None
    if len(row) > 1 and list(row) != line.split():
        return None
    text = _COMMENT.sub("", line).strip()
    for sign in signs:
        words = [word.strip().strip('"') for word in re.split(sign, text)]
        words = words if len(words) == width else with_brackets_joined(words)
        plain = all(word and style.kind(word) == TEXT for word in words)
        unlike = sign == _ALIGNED or len(set(words)) == width or is_units_row(words)
        if len(words) == width and plain and unlike:
            return words
    return None


def _header_rows(
    rows: Sequence[Sequence[str]],
    kinds: Sequence[str],
    first: int,
    columns: Sequence[str],
    style: NumberStyle,
) -> tuple[int | None, int | None]:
    """The row of names and the row of units above the first row of numbers; ``columns``: the kinds of the columns.

    A row that names each column counts more than a nearer one that leaves columns out or calls several the same.
    """
    width = len(columns)
    above: list[int] = []
    for k in range(first - 1, max(first - 2 - _HEADER_ROWS, -1), -1):
        if kinds[k] == "data":
            break
        if kinds[k] == "text":
            above.append(k)
    wide = [k for k in above[:_HEADER_ROWS] if _fills(rows[k], width) or is_units_row(rows[k])]
    if not wide:
        return None, None
    for k, before in zip(wide, wide[1:]):
        near = all(kinds[i] == "blank" for i in range(before + 1, k))
        if near and is_units_row(rows[k]) and not is_units_row(rows[before]):
            each = next((i for i in wide if i <= before and _names_each(rows[i], width, style)), before)
            return (each if "blank" not in kinds[each:before] else before), k
    named = [k for k in wide if has_bracketed_units(rows[k])]
    if named and named[0] != wide[0] and not is_units_row(rows[wide[0]]):
        return named[0], None  # what stands below the names describes the channels
    complete = [k for k in wide if _names_each(rows[k], width, style) and "blank" not in kinds[k:first]]
    if complete and not _names_each(rows[wide[0]][:width], width, style):
        units = [sum(map(bool, _units_in(rows[k], columns))) for k in complete]
        named = complete[1] if complete[1:] == [complete[0] - 1] and units[0] > units[1] else complete[0]
        return named, named + 1 if any(_units_in(rows[named + 1], columns)) else None
    if len(wide) > 1 and wide[1] == wide[0] - 1 and _has_units_of(rows[wide[0]], rows[wide[1]], columns):
        return wide[1], wide[0]
    return wide[0], None


def _names_each(row: Sequence[str], width: int, style: NumberStyle) -> bool:
    """Whether a row has a word of its own for each column, that is no number and no unit."""
    words = len(row) == width == len(set(row)) and all(row)
    return words and not is_units_row(row) and all(style.kind(cell) == TEXT for cell in row)


def _listed_names(
    rows: Sequence[Sequence[str]], first: int, lines: Sequence[str], width: int, style: NumberStyle
) -> tuple[int, list[str]]:
    """The names that numbered lines before a table list, as "Sig1 Time (min)", one for each column, from 1 or 0 on; and
    the row after the last of them.
    """
    begin = max(first - HEADER_WITHIN, 0)
    texts = [lines[k] if lines else "\t".join(rows[k]) for k in range(begin, first)]
    found = [_LISTED.fullmatch(_COMMENT.sub("", text).strip()) for text in texts]
    lists: list[tuple[int, list[str]]] = []
    for last in range(len(texts), width - 1, -1):
        group = [match for match in found[last - width : last] if match and style.kind(match[3]) == TEXT]
        numbers = [int(match[2]) for match in group]
        if numbers in (list(range(1, width + 1)), list(range(width))) and len({m[1] for m in group}) == 1:
            lists.append((begin + last, [match[3].strip().strip('"') for match in group]))
    with_units = (each for each in lists if has_bracketed_units(each[1]))  # a method lists its steps, too
    return next(with_units, lists[0] if lists else (0, []))


def _has_units_of(below: Sequence[str], names: Sequence[str], columns: Sequence[str]) -> bool:
    """Whether a row has units for most columns of numbers, and names for the others, below a row of other names."""
    units = sum(map(bool, _units_in(below, columns)))
    different = len(set(filter(None, names))) == sum(map(bool, names)) >= len(columns) - 1
    return different and 2 * units > columns.count(NUMBER) and units > sum(map(is_unit, names))


def _units_in(row: Sequence[str], columns: Sequence[str]) -> list[str]:
    """The cells that are units, but for those of clocks; "" for others, such as a name that stands there too."""
    return [cell if kind != CLOCK and is_unit(_unbracketed(cell)) else "" for cell, kind in zip(row, columns)]


def _filled_from(names: Sequence[str], below: Sequence[str]) -> list[str]:
    """The names, with those of the row of units where they have none: "Time(ms)" stands there alone."""
    rest = [*below[: len(names)], *[""] * (len(names) - len(below))]
    return [name or ("" if is_units_row([cell]) else cell) for name, cell in zip(names, rest)]


def _fills(row: Sequence[str], width: int) -> bool:
    """Whether a row has cells for most columns."""
    cells = [_COMMENT.sub("", row[0]), *row[1:]] if row else []  # "# END" is one word
    cells = cells if cells and cells[0] else cells[1:] if row and row[0] else cells
    return len(cells) >= width or 2 * sum(bool(cell) for cell in cells) > width


def _names(written: Sequence[str], width: int) -> tuple[tuple[str, ...], bool]:
    """Unique names of the columns, and whether they differ from what the header's cells say."""
    cells = [without_markup(_COMMENT.sub("", cell) if k == 0 else cell) for k, cell in enumerate(written)]
    if len(cells) == width + 1 and not cells[0]:
        cells = cells[1:]
    if len(cells) > width:
        cells = with_brackets_joined(cells)
    if not cells or len([c for c in cells if c]) * 2 < min(width, len(cells)):
        cells = []
    names = [cell or f"column {k + 1}" for k, cell in enumerate(cells)]
    names += [f"column {k + 1}" for k in range(len(names), width)]
    times: Counter[str] = Counter()
    unique = []
    for name in names:
        times[name] += 1
        unique.append(name if times[name] == 1 else f"{name} ({times[name]})")
    plain = [cell or f"column {k + 1}" for k, cell in enumerate(written)]
    return tuple(unique), unique != plain


def _unbracketed(cell: str) -> str:
    match = _BRACKETED.fullmatch(cell.strip())
    return (match[1] if match else cell).strip()


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
