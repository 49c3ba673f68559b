"""Reads a text table as named columns of numbers: delimiter, header, encoding, broken lines.

A cell is a number, empty (NaN), or an error that names its line and column.
"""

import csv
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, DataError, UsageError, check_file, file_bytes, shown
from smarig.exchange.layouts.table_lines import table_lines
from smarig.exchange.tables.first_names import first_names
from smarig.exchange.text.cell_values import number_column
from smarig.exchange.text.clock_cells import clock_column
from smarig.exchange.text.eight_bit_text import eight_bit_text
from smarig.exchange.text.interruptions import interruption_notes
from smarig.exchange.text.no_reading import count_marks, mark_notes
from smarig.exchange.text.table_rows import (
    cells,
    footer_start,
    is_incomplete,
    is_plain_row,
    split,
    without_interruptions,
)
from smarig.exchange.text.text_cells import TextCells, text_notes, texts_of

MAX_BYTES = 500_000_000
MAX_COLUMNS = 10_000
HEADER_WITHIN = 200  # lines searched for the header
DELIMITERS = {"tab": "\t", "semicolon": ";", "comma": ",", "space": None}


@dataclass(frozen=True)
class TableLayout:
    """The layout of the text: ``known`` columns identify the header row; ``names`` are given if there is none.

    ``header_line`` is its line, from 1, where its columns do not identify it; ``units_rows`` rows under it are skipped.
    ``tables`` from the ``table``-th on are one record (0: all to the end).
    ``interruptions``: "leave out" for lines of text between the rows, which are an error otherwise.
    ``clock`` is a column of clock times; cells of ``text`` columns that are no numbers are NaN, and so are those with
    a text of ``no_reading``.
    """

    known: tuple[str, ...] = ()
    names: tuple[str, ...] = ()
    delimiter: str = ""
    decimal: str = "."
    header_starts: str = ""
    table: int = 1
    tables: int = 1
    thousands: str = ""
    header_line: int = 0
    units_rows: int = 0
    interruptions: str = "refuse"
    no_reading: tuple[str, ...] = ()
    clock: str = ""
    text: tuple[str, ...] = ()

    def first_row(self, start: int) -> int:
        """The line of the first row, from 0, if the header (or the first row without one) is in line ``start``."""
        if self.names and not self.header_line:
            return start
        return start + 1 + self.units_rows

    def column(self, path: Path, name: str, cells: Sequence[str], where: Sequence[int]) -> Array:
        """The values of a column's cells; DataError with line and column for a cell that is no number."""
        if name == self.clock:
            return clock_column(path, name, cells, where)
        return number_column(
            path,
            name,
            cells,
            where,
            self.decimal,
            thousands=self.thousands,
            lenient=name in self.text,
            no_reading=self.no_reading,
        )


@dataclass(frozen=True)
class Table:
    """Columns by name, each (n,) float64; ``line`` (n,) is the line of each row; ``notes`` are the findings.

    ``loop`` (n,) is the number of the loop of each row, if the file numbers its loops.
    """

    columns: dict[str, Array]
    line: NDArray[np.int64]
    header: dict[str, str]
    notes: tuple[str, ...]
    loop: NDArray[np.int64] | None = None

    def __len__(self) -> int:
        return self.line.size


def read_whole_table(path: Path, layout: TableLayout) -> Table:
    """Read a text table at once; UsageError if there is no file, DataError with the line if it is not a table."""
    text, notes = read_text(path)
    with long_cells_refused(path):
        log = table_lines(path, text)
        return _table(path, text, log.lines, [*notes, *log.notes], layout, log.added)


@contextmanager
def long_cells_refused(path: Path) -> Iterator[None]:
    """Turn the error of a cell in quotes that does not end into a DataError."""
    try:
        yield
    except csv.Error:
        raise DataError(
            f"{path}: a cell in quotes has more than {csv.field_size_limit()} characters. Check its quotation marks."
        ) from None


def _table(
    path: Path, text: str, lines: list[str], notes: list[str], layout: TableLayout, added: int
) -> Table:
    """The table; the first ``added`` lines are not in the file."""
    start, names, delimiter = header(path, lines, layout)
    # In a file of several tables, the preamble of a table starts after the blank line before it.
    begin = (
        max((k for k in range(start) if not lines[k].strip()), default=-1) + 1 if layout.header_starts else 0
    )
    preamble = [line for line in lines[begin:start] if line.strip()]
    first = layout.first_row(start)
    if not layout.header_starts:
        notes += preamble_notes(preamble)
    unfinished = bool(lines[-1].strip()) and not text.endswith(("\n", "\r"))
    model = split(lines[min(first, len(lines) - 1)], delimiter)
    if unfinished and is_incomplete(split(lines[-1], delimiter), model, names, layout):
        notes.append(incomplete_note(len(lines) - added))
        lines.pop()
    again = "" if layout.names and not layout.header_line else lines[start]
    if not layout.header_starts and (end := footer_start(lines, first, len(names), delimiter, layout)):
        notes.append(
            f"The lines from {end + 1 - added} on ({shown(lines[end].strip(), 40)}) stand after the table."
        )
        lines = lines[:end]
    if layout.interruptions == "leave out":
        lines, between = without_interruptions(
            lines, first, len(names), delimiter, layout, ends=bool(layout.header_starts)
        )
        notes += interruption_notes(between)
    rows, where = cells(path, lines, first, names, delimiter, bool(layout.header_starts), again)
    starts = _further_tables(path, lines, layout)
    for later in starts:
        further, lines_of_it = cells(path, lines, later, names, delimiter, True)
        rows, where = rows + further, where + lines_of_it
    if starts:
        notes.append(f"{len(starts) + 1} tables with the same columns are read as one record.")
    where = [k - added for k in where]
    if len(rows) < 2:
        raise DataError(f"{path} holds {len(rows)} sample(s). At least two are needed.")
    written = {name: [row[k] for row in rows] for k, name in enumerate(names)}
    columns = {name: layout.column(path, name, column, where) for name, column in written.items()}
    notes += missing_notes(columns, written, no_reading=layout.no_reading)
    return Table(columns, np.array(where, dtype=np.int64), preamble_keys(preamble), tuple(notes))


def _further_tables(path: Path, lines: Sequence[str], layout: TableLayout) -> list[int]:
    """The first lines of the rows of further tables of one record; DataError if there are fewer, or other columns."""
    if layout.tables == 1 or not layout.header_starts:
        return []
    starts = [k for k, line in enumerate(lines) if line.startswith(layout.header_starts)][layout.table - 1 :]
    if len(starts) < layout.tables:
        raise DataError(
            f"{path} has {len(starts)} table(s) from table {layout.table} on; the mapping joins {layout.tables}."
        )
    starts = starts[: layout.tables or None]
    other = [k for k in starts if lines[k].rstrip() != lines[starts[0]].rstrip()]
    if other:
        raise DataError(
            f"{path}, line {other[0] + 1}: this table has other columns than that in line {starts[0] + 1}, so both are "
            "not one record. Set [file] tables in the mapping."
        )
    return [layout.first_row(k) for k in starts[1:]]


def preamble_notes(preamble: Sequence[str]) -> list[str]:
    """A finding on lines before the table."""
    return [f"{len(preamble)} line(s) before the table were skipped."] if preamble else []


def preamble_keys(preamble: Sequence[str]) -> dict[str, str]:
    """The keys and values in the lines before the table."""
    return dict(_key(line) for line in preamble if ":" in line or "=" in line)


def incomplete_note(line: int) -> str:
    """A finding on a file that ends within a line."""
    return f"The last line ({line}) is incomplete and was dropped."


def missing_notes(
    columns: Mapping[str, Array],
    cells: Mapping[str, Sequence[str]] | None = None,
    texts: Mapping[str, TextCells] | None = None,
    no_reading: Collection[str] = (),
) -> list[str]:
    """Findings on cells without a number; ``cells`` as they are written, where marks and the texts ``no_reading`` may
    stand for no reading; else ``texts`` found in them, which are neither empty nor numbers.
    """
    marks = count_marks(cells or {}, no_reading)
    texts = texts_of(columns, cells or {}, marks, texts)
    counted = {name: marks[name].total() for name in marks}
    counted |= {name: counted.get(name, 0) + found.number for name, found in texts.items()}
    empty = {name: int(np.isnan(c).sum()) - counted.get(name, 0) for name, c in columns.items()}
    remarks = [name for name in texts if np.isnan(columns[name]).all()]  # need not be filled
    rows = next(iter(columns.values())).size
    return [
        *mark_notes(marks, rows),
        *text_notes(texts, rows),
        *(
            f"Column {shown(name)}: {number} of {rows} cells are empty or NaN."
            for name, number in empty.items()
            if number > 0 and name not in remarks
        ),
    ]


def read_text(path: Path) -> tuple[str, list[str]]:
    """The text of a file and findings about it; DataError for empty, binary and huge files."""
    check_file(path)
    try:
        if path.stat().st_size > MAX_BYTES:
            raise DataError(f"{path} is larger than {MAX_BYTES / 1e6:.0f} MB. Split it into smaller files.")
        data = file_bytes(path)
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror or error}.") from None
    if not data.removeprefix(b"\xef\xbb\xbf").strip(b" \t\r\n\xff\xfe"):
        raise DataError(f"{path} is empty.")
    if data.startswith((b"MATLAB 5.0", b"MATLAB 7.3")):
        raise DataError(f"{path} is a MATLAB file. Import it with --format mat and a mapping (--map).")
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return data.decode("utf-16", errors="replace"), ["The file is UTF-16 text."]
    for first, encoding in ((1, "utf-16-le"), (0, "utf-16-be")):  # without a mark; every second byte is zero
        if len(data) > 8 and data[first : 2 * HEADER_WITHIN : 2].count(0) > 0.9 * len(
            data[first : 2 * HEADER_WITHIN : 2]
        ):
            return data.decode(encoding, errors="replace"), ["The file is UTF-16 text without a mark."]
    if any(byte < 9 for byte in set(data)):
        raise DataError(f"{path} is a binary file, not a text table.")
    try:
        return data.decode("utf-8-sig"), []
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        text, encoding = eight_bit_text(data)
        return text, [f"The file is not UTF-8 (line {line}); it was read as {encoding}."]


def header(path: Path, lines: Sequence[str], layout: TableLayout) -> tuple[int, list[str], str | None]:
    """The number of the header line, from 0, the names of the columns, and the delimiter."""
    choices = [DELIMITERS[layout.delimiter]] if layout.delimiter else list(DELIMITERS.values())
    if layout.header_starts:
        found = [k for k, line in enumerate(lines) if line.startswith(layout.header_starts)]
        if len(found) < layout.table:
            raise DataError(
                f"{path} has {len(found)} table(s) whose header starts with '{layout.header_starts}'; "
                f"there is no table {layout.table}."
            )
        start = found[layout.table - 1]
    elif layout.header_line:
        start = min(layout.header_line, len(lines)) - 1
        if layout.names:
            return (
                start,
                list(layout.names),
                choices[0] if layout.delimiter else _widest(lines[start + 1 :], choices),
            )
    elif layout.names:
        return _first_numbers(path, lines, layout, choices)
    else:
        start = _best_header(path, lines, layout.known, choices)
    delimiter = max(choices, key=lambda d: _recognised(lines[start], d, layout.known))
    names = [name or f"column {k + 1}" for k, name in enumerate(split(lines[start], delimiter))]
    if len(names) > MAX_COLUMNS:
        raise DataError(f"{path} has {len(names)} columns; a table has at most {MAX_COLUMNS}.")
    twice = sorted(name for name, times in Counter(names).items() if times > 1)
    if twice:
        raise DataError(f"{path}, line {start + 1}: column {shown(twice[0])} appears more than once.")
    return start, names, delimiter


def _widest(lines: Sequence[str], choices: Sequence[str | None]) -> str | None:
    """The delimiter that splits the next lines into most cells."""
    return max(choices, key=lambda d: max((len(split(line, d)) for line in lines[:5]), default=0))


def _recognised(line: str, delimiter: str | None, known: Sequence[str]) -> tuple[int, int]:
    cells = split(line, delimiter)
    return len(set(cells) & set(known)), 0 if delimiter is None else len(cells)


def _best_header(path: Path, lines: Sequence[str], known: Sequence[str], choices: Sequence) -> int:
    scores = [
        max(_recognised(line, d, known)[0] for d in choices) if not line.startswith("#") else 0
        for line in lines[:HEADER_WITHIN]
    ]
    best = int(np.argmax(scores))
    if not scores[best]:
        listed = ", ".join(known[:6])
        raise DataError(
            f"{path} has {first_names(lines[:HEADER_WITHIN], choices)}: none of the expected columns ({listed}, …) "
            f"was found in its first {len(scores)} lines. Name the file's columns with a mapping file (--map); "
            "`smarig study` drafts one."
        )
    return best


def _first_numbers(
    path: Path, lines: Sequence[str], layout: TableLayout, choices: Sequence
) -> tuple[int, list[str], str | None]:
    for k, line in enumerate(lines[:HEADER_WITHIN]):
        rows = {d: split(line, d) for d in choices}
        numeric = {d: c for d, c in rows.items() if is_plain_row(c, layout)}
        for d, row in numeric.items():
            if len(row) == len(layout.names):
                return k, list(layout.names), d
        if numeric:
            widest = max(len(c) for c in numeric.values())
            raise DataError(
                f"{path}, line {k + 1} has {widest} columns, but the mapping names {len(layout.names)} "
                f"({', '.join(layout.names)})."
            )
    raise DataError(f"{path} has no line of {len(layout.names)} numbers in its first {HEADER_WITHIN} lines.")


def _key(line: str) -> tuple[str, str]:
    key, _, value = line.partition(":" if ":" in line else "=")
    return key.strip(), value.strip()
