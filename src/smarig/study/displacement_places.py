"""Which of several displacements is that of the specimen: by the place in its name, else by how far it moves."""

from collections.abc import Sequence

import numpy as np

from smarig.exchange import convert, dimension
from smarig.study.column_guess import ColumnGuess
from smarig.study.strain_columns import show_one_motion
from smarig.study.thermometer_places import is_of_holder

_FAR_MORE = 10.0  # least ratio of two motions of which the smaller is that of what should stand still


def specimens_displacement(first: ColumnGuess, others: Sequence[ColumnGuess]) -> ColumnGuess:
    """The displacement of the specimen: the first, unless its name says that it is of what holds the specimen, or
    another one moves far more, as a frame yields by little while the specimen moves.
    """
    able = _at_specimen([first, *others])
    best = able[0]
    widest = max(able, key=lambda c: _motion(c, best))
    return widest if _motion(widest, best) >= _FAR_MORE * _motion(best, best) else best


def rival_displacements(out: ColumnGuess, others: Sequence[ColumnGuess]) -> list[ColumnGuess]:
    """The displacements that differ from the output, move as far, and may as well be that of the specimen."""
    able = [
        c for c in _at_specimen([out, *others]) if c is not out and dimension(c.unit) == dimension(out.unit)
    ]
    return [
        c for c in able if _FAR_MORE * _motion(c, out) > _motion(out, out) and not show_one_motion(c, out)
    ]


def _at_specimen(displacements: Sequence[ColumnGuess]) -> list[ColumnGuess]:
    """Those whose names do not say that they are of what holds the specimen; all if every name says so."""
    return [c for c in displacements if not is_of_holder(c)] or list(displacements)


def _motion(c: ColumnGuess, other: ColumnGuess) -> float:
    """How far a displacement moves, in the unit of another one, without its rarest readings."""
    low, high = np.percentile(c.facts.known, (1, 99))
    return (
        float(convert(high - low, c.unit, other.unit)) if dimension(c.unit) == dimension(other.unit) else 0.0
    )
