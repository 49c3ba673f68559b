"""The path of a run in the plane of input and output, thinned to what a drawing can show, and its gaps.

No line is drawn across a gap, where samples are missing.
"""

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.record import Run
from smarig.report.components.decimate import envelope

_SHORTEST_STEP = 0.008  # of the range: samples that moved less are left out
_COUNTS = 1.6  # of the output: less is the resolution of its readings
_MOST_SAMPLES = 400_000  # that are looked at one by one: of longer runs, extremes of a few neighbours each


def sample_path(u: Array, y: Array, count: float = 0.0) -> NDArray[np.intp]:
    """Indices (k,) of samples along the path (u, y), (n,) each: known ones that moved since the last one kept.

    Holds become single points. The extremes of the output are kept. Motion below the resolution of the output,
    ``count``, is not shown.
    """
    known = np.flatnonzero(np.isfinite(u) & np.isfinite(y))
    if known.size < 2:
        return known
    half = _MOST_SAMPLES // 2
    known = known[np.union1d(envelope(u[known], half), envelope(y[known], half))]
    step_u = _SHORTEST_STEP * (np.ptp(u[known]) or 1.0)
    step_y = max(_SHORTEST_STEP * float(np.ptp(y[known])), _COUNTS * count)
    x, z = u[known].tolist(), y[known].tolist()
    kept = [0]
    last_x, last_z = x[0], z[0]
    for k in range(1, len(x)):
        if abs(x[k] - last_x) > step_u or abs(z[k] - last_z) > step_y:
            kept.append(k)
            last_x, last_z = x[k], z[k]
    extremes = [int(np.argmin(y[known])), int(np.argmax(y[known]))]
    return known[np.union1d(kept, extremes)]


_WITHOUT_GAP = 1.5  # ticks between two samples: one, however it is rounded


def uninterrupted_parts(run: Run) -> NDArray[np.intp]:
    """The number (n,) of the uninterrupted part that each sample belongs to. A run without a tick has one part."""
    part = np.zeros(len(run), dtype=int)
    if run.info.period_s and len(run):
        part[1:] = np.cumsum(np.diff(run["t_s"]) > _WITHOUT_GAP * run.info.period_s)
    return part


def ends_of_parts(part: NDArray[np.intp]) -> NDArray[np.intp]:
    """The rows at both sides of every gap.

    >>> ends_of_parts(np.array([0, 0, 0, 1, 1])).tolist()
    [2, 3]
    """
    last = np.flatnonzero(np.diff(part))
    return np.union1d(last, last + 1)


def broken_at_gaps(rows: NDArray[np.intp], part: NDArray[np.intp]) -> NDArray[np.intp]:
    """Increasing rows with −1 where a gap lies between two of them.

    >>> broken_at_gaps(np.array([0, 2, 3, 4]), np.array([0, 0, 0, 1, 1])).tolist()
    [0, 2, -1, 3, 4]
    """
    return np.insert(rows, np.flatnonzero(np.diff(part[rows])) + 1, -1)


def drawn(values: Array, rows: NDArray[np.intp]) -> Array:
    """The values at these rows, NaN where the row is −1."""
    return np.where(rows >= 0, values[rows], np.nan)
