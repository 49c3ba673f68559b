"""How a table writes numbers, and what kind of cell a text is."""

from dataclasses import dataclass

from smarig.exchange.tables.found_table import CLOCK, NUMBER, TEXT
from smarig.exchange.text.cell_values import is_missing, is_number
from smarig.exchange.text.clock_cells import clock_seconds


@dataclass(frozen=True)
class NumberStyle:
    """How a table writes numbers: decimal sign, and what stands between thousands."""

    decimal: str = "."
    thousands: str = ""

    def kind(self, cell: str) -> str:
        """Whether a cell is a number (or a word for a missing one), a clock time or another text."""
        mixed = self.decimal == "," and "." in cell and "," not in cell and not self.thousands
        if (is_number(cell, self.decimal, self.thousands) and not mixed) or is_missing(cell):
            return NUMBER
        return CLOCK if clock_seconds(cell) is not None else TEXT
