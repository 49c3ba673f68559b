"""Which table a row of a damaged run file belongs to: told by its cells, because the schema may be lost."""

from collections.abc import Iterable
from typing import Any

from smarig.record import schema
from smarig.record.metadata import check_metadata, decode_json
from smarig.record.page_scan import ScannedRow

_INTEGERS = {
    "tick",
    "step",
    "counts",
    "quality",
    "index",
    "attempt",
    "void",
    "n",
}  # all other numbers are real
_COLUMNS = {"sample": schema.SAMPLE_COLUMNS, "step": schema.STEP_COLUMNS, "event": schema.EVENT_COLUMNS}
_IS_REAL = {table: [name not in _INTEGERS for name in columns] for table, columns in _COLUMNS.items()}


def placed(row: ScannedRow) -> tuple[str, Any, tuple]:
    """Table, key and row as it is read; an empty name for a row of no table of a run."""
    cells = row.cells
    if row.rowid is None:
        if len(cells) == 2 and all(isinstance(cell, str) for cell in cells):
            return "run", cells[0], cells
    elif len(cells) == len(schema.SAMPLE_COLUMNS) and _is_sample(cells):
        return "sample", row.rowid, _as_read("sample", (row.rowid, *cells[1:]))
    elif len(cells) == len(schema.STEP_COLUMNS) and _is_step(cells):
        return "step", cells[:2], _as_read("step", cells)
    elif len(cells) == len(schema.EVENT_COLUMNS) and _is_event(cells):
        return "event", row.rowid, _as_read("event", cells)
    return "", None, ()


def _as_read(table: str, cells: tuple) -> tuple:
    """The row as SQLite returns it, which stores whole numbers of real columns as integers."""
    return tuple(
        float(cell) if real and isinstance(cell, int) else cell
        for cell, real in zip(cells, _IS_REAL[table], strict=True)
    )


def _is_number(cell: Any) -> bool:
    return cell is None or (isinstance(cell, int | float))


def _is_text(cell: Any) -> bool:
    return cell is None or isinstance(cell, str)


def _is_sample(cells: tuple) -> bool:
    return all(map(_is_number, cells)) and isinstance(cells[-1], int)


def _is_step(cells: tuple) -> bool:
    kinds = (_is_text if name in ("branch", "verdict") else _is_number for name in schema.STEP_COLUMNS)
    keyed = all(isinstance(cell, int) and cell >= 0 for cell in cells[:2])
    return keyed and all(kind(cell) for kind, cell in zip(kinds, cells))


def _is_event(cells: tuple) -> bool:
    return all(map(_is_text, cells[1:])) and _is_number(cells[0]) and _is_table(cells[4])


def _is_table(text: Any) -> bool:
    try:
        return isinstance(decode_json(text or "{}"), dict)
    except (ValueError, TypeError):
        return False


def readable_keys(rows: Iterable[tuple]) -> tuple[dict[str, Any], list[str]]:
    """The keys of the description that can be read, and the names of the others."""
    meta: dict[str, Any] = {}
    lost = []
    for key, text in rows:
        try:
            value = decode_json(text)
            check_metadata({key: value})
            meta[key] = value
        except (ValueError, TypeError):
            lost.append(key)
    return meta, lost
