"""The rows above the numbers of a table: which of them holds the names, which the units, and lists of names.

Names and units may be divided by another sign than the numbers: what counts is that there are as many as columns.
"""

import re
from collections import Counter
from collections.abc import Sequence

from smarig.exchange.tables.found_table import CLOCK, NUMBER, TEXT
from smarig.exchange.tables.number_style import NumberStyle
from smarig.exchange.tables.text_table import HEADER_WITHIN
from smarig.exchange.text.header_words import ALIGNED, UNIT_WORD, has_bracketed_units, with_brackets_joined
from smarig.exchange.units.written_units import is_unit, is_units_row, without_markup

HEADER_ROWS = 4  # rows above the numbers that are searched for names and units
_COMMENT = re.compile(r"^\s*(?:#+|%+|//+|;+|\*+)\s*")
_NUMBERS = re.compile(r"\d+")
_KEY = re.compile(r"#[A-Z]\d*\s+(?=\S)")  # "#N 2" and "#L Field  Moment", where each line begins with its key
# Between the names of columns, the rarest in a name first:
_HEADER_SIGNS = (ALIGNED, ";", ",", r"\|", r"\s+")
# Sig1 Time (min); # 2: Force [N]
_LISTED = re.compile(r"(\D{0,40}?)\s*(\d{1,4})\s*(?:[:=.)\]\t,;]|\s)\s*(\S.*)")
# In the first cell of a row, as plotting programs write them:
_NAMES_LABEL = re.compile(
    r"(?:long[ _]?|column[ _]?|channel[ _]?)?names?|langname|bezeichnung|noms?", re.IGNORECASE
)
_BRACKETED = re.compile(r"[\[(<{](.*)[\])>}]")


def header_cells(
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
    for k in range(first - 1, max(first - 3 - HEADER_ROWS, -1), -1):
        if kinds[k] == "data":
            break
        if kinds[k] == "blank":
            continue
        line = lines[k] if lines else rows[k][0] if len(rows[k]) == 1 else ""
        row, keyed = rows[k], bool(lines) and _is_keyed(lines, k)
        if keyed:
            line = _KEY.sub("", line)
            row = line.split()
        signs = _HEADER_SIGNS if nearest else _HEADER_SIGNS[:1]
        if words := _words(row, line, width, signs, style) or (row if keyed and len(row) == width else None):
            found[k] = words
        nearest = nearest and is_units_row(found.get(k, rows[k]))
    return found


def _is_keyed(lines: Sequence[str], k: int) -> bool:
    """Whether a line of comment begins with its key, as the line above it does: "#T" alone may be a name."""
    return k > 0 and all(_KEY.match(line) for line in lines[k - 1 : k + 1])


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
        unlike = sign == ALIGNED or len(set(words)) == width or is_units_row(words)
        if len(words) == width and plain and unlike:
            return words
    return None


def header_rows(
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
    if (labelled := _labelled_rows(rows, kinds, first)) is not None:
        return labelled
    above = _rows_above(rows, kinds, first, width)
    wide = [k for k in above if _fills(rows[k], width) or is_units_row(rows[k])]
    if wide and len(rows[wide[0]]) < width and kinds[first - 1] == "text" and wide[0] < first - 1:
        return (
            None,
            None,
        )  # words of a start-up message, as another stands below them and they name fewer columns
    if not wide:
        return None, None
    for k, before in zip(wide, wide[1:]):
        near = all(kinds[i] == "blank" for i in range(before + 1, k))
        if near and is_units_row(rows[k]) and not is_units_row(rows[before]):
            full = [i for i in wide if i <= before and names_each(rows[i], width, style)]
            each = _naming(rows, full) if full else before
            return (each if "blank" not in kinds[each:before] else before), k
    named = [k for k in wide if has_bracketed_units(rows[k])]
    if named and named[0] != wide[0] and not is_units_row(rows[wide[0]]):
        return named[0], None  # what stands below the names describes the channels
    complete = [k for k in wide if names_each(rows[k], width, style) and "blank" not in kinds[k : wide[0]]]
    names = names_each(rows[wide[0]][:width], width, style)
    if complete and (not names or (complete[0] == wide[0] != _naming(rows, complete))):
        units = [sum(map(bool, units_in(rows[k], columns))) for k in complete]
        below = complete[1:] == [complete[0] - 1] and units[0] > units[1]
        named = complete[1] if below else _naming(rows, complete)
        return named, named + 1 if any(units_in(rows[named + 1], columns)) else None
    if len(wide) > 1 and wide[1] == wide[0] - 1 and _has_units_of(rows[wide[0]], rows[wide[1]], columns):
        return wide[1], wide[0]
    return wide[0], None


def _labelled_rows(rows: Sequence[Sequence[str]], kinds: Sequence[str], first: int) -> tuple[int, int] | None:
    """The rows of names and units next to each other, if words in their first cells say so, as "Long Name" and "Units";
    rows of other labels, as "Comments" and "F(x)=", may follow.
    """
    for k in range(first - 1, 0, -1):
        if kinds[k] == "data":
            break
        starts = [row[0].rstrip(" :=") if row else "" for row in rows[k - 1 : k + 1]]
        if _NAMES_LABEL.fullmatch(starts[0]) and UNIT_WORD.fullmatch(starts[1]):
            return k - 1, k
    return None


def _rows_above(rows: Sequence[Sequence[str]], kinds: Sequence[str], first: int, width: int) -> list[int]:
    """The nearest rows of text above the numbers, the nearest first; rows that are as wide as the table without a gap
    are all its own, however many describe its channels.
    """
    above: list[int] = []
    for k in range(first - 1, -1, -1):
        own = bool(above) and above[-1] == k + 1 and len(rows[k]) == width == len(rows[k + 1])
        if kinds[k] == "data" or (not own and k < first - 1 - HEADER_ROWS):
            break
        if kinds[k] == "text" and (own or len(above) < HEADER_ROWS):
            above.append(k)
    return above


def _naming(rows: Sequence[Sequence[str]], complete: Sequence[int]) -> int:
    """The row of names among those that have a word for each column, the nearest first: the first of them in the file
    with most words if the nearest only numbers the columns, as "Channel 1", "Channel 2" beside a clock do.
    """
    nearest = rows[complete[0]]
    numbers = _words_of(nearest) <= 2 < len(nearest)
    return max(complete, key=lambda k: (_words_of(rows[k]), -k)) if numbers else complete[0]


def _words_of(row: Sequence[str]) -> int:
    """The number of different words in a row, whatever their numbers."""
    return len({_NUMBERS.sub("", cell) for cell in row})


def names_each(row: Sequence[str], width: int, style: NumberStyle) -> bool:
    """Whether a row has a word of its own for each column, that is no number and no unit."""
    words = len(row) == width == len(set(row)) and all(row)
    return words and not is_units_row(row) and all(style.kind(cell) == TEXT for cell in row)


def has_cells(row: Sequence[str], width: int) -> bool:
    """Whether a row has as many cells as there are columns, a sign of comments not counted."""
    return len(row) == width and (not row[0] or bool(_COMMENT.sub("", row[0])))


def listed_names(
    rows: Sequence[Sequence[str]],
    kinds: Sequence[str],
    first: int,
    lines: Sequence[str],
    width: int,
    style: NumberStyle,
) -> tuple[int, list[str]]:
    """The names that numbered lines before a table list, as "Sig1 Time (min)", one for each column, from 1 or 0 on; and
    the row after the last of them. Rows of a table before it are none.
    """
    near = range(max(first - HEADER_WITHIN, 0), first)
    begin = max((k + 1 for k in near if kinds[k] == "data"), default=near.start)
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
    units = sum(map(bool, units_in(below, columns)))
    different = len(set(filter(None, names))) == sum(map(bool, names)) >= len(columns) - 1
    return different and 2 * units > columns.count(NUMBER) and units > sum(map(is_unit, names))


def units_in(row: Sequence[str], columns: Sequence[str]) -> list[str]:
    """The cells that are units, but for those of clocks; "" for others, such as a name that stands there too."""
    return [cell if kind != CLOCK and is_unit(unbracketed(cell)) else "" for cell, kind in zip(row, columns)]


def stated_units(
    row: Sequence[str], names: Sequence[str], columns: Sequence[str], style: NumberStyle
) -> Sequence[str]:
    """The units in a row below the names: all its cells if it is one of units, and where most of them are units, the
    other words below names too, each a unit that is not known.
    """
    if is_units_row(row):
        return row
    known = units_in(row, columns)
    named = [bool(cell and name) for cell, name in zip(row, names)]
    if 2 * sum(map(bool, known)) <= sum(named):
        return known
    words = [n and kind != CLOCK and style.kind(cell) == TEXT for cell, n, kind in zip(row, named, columns)]
    return [cell if word else unit for cell, word, unit in zip(row, words, known)]


def filled_from(names: Sequence[str], below: Sequence[str]) -> list[str]:
    """The names, with those of the row of units where they have none: "Time(ms)" stands there alone."""
    rest = [*below[: len(names)], *[""] * (len(names) - len(below))]
    return [name or ("" if is_units_row([cell]) else cell) for name, cell in zip(names, rest)]


def _fills(row: Sequence[str], width: int) -> bool:
    """Whether a row has cells for most columns."""
    cells = [_COMMENT.sub("", row[0]), *row[1:]] if row else []  # "# END" is one word
    cells = cells if cells and cells[0] else cells[1:] if row and row[0] else cells
    return len(cells) >= width or 2 * sum(bool(cell) for cell in cells) > width


def unique_names(written: Sequence[str], width: int) -> tuple[tuple[str, ...], bool]:
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


def unbracketed(cell: str) -> str:
    match = _BRACKETED.fullmatch(cell.strip())
    return (match[1] if match else cell).strip()
