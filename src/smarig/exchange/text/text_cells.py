"""Cells of a column that hold text, as remarks and states of alarms do: they are neither numbers nor empty."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from smarig.core import Array, shown
from smarig.exchange.text.no_reading import is_missing

_LONGEST = 40  # characters of an example


@dataclass(frozen=True)
class TextCells:
    """How many cells of a column hold text, and the first of these texts."""

    number: int
    first: str


def texts_of(
    columns: Mapping[str, Array],
    cells: Mapping[str, Sequence[str]],
    marks: Mapping[str, Collection[str]],
    before: Mapping[str, TextCells] | None = None,
) -> dict[str, TextCells]:
    """The texts of the columns that hold any, added to those of the rows ``before``. ``cells`` are as they are written;
    ``marks`` by column stand for no reading.
    """
    found = dict(before or {})
    for name, values in columns.items():
        written = cells.get(name, ())
        able = [written[int(k)] for k in np.flatnonzero(np.isnan(values))] if written else []
        texts = [cell for cell in able if not is_missing(cell) and cell not in marks.get(name, ())]
        if texts:
            earlier = found.get(name, TextCells(0, texts[0]))
            found[name] = TextCells(earlier.number + len(texts), earlier.first)
    return found


def text_notes(texts: Mapping[str, TextCells], rows: int) -> list[str]:
    """Findings on the cells that hold text, with an example.

    >>> text_notes({"Remark": TextCells(1, "door open")}, 9), text_notes({"Alarm": TextCells(3, "LL")}, 3)
    (["Column 'Remark': 1 of 9 cells holds text: 'door open'."], ["Column 'Alarm': all cells hold text, as 'LL'."])
    """
    return [_note(name, found, rows) for name, found in texts.items()]


def _note(name: str, texts: TextCells, rows: int) -> str:
    hold = "holds" if texts.number == 1 else "hold"
    number = "all cells" if texts.number == rows else f"{texts.number} of {rows} cells"
    example = f"{', as' if texts.number > 1 else ':'} {shown(texts.first, _LONGEST)}"
    return f"Column {shown(name)}: {number} {hold} text{example}."
