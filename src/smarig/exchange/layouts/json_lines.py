"""Lines of JSON, one object each, as rows of a table: keys are names, null is missing, and other objects are events."""

import json
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from smarig.core import shown

_SAMPLE = 250  # lines by which a text is taken for lines of JSON


@dataclass(frozen=True)
class ObjectRows:
    """The rows of objects under the keys that most of them have, "" for one that is no row, and what was left out."""

    names: list[str]
    rows: list[str]
    notes: tuple[str, ...]


@dataclass(frozen=True)
class JsonLines:
    """The rows of a text, "" for lines that are none; ``added``: the names stand in a line before those of the file."""

    lines: list[str]
    notes: tuple[str, ...]
    added: int


def json_lines(lines: Sequence[str]) -> JsonLines | None:
    """The lines as rows of cells with the keys before them; None for a text of which most lines are no objects."""
    if not _most(lines[:_SAMPLE]) or (found := rows_of_objects([_object(line) for line in lines])) is None:
        return None
    names, rows = "\t".join(found.names), found.rows
    notes = ("Each line is an object of JSON; its keys are the names of the columns.", *found.notes)
    first = next(k for k, row in enumerate(rows) if row)
    if first:  # an event before the rows gives its line to the names
        return JsonLines([*rows[: first - 1], names, *rows[first:]], notes, 0)
    return JsonLines([names, *rows], notes, 1)


def rows_of_objects(found: Sequence[dict[str, str] | None]) -> ObjectRows | None:
    """The rows of objects, each with its cells by key; None if there is no row.

    The columns are the keys that more than half of the objects have; an object without most of them is an event.
    """
    times = Counter(key for item in found if item for key in item)
    objects = sum(bool(item) for item in found)
    names = [key for key, count in times.items() if 2 * count > objects]
    are_rows = [bool(item) and 2 * sum(name in item for name in names) > len(names) for item in found]
    if True not in are_rows:
        return None
    rows = [
        "\t".join(item.get(name, "nan") for name in names) if item and is_row else ""
        for item, is_row in zip(found, are_rows)
    ]
    return ObjectRows(names, rows, tuple(_events(found, are_rows, names)))


def _most(lines: Sequence[str]) -> bool:
    """Whether more than half of the lines that are not blank are objects."""
    used = [line for line in lines if line.strip()]
    return 2 * sum(_object(line) is not None for line in used) > len(used) > 0


def _object(line: str) -> dict[str, str] | None:
    """The cells by key of a line that is an object; those of an object within it have both keys."""
    if not line.lstrip().startswith("{"):
        return None
    try:
        found = json.loads(line, parse_float=str, parse_int=str)
    except (ValueError, RecursionError):
        return None
    return dict(flat_cells("", found)) if isinstance(found, dict) else None


def flat_cells(above: str, value: Any) -> Iterator[tuple[str, str]]:
    """The cells of a value by key; those of an object within another have both keys."""
    if isinstance(value, dict):
        for key, part in value.items():
            yield from flat_cells(f"{above}.{key}" if above else key, part)
    else:
        yield above, cell_text(value)


def cell_text(value: Any) -> str:
    """The text of a cell: "nan" for nothing and for arrays.

    >>> cell_text(None), cell_text(True), cell_text("a  b"), cell_text("1.50")
    ('nan', '1', 'a b', '1.50')
    """
    if value is None or isinstance(value, list):
        return "nan"
    return str(int(value)) if isinstance(value, bool) else " ".join(str(value).split()) or "nan"


def _events(found: Sequence[dict | None], are_rows: Sequence[bool], names: Sequence[str]) -> Iterator[str]:
    """A sentence on the objects that are no rows, and on keys that few rows have."""
    events = [item for item, is_row in zip(found, are_rows) if item and not is_row]
    keys = list(dict.fromkeys(key for item in found if item for key in item if key not in names))
    if events:
        lines = (
            "1 line is an event and no row"
            if len(events) == 1
            else f"{len(events)} lines are events and no rows"
        )
        yield f"{lines}, because most of the keys of the others are missing."
    if keys:
        listed = ", ".join(shown(key) for key in keys[:5]) + (", …" if len(keys) > 5 else "")
        yield f"Keys that few lines have are not read: {listed}."
