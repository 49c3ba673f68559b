"""Lines of a log as rows of a table: the stamps that a serial monitor writes before them, and rows of keys and values.

A serial monitor writes ``12:03:04.500 -> 23.9;0.003`` for the row ``23.9;0.003``; many microcontrollers are programmed
to write ``t=0.50 T=23.0 pos=1.043``. The stamp becomes the column "stamp", and keys become names of columns. A text
of which half of the lines or fewer are such rows stays as it is.
"""

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass

from smarig.exchange.layouts.igor_text import igor_rows, is_igor_text
from smarig.exchange.layouts.json_lines import STAMP, json_lines

_STAMPED = re.compile(r"\s*\[?(\d{1,2}:\d{2}:\d{2}(?:[.,]\d+)?)\]?\s*(?:->|→|>)\s?(.*)")
_PAIR = re.compile(
    r"([A-Za-z_µ][\w./%°µ()\[\]-]*)\s*"  # a key, "=" or ":", a value, and a sign or blanks before the next
    r"(?:=\s*([+-]?\d+,\d+(?=[\s;]|$)|[^\s,;=]+)|:\s*([^\s,;=:]+))\s*(?:[,;]\s*|(?<=\s)|$)"
)
_WITH_UNIT = re.compile(r"([+-]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][+-]?\d+)?)([A-Za-z%°µΩ]+)")
_SIGNS = ("\t", ";", ",")  # between the cells of a row, else blanks
_SAMPLE = 250  # lines by which a text is taken for a log
_NUMBER = re.compile(r"[+-]?(\d+[.,]?\d*|[.,]\d+)([eE][+-]?\d+)?")


@dataclass(frozen=True)
class LoggedRows:
    """Lines of a table; ``notes`` say what was rewritten, ``added`` lines stand before those of the file."""

    lines: list[str]
    notes: tuple[str, ...] = ()
    added: int = 0


def logged_rows(lines: Sequence[str]) -> LoggedRows:
    """The lines of a text as those of a table."""
    if is_igor_text(lines):
        return LoggedRows(igor_rows(lines))
    if found := json_lines(lines):
        return LoggedRows(found.lines, found.notes, found.added)
    stamps, rows, notes = _without_stamps(lines)
    names, rows = _without_keys(rows)
    if names:
        notes += ("The rows hold keys and values; the keys are the names of the columns.",)
    if not stamps:
        return _headed("\t".join(names), rows, rows, notes) if names else LoggedRows(rows, notes)
    sign = "\t" if names else _sign(rows)
    head = None if names else _head(rows, sign)
    out = [f"{stamps[k]}{sign}{row}" if k in stamps else row for k, row in enumerate(rows)]
    if names:
        return _headed(sign.join([STAMP, *names]), out, rows, notes)
    if head is not None:
        out[head] = f"{STAMP}{sign}{rows[head]}"
        return LoggedRows(out, notes)
    names = [f"column {k + 1}" for k in range(_width(rows, sign))]
    if sign == " ":  # which such a name contains
        out = [re.sub(r"\s+", "\t", row.strip()) for row in out]
        sign = "\t"
    return LoggedRows([sign.join([STAMP, *names]), *out], notes, 1)


def _headed(names: str, lines: list[str], rows: Sequence[str], notes: tuple[str, ...]) -> LoggedRows:
    """The lines with the names directly above the first that has a row; what was logged at the start gives its line to
    them.
    """
    first = next(k for k, row in enumerate(rows) if row)
    if not first:
        return LoggedRows([names, *lines], notes, 1)
    return LoggedRows([*[""] * (first - 1), names, *lines[first:]], notes)


def _without_stamps(lines: Sequence[str]) -> tuple[dict[int, str], list[str], tuple[str, ...]]:
    """The stamps by line, and the lines without them; none if less than half of the lines have one."""
    if not _most([k for k, line in enumerate(lines[:_SAMPLE]) if _STAMPED.fullmatch(line)], lines[:_SAMPLE]):
        return {}, list(lines), ()
    found = {k: match for k, line in enumerate(lines) if (match := _STAMPED.fullmatch(line))}
    if not _most(found, lines):
        return {}, list(lines), ()
    rows = [found[k][2] if k in found else line for k, line in enumerate(lines)]
    note = f"The time of day before each row (as of a serial monitor) is the column '{STAMP}'."
    return {k: match[1] for k, match in found.items()}, rows, (note,)


def _without_keys(lines: Sequence[str]) -> tuple[list[str], list[str]]:
    """The keys of rows of keys and values, and the lines with the values alone; no keys if few lines are so, neither at
    the beginning nor, from the first of them on, at the end.
    """
    if not any(map(_are_pairs, (lines[:_SAMPLE], lines[-_SAMPLE:]))):
        return [], list(lines)
    pairs = [_pairs(line) for line in lines]
    names = list(dict.fromkeys(name for found in pairs for name in found))
    return names, ["\t".join(found.get(name, "nan") for name in names) if found else "" for found in pairs]


def _are_pairs(sample: Sequence[str]) -> bool:
    """Whether most lines of a sample hold pairs, from the first that does."""
    able = [bool(_pairs(line)) for line in sample]
    first = able.index(True) if any(able) else 0
    return _most([k for k, is_pair in enumerate(able) if is_pair], sample[first:])


def _most(found: Collection[int], lines: Sequence[str]) -> bool:
    """Whether these are more than half of the lines that are not blank."""
    return 2 * len(found) > sum(bool(line.strip()) for line in lines)


def _pairs(line: str) -> dict[str, str]:
    """The values by key of a line that holds two or more pairs and nothing else; units stand in brackets."""
    text, found, at = line.strip(), dict[str, str](), 0
    while at < len(text) and (match := _PAIR.match(text, at)):
        value = match[2] or match[3]
        with_unit = _WITH_UNIT.fullmatch(value)
        found[f"{match[1]} [{with_unit[2]}]" if with_unit else match[1]] = (
            with_unit[1] if with_unit else value
        )
        at = match.end()
    return found if at == len(text) and len(found) > 1 else {}


def _sign(rows: Sequence[str]) -> str:
    """What divides the cells of most rows: the sign that most of them hold, or a blank."""
    times = {sign: sum(sign in row for row in rows) for sign in _SIGNS}
    return next((sign for sign in _SIGNS if 2 * times[sign] > len(rows)), " ")


def _cells(row: str, sign: str) -> list[str]:
    return [cell.strip() for cell in row.split(None if sign == " " else sign)]


def _first_numbers(rows: Sequence[str], sign: str) -> int:
    """The first line of numbers, 0 if there is none."""
    numeric = (
        k for k, row in enumerate(rows) if row.strip() and all(map(_NUMBER.fullmatch, _cells(row, sign)))
    )
    return next(numeric, 0)


def _width(rows: Sequence[str], sign: str) -> int:
    return len(_cells(rows[_first_numbers(rows, sign)], sign))


def _head(rows: Sequence[str], sign: str) -> int | None:
    """The line of the names: the last before the numbers with as many cells, none of them a number."""
    width = _width(rows, sign)
    for k in range(_first_numbers(rows, sign) - 1, -1, -1):
        cells = _cells(rows[k], sign)
        if len(cells) == width and all(cells) and not any(map(_NUMBER.fullmatch, cells)):
            return k
    return None
