"""Whether two runs are copies of each other: noise makes every measurement differ."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from smarig.core import UsageError
from smarig.record.run import Run

COPIED = ("position", "input", "current_A")  # not the clock: a copy may have another


def same_readings(a: Run, b: Run) -> bool:
    """Whether two runs hold the same readings, whatever their clocks say."""
    return len(a) == len(b) and all(np.array_equal(a[c], b[c], equal_nan=True) for c in COPIED)


def check_no_copies(runs: Sequence[Run]) -> None:
    """Raise UsageError if two runs are copies of each other: their readings would count twice."""
    for a, b in combinations(runs, 2):
        if same_readings(a, b):
            raise UsageError(
                f"{a.path.name} and {b.path.name} hold the same readings, which would count twice. Give one of them."
            )
