"""Lines of JSON, one object each, as rows of a table: keys are names, null is missing, and other objects are events."""

import json
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from smarig.core import shown

_SAMPLE = 250  # lines by which a text is taken for lines of JSON


@dataclass(frozen=True)
class JsonLines:
    """The rows of a text, "" for lines that are none; ``added``: the names stand in a line before those of the file."""

    lines: list[str]
    notes: tuple[str, ...]
    added: int


def json_lines(lines: Sequence[str]) -> JsonLines | None:
    """The lines as rows of cells with the keys before them; None for a text of which most lines are no objects.

    The columns are the keys that more than half of the objects have; an object without most of them is an event.
    """
    if not _most(lines[:_SAMPLE]):
        return None
    found = [_object(line) for line in lines]
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
    notes = (
        "Each line is an object of JSON; its keys are the names of the columns.",
        *_events(found, are_rows, names),
    )
    first = are_rows.index(True)
    if first:  # an event before the rows gives its line to the names
        return JsonLines([*rows[: first - 1], "\t".join(names), *rows[first:]], notes, 0)
    return JsonLines(["\t".join(names), *rows], notes, 1)


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
    return dict(_cells("", found)) if isinstance(found, dict) else None


def _cells(above: str, value: Any) -> Iterator[tuple[str, str]]:
    if isinstance(value, dict):
        for key, part in value.items():
            yield from _cells(f"{above}.{key}" if above else key, part)
    elif value is None or isinstance(value, list):
        yield above, "nan"
    else:
        yield above, str(int(value)) if isinstance(value, bool) else " ".join(str(value).split()) or "nan"


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
