"""Finds columns of a heating and a cooling branch side by side in one row: names that differ in one letter, or by two
opposite words beside an input that goes one way, or that are written twice above an input that goes and comes back.
"""

import re
from collections import defaultdict
from collections.abc import Mapping, Sequence

import numpy as np

from smarig.core import Array
from smarig.study import quantity_words as q
from smarig.study.column_guess import ColumnGuess, as_temperature
from smarig.study.input_turns import wide_turns

_FEWEST = 2  # pairs of columns
_FEWEST_ROWS = 3  # of a branch
_APART = 0.1  # of the range: how far the ends of two branches of one loop lie apart
_RISING_FALLING = (
    ("heating", "cooling"),
    ("heat", "cool"),
    ("up", "down"),
    ("increasing", "decreasing"),
    ("rising", "falling"),
    ("ascending", "descending"),
)
_THERE_AND_BACK = (  # the first is swept as the rows go
    ("forth", "back"),
    ("forward", "backward"),
    ("forward", "back"),
    ("forward", "reverse"),
    ("fwd", "bwd"),
    ("fwd", "rev"),
)


def branch_pairs(columns: Sequence[ColumnGuess]) -> dict[str, str]:
    """The column of the second branch for each of the first; empty if the table is no such table.

    Names differ by the same letter, such as g and d, in at least two pairs; one column rises from row to row, and its
    partner falls through the same range.
    """
    by_name = {c.name: c for c in columns if c.facts.kind != "text"}
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
    return comes_back(x, y)


def comes_back(x: Array, y: Array) -> bool:
    """Whether ``y`` goes from the end of ``x`` back to its start."""
    return bool(abs(x[-1] - y[0]) + abs(x[0] - y[-1]) < _APART * np.ptp(x))


def branches_written_twice(columns: Sequence[ColumnGuess], output: str | None = None) -> dict[str, str]:
    """The column of the falling branch for each of the rising one, where the names are written twice, as "T" and
    "T (2)", and the first of them goes one way and comes back through the same range.

    Names that are written three times are of specimens; a column of the second branch that is given as the ``output``
    is meant alone.
    """
    moving = {c.name: c for c in columns if c.facts.known.size and c.facts.kind != "text"}
    pairs = {name: f"{name} (2)" for name in moving if f"{name} (2)" in moving}
    pairs = {a: b for a, b in pairs.items() if moving[a].unit == moving[b].unit}
    if any(f"{name} (3)" in moving for name in pairs):
        return {}
    for drive, other in pairs.items():
        u, back = moving[drive], moving[other]
        outputs = {a: b for a, b in pairs.items() if a != drive}
        if (
            outputs
            and u.quantity not in q.NO_SIGNALS
            and _one_way((u, back), moving, outputs)
            and comes_back(u.facts.known, back.facts.known)
        ):
            falls = _way(u, moving[next(iter(outputs))]) < 0
            pairs = {b: a for a, b in pairs.items()} if falls else pairs
            return {} if output in pairs.values() else pairs
    return {}


def branches_by_words(columns: Sequence[ColumnGuess], output: str | None = None) -> dict[str, str]:
    """The column of the falling branch for each of the rising one, where their names differ by two opposite words.

    Empty unless a column that both share, or one of the pairs, can be the input: it goes one way on each branch. A
    column of a falling branch that is given as the ``output`` is meant alone.
    """
    moving = {
        c.name: c for c in columns if c.facts.known.size and c.facts.span > 0 and c.facts.kind != "text"
    }
    for words in (*_RISING_FALLING, *_THERE_AND_BACK):
        pairs = _pairs_of_words(list(moving), *words)
        pairs = {a: b for a, b in pairs.items() if moving[a].unit == moving[b].unit}
        named = {*pairs, *pairs.values()}
        shared = {name: name for name in moving if name not in named}
        for drive, other in (shared | pairs).items() if pairs else ():
            outputs = {a: b for a, b in pairs.items() if a != drive}
            both = (moving[drive], moving[other])
            if outputs and _may_drive(both[0], len(shared)) and _one_way(both, moving, outputs):
                falls = words in _THERE_AND_BACK and _way(both[0], moving[next(iter(outputs))]) < 0
                pairs = {b: a for a, b in pairs.items()} if falls else pairs
                return {} if output in pairs.values() else pairs
    return {}


def with_shared_input(columns: list[ColumnGuess], pairs: Mapping[str, str]) -> list[ColumnGuess]:
    """The columns; the only one beside two branches is no time, which both could not share: a T is a temperature."""
    rest = [c for c in columns if c.name not in {*pairs, *pairs.values()}]
    if not pairs or len(rest) != 1 or rest[0].quantity not in q.NO_SIGNALS:
        return columns
    found = as_temperature(rest[0]) if rest[0].label.strip() == "T" else rest[0].without_meaning()
    return [found if c is rest[0] else c for c in columns]


def backward_branches(
    drive: tuple[ColumnGuess, ColumnGuess], out: tuple[ColumnGuess, ColumnGuess]
) -> tuple[str, ...]:
    """The branches ("up", "down") whose rows are written in the other direction; columns of the rising one first."""
    ways = [_way(u, y) for u, y in zip(drive, out)]
    return tuple(name for name, way, own in (("up", ways[0], 1), ("down", ways[1], -1)) if way * own < 0)


def _pairs_of_words(names: Sequence[str], first: str, second: str) -> dict[str, str]:
    by_words = {name.casefold(): name for name in names}
    word = re.compile(rf"(?<![a-z]){first}(?![a-z])")
    partners = {name: by_words.get(word.sub(second, name.casefold())) for name in names}
    return {a: b for a, b in partners.items() if b is not None and a != b}


def _may_drive(c: ColumnGuess, shared: int) -> bool:
    """Whether a column can be the input; the only one beside the branches is none that both could not share."""
    return c.quantity not in q.NO_SIGNALS or shared == 1


def _one_way(
    drive: tuple[ColumnGuess, ColumnGuess], columns: Mapping[str, ColumnGuess], pairs: Mapping[str, str]
) -> bool:
    return all(
        goes_one_way(u, columns[name])
        for names in pairs.items()
        for u, name in zip(drive, names, strict=True)
    )


def _rows(u: ColumnGuess, y: ColumnGuess) -> np.ndarray:
    """The input in the rows of a branch."""
    return u.facts.values[np.isfinite(u.facts.values) & np.isfinite(y.facts.values)]


def goes_one_way(u: ColumnGuess, y: ColumnGuess) -> bool:
    """Whether an input goes one way in the rows of a branch."""
    rows = _rows(u, y)
    return goes_through(rows)


def goes_through(x: Array) -> bool:
    """Whether readings go one way through their range."""
    return bool(x.size >= _FEWEST_ROWS and np.ptp(x) > 0 and wide_turns(x).size == 2)


def _way(u: ColumnGuess, y: ColumnGuess) -> float:
    rows = _rows(u, y)
    return float(rows[-1] - rows[0]) if rows.size else 0.0
