"""A table found in a data file before anybody has said what its columns mean."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from smarig.core import Array
from smarig.exchange.checks.channel_faults import error_codes, lost_decimals
from smarig.exchange.checks.time_axis import unwrapped
from smarig.exchange.checks.value_bounds import check_size
from smarig.exchange.tables.text_table import Table

CLOCK, NUMBER, TEXT = "clock", "number", "text"


@dataclass(frozen=True, eq=False)
class FoundColumn:
    """A column: its name, the unit as written apart from the name ("" for none), values (n,), and kind.

    Values are NaN where no number stands; those of a ``clock`` column are seconds from its first reading. ``comment``
    is what the file writes below the unit, or the long name of a data set, "" for nothing.
    """

    name: str
    unit: str
    values: Array
    kind: str = NUMBER
    comment: str = ""


@dataclass(frozen=True, eq=False)
class FoundTable:
    """A table of a file: its columns, and ``layout``, the tables of a mapping file that describe where it stands.

    ``format`` is the reader that reads it, ``name`` tells it from others in the same file ("" if it is alone), and
    ``header`` are keys and values that stand before it. ``with_files`` are further files that belong to it.
    ``above`` are the cells of the rows above the names, the nearest first, as titles of groups of columns. ``breaks``
    are the rows, from 0, above which lines of text stand, as titles of segments. ``left_out`` are rows of
    the file that are in none of its tables, by their lines, each with the reason. ``scalars`` are single numbers of
    the record with their units, by name; ``titles`` are rows of one cell above the names.
    """

    path: Path
    format: str
    name: str
    columns: tuple[FoundColumn, ...]
    layout: dict[str, dict[str, Any]]
    header: dict[str, str]
    with_files: tuple[Path, ...] = ()
    above: tuple[tuple[str, ...], ...] = ()
    breaks: tuple[int, ...] = ()
    left_out: dict[str, str] = field(default_factory=dict)
    scalars: dict[str, tuple[float, str]] = field(default_factory=dict)
    titles: tuple[str, ...] = ()

    def __len__(self) -> int:
        return self.columns[0].values.size if self.columns else 0

    @property
    def names(self) -> tuple[str, ...]:
        """The names of its columns."""
        return tuple(column.name for column in self.columns)


def found_columns(
    path: Path,
    table: Table,
    units: dict[str, str],
    kinds: dict[str, str],
    comments: Mapping[str, str] = MappingProxyType({}),
) -> tuple[FoundColumn, ...]:
    """The columns of a table that was read, without codes of errors and numbers that lost their
    decimal sign; DataError with the line for a value that is too
    large to be measured.
    """
    for name, values in table.columns.items():
        check_size(path, name, values, table.line, marks=True)
    return tuple(
        FoundColumn(
            name,
            units.get(name, ""),
            unwrapped(np.where(error_codes(values) | lost_decimals(values), np.nan, values)),
            kinds.get(name, NUMBER),
            comments.get(name, ""),
        )
        for name, values in table.columns.items()
    )
