"""Finds columns of a heating and a cooling branch side by side in one row: names that differ in one letter."""

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from smarig.study.column_guess import ColumnGuess

_FEWEST = 2  # pairs of columns


def branch_pairs(columns: Sequence[ColumnGuess]) -> dict[str, str]:
    """The column of the second branch for each of the first; empty if the table is no such table.

    Names differ by the same letter, such as g and d, in at least two pairs; one column rises from row to row, and its
    partner falls through the same range.
    """
    by_name = {c.name: c for c in columns}
    found: dict[tuple[str, str], dict[str, str]] = defaultdict(dict)
    for a in by_name:
        for b in by_name:
            if a != b and len(a) == len(b):
                different = [(x, y) for x, y in zip(a, b) if x != y]
                if len(different) == 1:
                    found[different[0]][a] = b
    for pairs in found.values():
        similar = {a: b for a, b in pairs.items() if by_name[a].unit == by_name[b].unit}
        if len(similar) >= _FEWEST and any(_opposite(by_name[a], by_name[b]) for a, b in similar.items()):
            return similar
    return {}


def _opposite(a: ColumnGuess, b: ColumnGuess) -> bool:
    """Whether one column rises and the other falls through the same range."""
    x, y = a.facts.known, b.facts.known
    if x.size < 3 or x.size != y.size or not (np.diff(x) > 0).all() or not (np.diff(y) < 0).all():
        return False
    return bool(abs(x[-1] - y[0]) + abs(x[0] - y[-1]) < 0.1 * np.ptp(x))
