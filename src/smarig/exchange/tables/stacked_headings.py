"""Names above a row that holds only units: one row, or two that combine, as "Temperatur" over "Draht" and "Ofen"."""

from collections.abc import Sequence
from dataclasses import dataclass

from smarig.exchange.units.written_units import is_units_row, known_unit


@dataclass(frozen=True)
class StackedHeading:
    """The row of the names (that below it holds the units), its cells, and whether two rows were ``combined``."""

    row: int
    names: list[str]
    combined: bool


def stacked_heading(rows: Sequence[Sequence[str]], kinds: Sequence[str], first: int) -> StackedHeading | None:
    """The names over a row of units that stands directly above the first row of numbers; None unless each column with a
    unit has a name.

    Two rows are combined where the nearer one leaves columns out, and the other leaves some out or calls several the
    same. A name over several columns stands in the first of them: it goes on to columns of the same unit.
    """
    below = first - 1
    if below < 1 or kinds[below] != "text" or len(rows[below]) < 2 or not is_units_row(rows[below]):
        return None
    units = rows[below]
    measured = [j for j, unit in enumerate(units) if unit]
    near = _names(rows, kinds, below - 1, len(units))
    if near is None:
        return None
    if all(near[j] for j in measured):
        return StackedHeading(below - 1, near, False)
    over = _names(rows, kinds, below - 2, len(units))
    if over is None or len({over[j] for j in measured} - {""}) == len(measured):
        return None
    names = [f"{a} {b}".strip() for a, b in zip(_continued(over, near, units), near)]
    return StackedHeading(below - 1, names, True) if all(names[j] for j in measured) else None


def _names(rows: Sequence[Sequence[str]], kinds: Sequence[str], k: int, width: int) -> list[str] | None:
    """The cells of a row of names, as many as there are units; None for a row that is none."""
    if k < 0 or kinds[k] != "text" or is_units_row(rows[k]):
        return None
    return [*rows[k], *[""] * width][:width]


def _continued(over: Sequence[str], near: Sequence[str], units: Sequence[str]) -> list[str]:
    """The upper names, each up to the last column of its group."""
    out = list(over)
    for j in range(1, len(out)):
        same = (known_unit(units[j]) or units[j]) == (known_unit(units[j - 1]) or units[j - 1])
        if not out[j] and near[j] and near[j - 1] and same:
            out[j] = out[j - 1]
    return out
