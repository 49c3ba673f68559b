"""Reads sheets of Excel workbooks (.xlsx) with openpyxl, row by row, within limits of size.

python-calamine is some twenty times faster, but allocates the whole rectangle of a sheet: two distant cells in a small
file would take all memory.
"""

import re
import zipfile
from collections.abc import Iterator, Sequence
from dataclasses import replace
from datetime import datetime, time, timedelta
from pathlib import Path
from typing import Any

import numpy as np

from smarig.core import Array, DataError, UsageError, shown
from smarig.exchange.binary.needed_package import needed_package
from smarig.exchange.layouts.table_lines import sheet_rows
from smarig.exchange.mappings.mapping import MappingFile, require_columns
from smarig.exchange.mappings.mapping_layouts import WorkbookLayout
from smarig.exchange.tables.found_table import CLOCK, NUMBER, FoundTable, found_columns
from smarig.exchange.tables.lost_rows import without_lost_rows
from smarig.exchange.tables.table_structure import FoundBlock, NumberStyle, find_blocks, rows_above
from smarig.exchange.tables.text_table import Table, missing_notes, preamble_keys
from smarig.exchange.text.cell_values import number_column
from smarig.exchange.text.clock_cells import clock_column
from smarig.exchange.text.table_rows import rows_end

MAX_UNPACKED = 400_000_000  # bytes of all parts: a small file may unpack to more than the memory
MAX_CELLS = 20_000_000
MAX_SHEETS = 200
_STYLE = NumberStyle()
_COMMA = re.compile(r"^[+-]?(\d{1,3}(\.\d{3})+|\d+),\d+([eE][+-]?\d+)?$")
_COMMA_THOUSANDS = re.compile(r"[+-]?\d{1,3}(,\d{3})+\.\d+")
_Rows = list[list[str]]


def workbook_tables(path: Path) -> list[FoundTable]:
    """The tables of all sheets, the first of each; DataError if there is none."""
    found: list[FoundTable] = []
    refused: dict[str, DataError] = {}
    sheets = list(_sheets(path))
    for title, written in sheets:
        try:
            rows, _ = sheet_rows(path, written)
        except DataError as error:
            refused[title] = error
            continue
        blocks = find_blocks(rows, _STYLE)
        if blocks:
            found.append(_found(path, title, rows, max(blocks, key=lambda b: b.stop - b.first), len(sheets)))
    if not found and refused:
        raise next(iter(refused.values()))
    if not found:
        raise DataError(
            f"{path} holds no table: no sheet has rows of numbers. Give a workbook of measured columns."
        )
    left_out = {title: str(error) for title, error in refused.items()}
    return [replace(found[0], left_out=left_out), *found[1:]]


def read_workbook(path: Path, mapping: MappingFile, layout: WorkbookLayout) -> Table:
    """The columns of a sheet; UsageError for a missing sheet, ConfigError for other columns, DataError with the row."""
    sheets = dict(_sheets(path, layout.sheet))
    if layout.sheet not in sheets:
        raise UsageError(f"{path} has no sheet {shown(layout.sheet)}. Its sheets are: {', '.join(sheets)}.")
    rows, done = sheet_rows(path, sheets[layout.sheet])
    header = rows[layout.header_row - 1] if 0 < layout.header_row <= len(rows) else []
    names = layout.names or tuple(cell or f"column {k + 1}" for k, cell in enumerate(header))
    require_columns(mapping, list(names), path)
    clock = mapping.time.column if mapping.time and mapping.time.written == "clock" else ""
    first = layout.header_row + layout.units_rows
    stop = rows_end(rows, first, _STYLE)
    table = _table(path, rows, first, stop, names, clock, tuple(mapping.ignore), layout.no_reading)
    return replace(table, notes=(*done, *table.notes, *_footer_notes(rows, stop)))


def _footer_notes(rows: _Rows, stop: int) -> list[str]:
    """A finding on rows below the table."""
    filled = [k for k in range(stop, len(rows)) if rows[k]]
    if not filled:
        return []
    text = shown(" ".join(rows[filled[0]]), 40)
    return [f"The rows from {filled[0] + 1} on ({text}) stand after the table."]


def _table(
    path: Path,
    rows: _Rows,
    first: int,
    stop: int,
    names: Sequence[str],
    clock: str,
    text: Sequence[str],
    no_reading: Sequence[str],
) -> Table:
    data = [(k + 1, row) for k, row in enumerate(rows[first:stop], first) if any(row[: len(names)])]
    where = [k for k, _ in data]
    if len(data) < 2:
        raise DataError(f"{path} holds {len(data)} sample(s). At least two are needed.")
    columns: dict[str, Array] = {}
    written = {name: [row[k] if k < len(row) else "" for _, row in data] for k, name in enumerate(names)}
    for name, cells in written.items():
        read = clock_column if name == clock else None
        columns[name] = (
            read(path, name, cells, where)
            if read
            else number_column(path, name, cells, where, ".", lenient=name in text, no_reading=no_reading)
        )
    header = preamble_keys([": ".join(cell for cell in row if cell) for row in rows[: max(first - 1, 0)]])
    notes = missing_notes(columns, written, no_reading=no_reading)
    return without_lost_rows(Table(columns, np.array(where, dtype=np.int64), header, tuple(notes)))


def _found(path: Path, title: str, rows: _Rows, block: FoundBlock, sheets: int) -> FoundTable:
    kinds = dict(zip(block.names, block.kinds))
    clock = next((name for name, kind in kinds.items() if kind == CLOCK), "")
    text = [name for name, kind in kinds.items() if kind != NUMBER and name != clock]
    table = _table(path, rows, block.first, block.stop, block.names, clock, text, block.no_reading)
    header = -1 if block.header is None else block.header
    entries: dict[str, Any] = {"sheet": title, "header_row": header + 1}
    if block.own_names or block.header is None:
        entries["names"] = list(block.names)
    if block.no_reading:
        entries["no_reading"] = list(block.no_reading)
    if skipped := block.first - header - 1:
        entries["units_rows"] = skipped
    return FoundTable(
        path=path,
        format="xlsx",
        name=title if sheets > 1 else "",
        columns=found_columns(
            path,
            table,
            dict(zip(block.names, block.units)),
            kinds,
            dict(zip(block.names, block.comments)),
        ),
        layout={"workbook": entries},
        header=table.header,
        above=rows_above(rows[: max(header, 0)], block),
        titles=tuple(row[0] for row in rows[: max(header, 0)] if len(row) == 1),
    )


def _sheets(path: Path, only: str | None = None) -> Iterator[tuple[str, _Rows]]:
    """Titles and rows of the sheets; without rows for all but ``only``, if it is given."""
    openpyxl = needed_package("openpyxl", path, "an Excel workbook")
    _check_size(path)
    try:
        book = openpyxl.load_workbook(path, read_only=True, data_only=True, keep_links=False)
        try:
            cells = 0
            for sheet in book.worksheets[:MAX_SHEETS]:
                rows: _Rows = []
                for row in sheet.iter_rows(values_only=True) if only in (None, sheet.title) else ():
                    cells += len(row)
                    if cells > MAX_CELLS:
                        raise DataError(f"{path} has more than {MAX_CELLS // 10**6} million cells. Split it.")
                    rows.append(_texts(row))
                yield sheet.title, _with_points(rows)
        finally:
            book.close()
    except (DataError, MemoryError):
        raise
    except Exception as error:  # openpyxl raises whatever a damaged part leads to
        raise DataError(
            f"{path} is no workbook that can be read, or is damaged ({type(error).__name__}). Save it again as .xlsx."
        ) from None


def _check_size(path: Path) -> None:
    try:
        with zipfile.ZipFile(path) as parts:
            unpacked = sum(part.file_size for part in parts.infolist())
            names = {part.filename for part in parts.infolist()}
    except Exception:  # zipfile raises whatever a damaged directory leads to, such as a name that is no UTF-8
        raise DataError(f"{path} is no workbook (.xlsx), or is damaged. Save it again as .xlsx.") from None
    if unpacked > MAX_UNPACKED:
        raise DataError(
            f"{path} unpacks to {unpacked / 1e6:.0f} MB, more than {MAX_UNPACKED // 10**6} MB. Split it."
        )
    if not any(name.startswith("xl/") for name in names):
        raise DataError(f"{path} is a ZIP file, but no Excel workbook. Unpack it and give the files in it.")


def _texts(row: Sequence[Any]) -> list[str]:
    """The cells of a row as text, without trailing empty ones."""
    cells = [_text(value) for value in row]
    while cells and not cells[-1]:
        cells.pop()
    return cells


def _with_points(rows: _Rows) -> _Rows:
    """The rows with the decimal point in numbers that are texts with a decimal comma; numbers of Excel have none.

    >>> _with_points([["T", "1,50"], ["1.234,5", "2.5"]]), _with_points([["1,234", "1,234.5"]])
    ([['T', '1.50'], ['1234.5', '2.5']], [['1,234', '1,234.5']])
    """
    if any(_COMMA_THOUSANDS.fullmatch(cell) for row in rows for cell in row):
        return rows
    return [[_COMMA.sub(_pointed, cell) if "," in cell else cell for cell in row] for row in rows]


def _pointed(match: re.Match[str]) -> str:
    return match[0].replace(".", "").replace(",", ".")


def _text(value: Any) -> str:
    match value:
        case None:
            return ""
        case bool():
            return str(value)
        case float() | int():
            return repr(float(value)) if isinstance(value, float) else str(value)
        case datetime():
            return value.isoformat(sep=" ")
        case time():
            return value.isoformat()
        case timedelta():
            return repr(value.total_seconds())
    return str(value).strip()
