"""How far an output moves within one tick of its reading: a wire in motion is read at some moment of the tick.

The current, the computed temperature and the position of one sample belong to one tick, but to different moments of it:
an instrument is asked in turn, and a command takes effect when it has arrived. So a reading of a moving wire is one of
the outputs between those of one tick before and one tick after. A settled point is held, and has no such motion.
"""

from collections.abc import Sequence

import numpy as np

from smarig.core import Array
from smarig.identification.fod_data import FodData
from smarig.record import Run


def motion_within_a_tick(runs: Sequence[Run], data: FodData) -> Array:
    """The larger motion of the output in the tick before and after each point (k,); 0 at settled points and in runs
    without a clock.
    """
    moved = np.zeros(len(data))
    for number, run in enumerate(runs):
        rows = data.run == number
        if rows.any() and not run.settled and run.has("t_s"):
            moved[rows] = _of_samples(run)[data.point[rows]]
    return moved


def _of_samples(run: Run) -> Array:
    """The motion at each sample of a run (n,) with an input and a position."""
    known = np.isfinite(run["input"]) & np.isfinite(run["position"])
    ticks, place = np.unique(
        run["tick"][known], return_inverse=True
    )  # a turning point is in two of the points
    y = np.bincount(place, run["position"][known]) / np.bincount(place)
    per_tick = np.abs(np.diff(y)) / np.diff(ticks)  # a mean of several samples moves by less in one
    return np.maximum(np.append(0.0, per_tick), np.append(per_tick, 0.0))[place]
