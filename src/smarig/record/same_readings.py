"""Whether two runs are copies of each other: noise makes every measurement differ."""

import numpy as np

from smarig.record.run import Run

COPIED = ("position", "input", "current_A")  # not the clock: a copy may have another


def same_readings(a: Run, b: Run) -> bool:
    """Whether two runs hold the same readings, whatever their clocks say."""
    return len(a) == len(b) and all(np.array_equal(a[c], b[c], equal_nan=True) for c in COPIED)
