"""Lines of JSON, one object each, as rows of a table: keys are names, null is missing, and other objects are events.

A program that listens to messages writes the time of each, and the topic under which it came, before the object. The
time becomes the column "stamp"; the rows are the objects of the topic that has most of them.
"""

import json
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from smarig.core import shown

STAMP = "stamp"  # name of the column of times that stand before what was logged
_CLOCK = re.compile(
    r"\[?((?:\d{4}-\d\d-\d\d[T ])?\d{1,2}:\d\d:\d\d(?:[.,]\d+)?(?:Z|[+-]\d\d:?\d\d)?|"
    r"\d+(?:\.\d+)?)\]?(?=[\s:]|$)[\s:]*"
)
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


@dataclass(frozen=True)
class _Message:
    """A line that ends in an object: the topic before it, "" for none, and its cells with the time of the line."""

    topic: str
    cells: dict[str, str]


def json_lines(lines: Sequence[str]) -> JsonLines | None:
    """The lines as rows of cells with the keys before them; None for a text of which most lines are no objects."""
    if not _most(lines[:_SAMPLE]):
        return None
    messages = [_message(line) for line in lines]
    objects, of_topic = _of_one_topic(messages)
    if (found := rows_of_objects(objects)) is None:
        return None
    names, rows = "\t".join(found.names), found.rows
    notes = (
        "Each line is an object of JSON; its keys are the names of the columns.",
        *of_topic,
        *found.notes,
    )
    first = next(k for k, row in enumerate(rows) if row)
    if first:  # an event before the rows gives its line to the names
        return JsonLines([*rows[: first - 1], names, *rows[first:]], notes, 0)
    return JsonLines([names, *rows], notes, 1)


def _of_one_topic(messages: Sequence[_Message | None]) -> tuple[list[dict[str, str] | None], tuple[str, ...]]:
    """The objects of the topic that has most of them, those of one number as the one with more keys, and a sentence on
    the others.
    """
    keys = {message.topic: len(message.cells) for message in messages if message}
    lines = Counter(message.topic for message in messages if message)
    main = max(lines, key=lambda topic: (lines[topic], keys[topic]), default="")
    objects = [message.cells if message and message.topic == main else None for message in messages]
    if len(lines) < 2:
        return objects, ()
    others = [f"{shown(topic)} ({count})" for topic, count in lines.items() if topic != main]
    left_out = ", ".join(others[:5]) + (", …" if len(others) > 5 else "")
    return objects, (f"The rows are the objects after {shown(main)}; left out are the lines of {left_out}.",)


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
    """Whether more than half of the lines that are not blank are objects, of fewer topics than lines."""
    used = [line for line in lines if line.strip()]
    found = [message for message in map(_message, used) if message is not None]
    topics = {message.topic for message in found}
    return 2 * len(found) > len(used) > 0 and (topics == {""} or 2 * len(topics) <= len(found))


def _message(line: str) -> _Message | None:
    """A line that ends in an object; the cells of an object within it have both keys."""
    start = line.find("{")
    if start < 0:
        return None
    try:
        found = json.loads(line[start:], parse_float=str, parse_int=str)
    except (ValueError, RecursionError):
        return None
    if not isinstance(found, dict):
        return None
    before = line[:start].strip()
    clock = _CLOCK.match(before)
    cells = dict(flat_cells("", found))
    stamp = {STAMP: clock[1]} if clock and STAMP not in cells else {}
    return _Message(before[clock.end() :].strip() if clock else before, stamp | cells)


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
