"""One JSON document as the lines of tables: arrays of objects or of arrays, objects of arrays, and series with columns.

A value is a table by its shape, wherever it stands; the other values of the objects around it are keys and values
before it. The lines of a file that is no such document are left to the readers of texts.
"""

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from smarig.core import shown
from smarig.exchange.layouts.json_lines import cell_text, flat_cells, rows_of_objects
from smarig.exchange.layouts.metric_series import metric_series
from smarig.exchange.text.cell_values import is_number

MOST_CHARACTERS = 100_000_000  # its numbers need ten times as many bytes while they are read
_FEWEST_ROWS = 3
_DEEPEST = 8  # values within each other
_UNITS = ("unit", "units")
_NOTE = "The file is one JSON document; lines are counted from the first line of its tables."


@dataclass(frozen=True)
class _JsonTable:
    """Names and rows of a table of a document, its units by name, and the keys and values around it."""

    names: Sequence[str]
    rows: list[str]
    units: dict[str, str]
    keys: dict[str, str]
    notes: tuple[str, ...] = ()


def json_document(text: str) -> tuple[list[str], tuple[str, ...]] | None:
    """The lines of the tables of a document, and findings; None for a text that is no document, or holds no table."""
    if not text.lstrip().startswith(("{", "[")) or len(text) > MOST_CHARACTERS:
        return None
    try:
        document = json.loads(text, parse_float=str, parse_int=str)
    except (ValueError, RecursionError):
        return None
    tables = list(_tables(document, {}))
    lines: list[str] = []
    for table in tables:
        lines += [""] if lines else []
        lines += [f"{key}: {value}" for key, value in table.keys.items()]
        lines += ["\t".join(table.names)] if table.names else []
        units = [f"[{table.units.get(name, '')}]" for name in table.names]
        lines += ["\t".join(units)] if table.units else []
        lines += table.rows
    return (lines, (_NOTE, *(note for table in tables for note in table.notes))) if lines else None


def no_table_in(text: str) -> str:
    """Why a text that begins as a JSON document gives no table, as a sentence; "" for other texts."""
    if not re.match(r'\s*(\{\s*["}]|\[\s*["\d\[{+-])', text):
        return ""
    if len(text) > MOST_CHARACTERS:
        return f"It has more than {MOST_CHARACTERS // 10**6} million characters: write one object of JSON in each line."
    try:
        json.loads(text, parse_float=str, parse_int=str)
    except json.JSONDecodeError as error:
        return f"It is no valid JSON: {error.msg} in line {error.lineno}, character {error.colno}."
    except (ValueError, RecursionError):
        return "It is no valid JSON."
    return f"It is a JSON document without an array of {_FEWEST_ROWS} rows or more."


def _tables(value: Any, keys: dict[str, str], depth: int = 0) -> Iterator[_JsonTable]:
    """The tables in a value, in order; ``keys`` stand around it."""
    if depth == _DEEPEST or not isinstance(value, dict | list):
        return
    found = _of_object(value, keys) if isinstance(value, dict) else _of_array(value, keys)
    if found is not None:
        yield found
        return
    members = list(value.values() if isinstance(value, dict) else value)
    own = keys | (_keys_of(value) if isinstance(value, dict) else {})
    for member in members:
        yield from _tables(member, own, depth + 1)


def _keys_of(value: dict[str, Any]) -> dict[str, str]:
    """What an object says beside its arrays, also in objects within it that have none."""
    plain = {key: part for key, part in value.items() if not _has_arrays(part)}
    return {key: text for key, text in flat_cells("", plain) if text != "nan"}


def _has_arrays(value: Any) -> bool:
    if isinstance(value, dict):
        return any(map(_has_arrays, value.values()))
    return isinstance(value, list)


def _of_array(value: list[Any], keys: dict[str, str]) -> _JsonTable | None:
    """The table of an array of series, of objects, or of arrays of one length: rows, or columns if these are longer."""
    if (series := metric_series(value)) and len(series.rows) >= _FEWEST_ROWS:
        around = keys | series.labels
        return _JsonTable(series.names, _written(series.rows), series.units, around, (series.note,))
    if len(value) >= _FEWEST_ROWS and all(isinstance(item, dict) for item in value):
        if any(_has_arrays(item) for item in value):
            return None  # tables of their own
        found = rows_of_objects([dict(flat_cells("", item)) for item in value])
        return _JsonTable(found.names, found.rows, {}, keys, found.notes) if found else None
    rows = _matrix(value)
    if rows is None:
        return None
    named = all(isinstance(cell, str) and not is_number(cell, ".") for cell in rows[0])
    if len(rows) < len(rows[0]) and not named:
        rows = [list(row) for row in zip(*rows)]
    names = list(map(cell_text, rows[0])) if named else []
    return _JsonTable(names, _written(rows[1:] if named else rows), {}, keys)


def _of_object(value: dict[str, Any], keys: dict[str, str]) -> _JsonTable | None:
    """The table of an object: a row of names beside rows as wide, or columns under their names."""
    own = keys | _keys_of(value)
    names = next((part for part in value.values() if _are_names(part)), [])
    for part in value.values() if names else ():
        rows = _matrix(part) if isinstance(part, list) else None
        if rows is not None and len(rows[0]) == len(names) and part is not names:
            return _JsonTable(list(map(cell_text, names)), _written(rows), {}, own)
    columns = {name: column for name, part in value.items() if (column := _column(part)) is not None}
    lengths = [len(column) for column in columns.values()]
    usual = max(set(lengths), key=lengths.count, default=0)
    notes = tuple(
        f"Array {shown(name)} has {len(column)} values, not {usual} as the others: it is not read."
        for name, column in columns.items()
        if len(column) != usual
    )
    columns = {name: column for name, column in columns.items() if len(column) == usual}
    if len(columns) < 2:
        return None
    units = {name: unit for name in columns if (unit := _unit(value[name]))}
    plain = own if not units else {k: v for k, v in own.items() if k.rsplit(".")[0] not in columns}
    return _JsonTable(list(map(cell_text, columns)), _written(zip(*columns.values())), units, plain, notes)


def _are_names(part: Any) -> bool:
    texts = isinstance(part, list) and len(part) > 1 and all(isinstance(cell, str) for cell in part)
    return texts and not any(is_number(cell, ".") for cell in part)


def _column(part: Any) -> list[Any] | None:
    """The values of a column: an array, or the one array in an object that may state its unit."""
    if isinstance(part, dict):
        arrays = [own for own in part.values() if isinstance(own, list)]
        part = arrays[0] if len(arrays) == 1 else None
    plain = isinstance(part, list) and len(part) >= _FEWEST_ROWS
    return part if plain and not any(isinstance(cell, dict | list) for cell in part) else None


def _unit(part: Any) -> str:
    found = [part[key] for key in _UNITS if key in part] if isinstance(part, dict) else []
    return cell_text(found[0]) if found and isinstance(found[0], str) else ""


def _matrix(value: list[Any]) -> list[list[Any]] | None:
    """Arrays of one length, two or more, that hold no further arrays; None for anything else."""
    if len(value) < 2 or not all(isinstance(row, list) for row in value):
        return None
    width = len(value[0])
    plain = all(len(row) == width and not any(isinstance(c, dict | list) for c in row) for row in value)
    return value if plain and width > 1 and max(len(value), width) >= _FEWEST_ROWS else None


def _written(rows: Any) -> list[str]:
    return ["\t".join(map(cell_text, row)) for row in rows]
