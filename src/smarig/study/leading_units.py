"""Units that stand before the names of columns, as in "kPa Pressure", where the heads of a table agree in it."""

from collections.abc import Sequence

from smarig.exchange import FoundColumn, known_unit

_FEWEST = 2  # units that no name could be the first letter of
_WORDS = (
    "min",
    "in",
    "mil",
    "bar",
    "count",
    "counts",
    "deg",
    "grad",
    "thou",
    "inch",
    "second",
    "volt",
    "sec",
)


def leading_units(columns: Sequence[FoundColumn]) -> dict[str, str]:
    """The unit before the name of each column that has one; none unless more than half of the heads beside that of a
    clock begin with a unit, and several with one that is neither a word nor a letter.

    >>> from numpy import arange
    >>> heads = ["time", "kPa Suction", "°C Soil", "% Battery"]
    >>> leading_units([FoundColumn(head, "", arange(3.0)) for head in heads])
    {'kPa Suction': 'kPa', '°C Soil': '°C', '% Battery': '%'}
    >>> heads = ["group/Model a/Temperature [°C]", "group/Model a/Displacement [mm]"]
    >>> leading_units([FoundColumn(head, "", arange(3.0)) for head in heads])
    {}
    >>> leading_units([FoundColumn(head, "", arange(3.0)) for head in ("T wire", "V supply", "mm stroke")])
    {}
    """
    named = [c for c in columns if c.kind == "number"]
    split = {c.name: c.name.split(maxsplit=1) for c in named if not c.unit}
    found = {name: words[0] for name, words in split.items() if len(words) == 2 and _is_unit(words[0])}
    found |= {  # a quotient of units that is not known, such as mS/cm
        name: words[0]
        for name, words in split.items()
        if len(words) == 2 and name not in found and known_unit(words[0].partition("/")[2])
    }
    sure = {
        unit for unit in found.values() if known_unit(unit) and len(unit) > 1 and unit.lower() not in _WORDS
    }
    sure |= {unit for unit in found.values() if not unit.isalpha()}
    clocks = sum(len(words) == 1 for words in split.values())
    enough = len(sure) >= _FEWEST and 2 * len(found) > len(named) - min(clocks, 1)
    return found if enough else {}


def _is_unit(word: str) -> bool:
    return known_unit(word, temperature=True) != ""
