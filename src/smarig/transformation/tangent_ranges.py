"""The ranges of readings that tangents are fitted to, and how far their choice is varied.

A branch has three parts: a plateau at its lower and one at its upper end, where the wire is all martensite or all
austenite, and the transformation between them. The method draws a line through each (ASTM F2082, E3097) and leaves
the choice of the readings to the reader. Here the choice is a stated set, and its effect is a part of every interval.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array

Integers = NDArray[np.int64]
STEEP_SHARES = (0.3, 0.4, 0.5, 0.6)  # of the output between both plateaus, about the steepest reading
PLATEAU_GAPS = (0.75, 1.0, 1.5)  # of the span from start to finish, left out of a plateau next to its knee
PLATEAU_CUTS = (0.0, 0.25)  # of a plateau, left out at the end of the branch
LEAST_GAP = 0.02  # of the temperature's range, left out next to a knee at least
MOST_GAP = 0.5  # of a plateau, left out next to its knee at most
KNEE_SHARE = 0.1  # of the output, at both ends: no part of the steep tangent's readings
FEWEST_PLATEAU = 3  # readings of a plateau
ENOUGH_STEEP = 4  # readings of a choice for the steep tangent
FEWEST_STEEP = 3  # readings of the steep tangent at least
JUMP = 0.2  # of the output between two readings of a branch: more is stated
_CENTRES = np.linspace(0.25, 0.75, 21)  # shares of the output at which the steepest part is looked for
_SEARCHED = 0.4  # share of the output over which its slope is taken


@dataclass(frozen=True)
class TangentRanges:
    """The rows of a branch, in order of rising input, that each choice gives to each tangent."""

    low: tuple[Integers, ...]
    steep: tuple[Integers, ...]
    high: tuple[Integers, ...]
    centre: float  # share of the output at the steepest reading


def stated_ranges() -> dict[str, list[float]]:
    """The choices, by name, as the results state them."""
    return {
        "steep_share": list(STEEP_SHARES),
        "plateau_gap_spans": list(PLATEAU_GAPS),
        "plateau_cut": list(PLATEAU_CUTS),
    }


def plateau_rows(u: Array, end: float, knee: float, span: float) -> tuple[Integers, ...]:
    """The rows of each choice for the plateau between the branch's ``end`` and its ``knee``; () if too few rows lie
    there.
    """
    length, way = abs(knee - end), np.sign(knee - end)
    found: list[Integers] = []
    for gap in PLATEAU_GAPS:
        for cut in PLATEAU_CUTS:
            inner = knee - way * min(max(gap * span, LEAST_GAP * float(np.ptp(u))), MOST_GAP * length)
            outer = end + way * cut * length
            low, high = min(inner, outer), max(inner, outer)
            rows = np.flatnonzero((u >= low) & (u <= high))
            if rows.size >= FEWEST_PLATEAU and np.ptp(u[rows]) > 0:
                found.append(rows)
    return tuple(found)


def steep_rows(share: Array, centre: float) -> tuple[Integers, ...]:
    """The rows of each choice for the steep tangent: ``share`` (n,) of the output, rising, within a band about
    ``centre``. A band with fewer than four rows is left out. If that leaves one choice, it is the widest band, and
    the other choice has one more row on each side; without three rows in a band, the nearest three are the choice. ()
    if fewer than three rows lie in the transformation.
    """
    within = (share >= KNEE_SHARE) & (share <= 1 - KNEE_SHARE)
    found = [np.flatnonzero(within & (np.abs(share - centre) <= width / 2)) for width in STEEP_SHARES]
    enough = tuple(rows for rows in found if rows.size >= ENOUGH_STEEP)
    if len({rows.size for rows in enough}) > 1:
        return enough
    inside = np.flatnonzero((share > KNEE_SHARE / 2) & (share < 1 - KNEE_SHARE / 2))
    if enough or found[-1].size >= FEWEST_STEEP:
        rows = (enough or found)[-1]
        return rows, inside[(inside >= rows[0] - 1) & (inside <= rows[-1] + 1)]
    nearest = inside[np.argsort(np.abs(share[inside] - centre), kind="stable")[:FEWEST_STEEP]]
    return (np.sort(nearest),) if nearest.size == FEWEST_STEEP else ()


def steepest_centre(u: Array, share: Array) -> float:
    """The share of the output about which the input advances least while the output passes 0.4 of its range."""
    known, at = np.unique(share, return_index=True)
    last = np.searchsorted(share, known, side="right") - 1
    middle = (u[at] + u[last]) / 2  # of rows with one share
    widths = np.interp(_CENTRES + _SEARCHED / 2, known, middle) - np.interp(
        _CENTRES - _SEARCHED / 2, known, middle
    )
    least = float(widths.min())
    near = _CENTRES[widths <= least + 0.02 * abs(least)]
    return float(near.mean())
