"""Whether a closed loop still holds the wire: errors that stay large end the run with zero current.

Judged by the rms of whole stretches of time, so a loop that swings from end to end through zero error is no better than
one that stands still. Knows errors and times; refuses to know who made them.
"""

import math
from dataclasses import dataclass

from smarig.errors import LimitExceeded

_STRETCHES = 4  # into which the patience is cut
_BETTER = 0.9  # times the least rms so far: it is coming


@dataclass(frozen=True)
class Patience:
    """When a loop counts as diverged: further off than a share of the range, for so long without coming closer."""

    share: float = 0.3
    seconds: float = 30.0


class Watch:
    """``look(t_s, error)`` at every sample; ``reach`` (low, high) are the positions within the rig's limits.

    >>> watch = Watch(Patience(0.3, 3.0), (0.0, 10.0))
    >>> for tick in range(40):
    ...     watch.look(0.1 * tick, 2.9)
    """

    def __init__(self, patience: Patience, reach: tuple[float, float]) -> None:
        self._most = patience.share * abs(reach[1] - reach[0])
        self._patience = patience
        self._least: float | None = None
        self._rows = 0
        self._since_s, self._squares, self._n = math.nan, 0.0, 0

    def look(self, t_s: float, error: float) -> None:
        """Raise LimitExceeded after a while of large errors that do not shrink; no error at all is a large one."""
        if not self._n:
            self._since_s = t_s
        self._squares += error * error if math.isfinite(error) else math.inf
        self._n += 1
        if t_s - self._since_s >= self._patience.seconds / _STRETCHES:
            rms, self._squares, self._n = math.sqrt(self._squares / self._n), 0.0, 0
            self._judge(rms)

    def _judge(self, rms: float) -> None:
        if rms <= self._most:
            self._least, self._rows = None, 0
        elif self._least is None or rms < _BETTER * self._least:
            self._least, self._rows = rms, 0
        else:
            self._rows += 1
        if self._rows >= _STRETCHES - 1:
            raise LimitExceeded(
                f"The loop diverges: {rms:.3g} off what is wanted, and no closer for {self._patience.seconds:g} s. "
                "The current is at zero."
            )
