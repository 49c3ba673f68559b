"""Rows in which an output reads its largest or smallest value again and again: the range of its sensor ends there.

A wire rests at an end of its travel, too, and a material saturates; but readings that scatter elsewhere scatter there
as well. How often four readings in turn scatter elsewhere tells how improbable the equal ones are; of a column without
scatter, nothing is known.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.special import betaln

from smarig.core import Array, spaced
from smarig.record import ImportFinding

_FOUR = 4  # readings that zigzag once may be a turn, twice they scatter
_MOVED = 0.05  # of the input's range
_BY_CHANCE = 0.01  # such runs of equal readings in a record whose sensor does not end there


def clipped_output(u: Array, y: Array) -> NDArray[np.bool_]:
    """Mask (n,) of readings of an output ``y`` that stand at an end of the range of its sensor while ``u`` moves."""
    mask = np.zeros(y.size, dtype=bool)
    known = np.flatnonzero(np.isfinite(u) & np.isfinite(y))
    if known.size < 2 * _FOUR or np.ptp(y[known]) == 0:
        return mask
    x, drive = y[known], u[known]
    for extreme in (x.min(), x.max()):
        at = x == extreme
        runs = [(a, b) for a, b in _runs(at) if b - a >= _FOUR]
        moved = sum(float(np.ptp(drive[a:b])) for a, b in runs)
        if moved >= _MOVED * np.ptp(drive) and _chance(x, at, runs) < _BY_CHANCE:
            mask[known] |= at
    return mask


def clipped_findings(
    unit: str, y: Array, mask: NDArray[np.bool_], line: NDArray[np.int64]
) -> list[ImportFinding]:
    """A finding on each value at which the output is clipped."""
    found = []
    for value in np.unique(y[mask]):
        rows = mask & (y == value)
        text = (
            f"The output reads exactly {value:g}{spaced(unit)} in {int(rows.sum())} rows (from line "
            f"{line[rows].min()} to {line[rows].max()}) while the input moves, although its readings scatter "
            "elsewhere: the range of the sensor ends there. What lies beyond is not known; the stroke is at least what "
            "was read."
        )
        found.append(ImportFinding(text, "clipped output"))
    return found


def _chance(x: Array, at: NDArray[np.bool_], runs: list[tuple[int, int]]) -> float:
    """How many such runs of equal readings chance would give in a record of ``x`` (n,), at most 1 for each row.

    Of groups of four readings elsewhere some scatter and some stand still; that all groups of the runs stand still has
    the probability of a beta-binomial distribution, by the rule of succession.
    """
    groups = [(a, a + _FOUR) for lo, hi in _runs(~at) for a in range(lo, hi - _FOUR + 1, _FOUR)]
    scatter, still = (sum(kind(x[a:b]) for a, b in groups) for kind in (_scatters, _stands_still))
    at_end = sum((b - a) // _FOUR for a, b in runs)
    return float(x.size * np.exp(betaln(still + 1 + at_end, scatter + 1) - betaln(still + 1, scatter + 1)))


def _scatters(four: Array) -> bool:
    """Whether readings zigzag over more than two values: two may be one that lies between two steps of the sensor."""
    steps = np.diff(four)
    return bool((steps[1:] * steps[:-1] < 0).all()) and np.unique(four).size > 2


def _stands_still(four: Array) -> bool:
    """Whether readings are equal, or alternate between two values."""
    return bool((four[2:] == four[:-2]).all())


def _runs(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]]))).tolist()
    return list(zip(edges[::2], edges[1::2]))
