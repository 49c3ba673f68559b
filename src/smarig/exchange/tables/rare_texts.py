"""Texts in few cells of a column of numbers, as an instrument writes them on a failure: they stand for no reading."""

import re
from collections.abc import Sequence

from smarig.exchange.checks.value_bounds import FEW
from smarig.exchange.tables.found_table import CLOCK, NUMBER, TEXT
from smarig.exchange.tables.number_style import NumberStyle

_NO_NUMBER = re.compile(r"[\W_]*[^\W\d_].*|\D+")  # no number in another style, as 1.234,5 or 12 mm may be


def rare_texts(cells: Sequence[str], style: NumberStyle) -> tuple[str, ...]:
    """The different texts of a column whose other cells are numbers; none if they are more than a few.

    >>> rare_texts([*["1.5"] * 99, "Err"], NumberStyle()), rare_texts([*["1.5"] * 99, "1,5 mm"], NumberStyle())
    (('Err',), ())
    >>> rare_texts(["1.5", "off"], NumberStyle())
    ()
    """
    kinds = {cell: style.kind(cell) for cell in set(cells) if cell}
    texts = [cell for cell in cells if kinds.get(cell) == TEXT]
    if CLOCK in kinds.values() or NUMBER not in kinds.values() or len(texts) > FEW * len(cells):
        return ()
    return tuple(dict.fromkeys(texts)) if all(map(_NO_NUMBER.fullmatch, texts)) else ()
