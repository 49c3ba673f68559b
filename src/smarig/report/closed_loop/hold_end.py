"""The end of a hold in closed loop: mean error and remaining motion over its last segment.

A single reading would be count noise, or an arbitrary phase of a limit cycle.
"""

from dataclasses import dataclass

import numpy as np

from smarig.control import SETTLED_FOR_S, SETTLING_BAND_COUNTS
from smarig.core import Array, root_mean_square

LAST_S = 60.0  # or the last quarter, if that is shorter
MOVES_COUNTS = 1.0  # rms about the mean: twice that of rounding to counts and encoder noise
_CROSSING_SHARE = 0.9  # of the rms: a crossing of the mean must reach this far to the other side
_MIN_CROSSINGS = 2  # a loop that creeps crosses its mean only once


@dataclass(frozen=True)
class HoldEnd:
    """Errors (measured − reference) over the last ``seconds`` of a hold, in the rig's unit; ``count`` 0 if unknown.

    ``std`` is the rms about ``mean``, ``peak_to_peak`` the range of the readings, ``current_A`` the smallest and the
    largest current, and ``current_trend`` "raises" or "lowers" if most of what lies between them is a trend, else "".
    """

    mean: float
    std: float
    peak_to_peak: float
    current_A: tuple[float, float]
    seconds: float
    crossings: int
    count: float
    current_trend: str = ""

    @property
    def verdict(self) -> str:
        """rests, rests off, swings or moves; "" if counts are unknown or the segment is too short."""
        if not self.count or self.seconds < SETTLED_FOR_S:
            return ""
        if self.std > MOVES_COUNTS * self.count:
            return "swings" if self.crossings >= _MIN_CROSSINGS else "moves"
        return "rests off" if abs(self.mean) > SETTLING_BAND_COUNTS * self.count else "rests"


def hold_end(
    t_s: Array, error: Array, current_A: Array, count: float, quiet_s: float = 0.0
) -> HoldEnd | None:
    """The end of a hold from columns (n,) since the loop was closed, using readings after ``quiet_s`` (a disturbance).

    None without such a reading.
    """
    known = np.isfinite(error)
    if not known.any():
        return None
    since = max(float(t_s[-1]) - min(LAST_S, float(t_s[-1]) / 4), quiet_s)
    last = known & (t_s > since)
    if not last.any():
        return None
    e, i = error[last], current_A[last]
    deviation = e - e.mean()
    std = root_mean_square(deviation)
    side = np.sign(deviation[np.abs(deviation) > _CROSSING_SHARE * std])
    return HoldEnd(
        mean=float(e.mean()),
        std=std,
        peak_to_peak=float(np.ptp(e)),
        current_A=(float(np.min(i)), float(np.max(i))),
        seconds=float(t_s[-1]) - since,
        crossings=int(np.count_nonzero(np.diff(side))),
        count=count,
        current_trend=_trend(i),
    )


def _trend(current_A: Array) -> str:
    """Whether the means of the first and the last third differ by more than half the range."""
    third = max(1, current_A.size // 3)
    rise = float(np.mean(current_A[-third:]) - np.mean(current_A[:third]))
    if abs(rise) <= 0.5 * float(np.ptp(current_A)):
        return ""
    return "raises" if rise > 0 else "lowers"
