"""Whether the output of runs rises with the input in some of them and falls in others, which no one measure gives."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from smarig.core import Array, correlation
from smarig.measurement import reversals
from smarig.record import Run

LEAST_CORRELATION = 0.3  # of output and input: with a smaller one, the output does not follow its input


def largest_correlation(runs: Sequence[Run]) -> float:
    """The largest absolute correlation of inputs and outputs within a run."""
    return max((abs(_correlation(*run.points())) for run in runs), default=0.0)


def opposite_senses(runs: Sequence[Run]) -> str:
    """A clause that names the runs in which the output rises with the input and those in which it falls; "" if it does
    the same in all.
    """
    rises, falls = (
        [run.name for run in runs if sign * _correlation(*run.points()) > LEAST_CORRELATION]
        for sign in (1, -1)
    )
    if not rises or not falls:
        return ""
    return f"the output rises with the input in {', '.join(rises)} and falls in {', '.join(falls)}"


def senses_of_branches(runs: Sequence[Run]) -> str:
    """The same of the branches of a run, in which a variable that is not used may have changed."""
    for run in runs:
        u, y = run.points()
        found = [_correlation(u[a : b + 1], y[a : b + 1]) for a, b in pairwise(reversals(u))]
        if min(found) < -LEAST_CORRELATION and max(found) > LEAST_CORRELATION:
            return f"the output rises with the input on some branches of {run.name} and falls on others"
    return ""


def _correlation(u: Array, y: Array) -> float:
    moves = u.size > 2 and np.ptp(u) > 0 and np.ptp(y) > 0
    return correlation(u, y) if moves else 0.0
