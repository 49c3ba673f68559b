"""How a held loop ended: mean error and what is left of movement over its last stretch, not one reading by chance.

A single reading is count noise, or a random phase of a limit cycle. Knows columns; refuses to know runs.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.control.tracking.measures import STAYS_S, WITHIN_COUNTS

Array = NDArray[np.float64]
LAST_S = 60.0  # or the last quarter, where that is shorter
MOVES_COUNTS = 1.0  # rms about the mean: twice what rounding to counts and the encoder's noise leave
_CROSSED = 0.9  # of the rms: as far on the other side of the mean counts as having crossed it
_TO_CROSS = 2  # a loop that only creeps crosses its mean once


@dataclass(frozen=True)
class LoopEnd:
    """Errors (measured less wanted) over the last ``seconds`` of a hold, in the rig's unit; ``count`` 0 if unknown.

    ``spread`` is the rms about ``mean``, ``swing`` from the least reading to the largest, ``current_A`` the least and
    the largest current.
    """

    mean: float
    spread: float
    swing: float
    current_A: tuple[float, float]
    seconds: float
    crossings: int
    count: float

    @property
    def verdict(self) -> str:
        """rests, rests off, swings or moves; "" where counts are unknown or the stretch is too short to say."""
        if not self.count or self.seconds < STAYS_S:
            return ""
        if self.spread > MOVES_COUNTS * self.count:
            return "swings" if self.crossings >= _TO_CROSS else "moves"
        return "rests off" if abs(self.mean) > WITHIN_COUNTS * self.count else "rests"


def loop_end(
    t_s: Array, error: Array, current_A: Array, count: float, quiet_s: float = 0.0
) -> LoopEnd | None:
    """Of columns (n,) from where the loop was closed; nothing before ``quiet_s`` (a disturbance) counts.

    None without a reading after it.
    """
    known = np.isfinite(error)
    if not known.any():
        return None
    since = max(float(t_s[-1]) - min(LAST_S, float(t_s[-1]) / 4), quiet_s)
    last = known & (t_s > since)
    if not last.any():
        return None
    e, i = error[last], current_A[last]
    away = e - e.mean()
    spread = float(np.sqrt(np.mean(away**2)))
    side = np.sign(away[np.abs(away) > _CROSSED * spread])
    return LoopEnd(
        mean=float(e.mean()),
        spread=spread,
        swing=float(np.ptp(e)),
        current_A=(float(np.min(i)), float(np.max(i))),
        seconds=float(t_s[-1]) - since,
        crossings=int(np.count_nonzero(np.diff(side))),
        count=count,
    )
