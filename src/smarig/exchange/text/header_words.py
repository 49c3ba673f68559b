"""Words of the lines above a table: brackets that belong to a name, and words that blanks place below a name."""

import re
from collections.abc import Sequence

from smarig.exchange.units.written_units import is_unit

ALIGNED = r"\s{2,}|\t"  # what stands between words that blanks align over their columns
UNIT_WORD = re.compile(
    r"units?|einheit(?:en)?|unit[éàa]s?|unidad(?:es)?|eenheid", re.IGNORECASE
)  # of a heading
_PLACED = re.compile(r"\S+(?: \S+)*")  # words that blanks align: one blank divides words of one cell
_LAST_BRACKET = re.compile(r"[^\s\[(].*[\[(]([^\[\]()]*)[\])]\s*")


def has_bracketed_units(row: Sequence[str]) -> bool:
    """Whether most of the cells that are filled are names with a unit in brackets behind.

    >>> has_bracketed_units(["Zeit [s]", "Kraft (Kanal 1) [N]", ""]), has_bracketed_units(["[s]", "[N]"])
    (True, False)
    """
    filled = [cell for cell in row if cell]
    units = [match for cell in filled if (match := _LAST_BRACKET.fullmatch(cell)) and is_unit(match[1])]
    return 2 * len(units) > len(filled)


def words_below(names: str, line: str, width: int) -> list[str] | None:
    """The words of a line below a line of as many names as columns, each at the name that is nearest to it, "" for
    names without one; None if the names are not that many.

    >>> words_below("Index     t      Value", "         [s]      [mW]", 3)
    ['', '[s]', '[mW]']
    """
    pattern = next((p for p in (_PLACED, re.compile(r"\S+")) if len(p.findall(names)) == width), None)
    if pattern is None or "\t" in names + line:
        return None
    places = [match.span() for match in pattern.finditer(names)]
    out = [""] * width
    for word in pattern.finditer(line):
        apart = [min(abs(word.start() - a), abs(word.end() - b)) for a, b in places]
        k = apart.index(min(apart))
        out[k] = f"{out[k]} {word[0]}".strip()
    return out


def with_brackets_joined(cells: Sequence[str]) -> list[str]:
    """Cells of a header that blanks divide, with units in brackets joined to the names before them."""
    out: list[str] = []
    for cell in cells:
        if out and (
            cell[:1] in "[("
            or out[-1].count("(") + out[-1].count("[") > out[-1].count(")") + out[-1].count("]")
        ):
            out[-1] = f"{out[-1]} {cell}"
        else:
            out.append(cell)
    return out
