"""The path of a run in the plane of input and output, thinned to what a drawing can show."""

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
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
