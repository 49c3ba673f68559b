"""States of the memory in which the output changed by itself: slip, a load that fell off. They are not noise.

Among ten repeated states or more, one is left out if its variance exceeds that of noise with the median of all states,
by a χ² test with a margin. Noise alone never leaves one out.
"""

from collections.abc import Sequence

import numpy as np
from scipy.special import chdtri

from smarig.identification.repeatability import Repeats

_FEWEST_STATES = 10  # repeated states with a typical spread
_P_CHANGED, _MARGIN = 1e-9, 4.0  # of the test for a changed state, and on its variance
_MOST_CHANGED = 0.25  # of the states: if more differ, the spread is not that of noise


def unchanged(of_runs: Sequence[Sequence[Repeats]]) -> tuple[list[list[Repeats]], int]:
    """The states of each run whose outputs differ as those of the others do, and the number of those left out."""
    everything = [repeats for run in of_runs for repeats in run]
    changed = _changed(everything)
    left_out = {id(repeats) for repeats, out in zip(everything, changed) if out}
    return [[repeats for repeats in run if id(repeats) not in left_out] for run in of_runs], len(left_out)


def _changed(states: Sequence[Repeats]) -> np.ndarray:
    """Which of the states (n,) have changed."""
    none = np.zeros(len(states), dtype=bool)
    if len(states) < _FEWEST_STATES:
        return none
    squares = np.array([float(np.sum((s.y - s.y.mean()) ** 2)) for s in states])
    freedom = np.array([s.y.size - 1 for s in states])
    usual = float(np.median(squares / chdtri(freedom, 0.5)))  # the variance, from the median of χ²
    if usual == 0:  # readings in steps coarser than the noise
        return none
    changed = squares > _MARGIN * usual * chdtri(freedom, _P_CHANGED / len(states))
    return none if changed.mean() > _MOST_CHANGED else changed
