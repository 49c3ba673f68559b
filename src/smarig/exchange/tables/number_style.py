"""How a table writes numbers, and what kind of cell a text is."""

from dataclasses import dataclass
from functools import lru_cache

from smarig.exchange.tables.found_table import CLOCK, NUMBER, TEXT
from smarig.exchange.text.cell_values import is_number
from smarig.exchange.text.clock_cells import clock_seconds
from smarig.exchange.text.no_reading import is_missing

_SHORT = 40  # characters: of a cell whose kind is kept, since several styles and readers ask for it


@dataclass(frozen=True)
class NumberStyle:
    """How a table writes numbers: decimal sign, and what stands between thousands."""

    decimal: str = "."
    thousands: str = ""

    def kind(self, cell: str) -> str:
        """Whether a cell is a number (or a word for a missing one), a clock time or another text."""
        of = _kind if len(cell) <= _SHORT else _kind.__wrapped__
        return of(cell, self.decimal, self.thousands)


@lru_cache(maxsize=20_000)
def _kind(cell: str, decimal: str, thousands: str) -> str:
    mixed = decimal == "," and "." in cell and "," not in cell and not thousands
    if (is_number(cell, decimal, thousands) and not mixed) or is_missing(cell):
        return NUMBER
    return CLOCK if clock_seconds(cell) is not None else TEXT
