"""Where the input turned between the settled points of a run: what its memory went through and nobody waited for.

A waveform or a closed loop leaves its mark on the memory like any step, only that no position was settled there. Reads
the predicted input of the samples; knows no memory and no model.
"""

import numpy as np
from numpy.typing import NDArray

from smarig.record import Run

Array = NDArray[np.float64]
MIN_REVERSAL = 0.01  # of the range of settled inputs: smaller swings are a noisy current's


def input_path(run: Run) -> tuple[Array, NDArray[np.intp]]:
    """Inputs (m,) in the order of time, turning points between settled points included, and where these are (k,).

    A turn within a swing of a settled level is taken for a visit to it: a predicted input only nears what was aimed at.
    """
    points = run.points()[0]
    if not run.settled:
        return points, np.arange(points.size)
    min_reversal = MIN_REVERSAL * float(np.ptp(points))
    inputs: list[float] = []
    where = []
    for before, point, traversed in zip([None, *points[:-1]], points.tolist(), _inputs_before_points(run)):
        inputs += _snapped_to_levels(
            reversals_between(traversed, before, point, min_reversal), points, min_reversal
        )
        where.append(len(inputs))
        inputs.append(point)
    inputs += _snapped_to_levels(
        reversals_between(_inputs_after_last_point(run), inputs[-1], None, min_reversal), points, min_reversal
    )
    return np.array(inputs), np.array(where)


def _snapped_to_levels(found: list[float], levels: Array, min_reversal: float) -> list[float]:
    nearest = [float(levels[np.argmin(np.abs(levels - u))]) for u in found]
    return [level if abs(level - u) <= min_reversal else u for u, level in zip(found, nearest)]


def reversals_between(
    traversed: Array, before: float | None, after: float | None, min_reversal: float
) -> list[float]:
    """Where a record (n,) between two inputs turns by more than ``min_reversal``, its ends left out.

    >>> turns(np.array([0.0, 5.0, 80.0, 41.0, 20.0, 40.0]), 0.0, 43.0, 1.0)
    [80.0, 20.0]
    """
    ends = [[] if u is None else [u] for u in (before, after)]
    u = np.concatenate([ends[0], traversed[np.isfinite(traversed)], ends[1]])
    if u.size < 3 or _is_monotone(u, min_reversal) or min_reversal <= 0:
        return []
    found = [float(u[0])]
    up = None
    for v in u[1:].tolist():
        if up is None:
            if abs(v - found[0]) > min_reversal:
                up = v > found[0]
                found.append(v)
        elif (v > found[-1]) == up:
            found[-1] = v
        elif abs(v - found[-1]) > min_reversal:
            found.append(v)
            up = not up
    return found[1:] if after is None else found[1:-1]


def _is_monotone(u: Array, min_reversal: float) -> bool:
    """Whether it never goes back by more than a swing: most steps, and soon said."""
    back = (np.maximum.accumulate(u) - u).max() if u[-1] >= u[0] else (u - np.minimum.accumulate(u)).max()
    return bool(back <= min_reversal)


def _inputs_before_points(run: Run) -> list[Array]:
    """Predicted inputs since the settled point before, up to the end of each."""
    t, inputs = run["t_s"], run["input"]
    ends = np.searchsorted(t, [s.t_end_s if s.t_end_s is not None else np.nan for s in run.settled], "left")
    return np.split(inputs, ends)[:-1]


def _inputs_after_last_point(run: Run) -> Array:
    last = run.settled[-1].t_end_s
    return run["input"][run["t_s"] > last] if last is not None else np.empty(0)
