"""Columns as they are shown to be typed: by name, or by number where a name holds signs that nobody can type."""

import re

from smarig.core import shown
from smarig.exchange import FoundTable

_NUMBERED = re.compile(r"column (\d{1,9})")
_LOST = "\N{REPLACEMENT CHARACTER}"  # in place of bytes that are no text
_MOST_LISTED = 12


def typed_name(table: FoundTable, name: str) -> str:
    """The name of a column, or "column 3" for one that cannot be typed: with control signs, or lost ones."""
    typed = name.isprintable() and _LOST not in name and name.strip() == name != ""
    return name if typed else f"column {table.names.index(name) + 1}"


def own_name(table: FoundTable, name: str) -> str:
    """The name of a column of the table that is given by its number; any other name as it is."""
    match = _NUMBERED.fullmatch(name)
    if name in table.names or match is None or not 0 < int(match[1]) <= len(table.names):
        return name
    return table.names[int(match[1]) - 1]


def listed_names(table: FoundTable) -> str:
    """The first columns, each as it is typed, for a message."""
    return ", ".join(shown(typed_name(table, name)) for name in table.names[:_MOST_LISTED])
