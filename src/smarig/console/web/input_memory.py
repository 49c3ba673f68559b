"""The memory of a run's input: the boundary of the Preisach plane, from the first sample of the run to the present one.

It follows the samples in shared memory. Where they were overwritten before they were read, it reads the run file, which
is at most a second behind and has them all. What it keeps is the reduced memory sequence, so a run of days needs no
more of it than one of a minute.
"""

import time
from typing import Any

import numpy as np

from smarig.console.library.run_content import input_range_K
from smarig.core import Array
from smarig.live import boundary
from smarig.preisach import Initial, Preisach, RelayMeasure
from smarig.record import StoredRun
from smarig.running import RunInProgress

_WIDE_K = 1e6  # of an operator whose range is not known
_STEPS = 2000  # of the drawn range; a smaller move is not seen
_PERIODS = 1.5  # between neighbouring samples at most
_SHARE = 0.1  # of the time that reading the file may take
_INITIAL: dict[str | None, Initial] = {
    "positive": "positive",
    "anhysteretic": "anhysteretic",
}  # else negative


class InputMemory:
    """The memory of the input of one run. ``catch_up`` with its file first, and whenever it ``is_behind``."""

    def __init__(self, run: RunInProgress) -> None:
        self._run = run
        self._operator: Preisach | None = None
        self._range: tuple[float, float] | None = None  # None: that of the inputs so far
        self._seen = (np.inf, -np.inf)
        self._number, self._last_s, self._rests_until_s = 0, -np.inf, 0.0
        self._sent: dict[str, Any] | None = None
        self.is_behind = True

    def begin(self, stored: StoredRun) -> None:
        """Take the range of the rig and the state of the wire at the start from the run file."""
        upper, initial = input_range_K(stored), stored.info.initial
        if upper is not None:
            self._range = (-upper if self._run.info.get("two_wire") else 0.0, upper)
        hysteresis = RelayMeasure.zero(*(self._range or (-_WIDE_K, _WIDE_K)))
        self._operator = Preisach(hysteresis, _INITIAL.get(initial, "negative"), compiled=False)

    def take(self, t_s: Array, inputs: Array) -> None:
        """Move along recorded samples; those that are known already are left out."""
        new = t_s > self._last_s
        if self._operator is None or not new.any():
            return
        self._last_s = float(t_s[new][-1])
        u = inputs[new][np.isfinite(inputs[new])]
        if u.size:
            self._operator.follow(u)
            self._seen = min(self._seen[0], float(u.min())), max(self._seen[1], float(u.max()))

    def caught_up(self) -> None:
        """Follow the samples in shared memory from here on."""
        self._number, self.is_behind = 0, False

    def catch_up(self, stored: StoredRun) -> None:
        """Read what the file has and this does not; not so often that reading takes much of the time."""
        started_s = time.monotonic()
        if started_s < self._rests_until_s:
            return
        if self._operator is None:
            self.begin(stored)
        for block in stored.blocks(("t_s", "input")):
            self.take(block["t_s"], block["input"])
        self.caught_up()
        done_s = time.monotonic()
        self._rests_until_s = done_s + (done_s - started_s) / _SHARE

    def follow(self) -> None:
        """Move along the newest samples. Raises UsageError when the run has ended."""
        if self.is_behind:
            return
        found, self._number, _ = self._run.samples(self._number)
        new = found[found["t_s"] > self._last_s]
        if not new.size:
            return
        known = np.isfinite(self._last_s)
        times = np.concatenate([[self._last_s] if known else [], new["t_s"]])
        longest_s = _PERIODS * self._run.info["period_s"]
        if (np.diff(times) > longest_s).any() or (not known and new["number"][0] > 1):
            self.is_behind = True
        else:
            self.take(new["t_s"], new["input_K"])

    def news(self) -> dict[str, Any] | None:
        """The boundary, if it has changed: range, corners (β, α), number of corners before the present point, input."""
        if self._operator is None or self._seen[0] > self._seen[1]:
            return None
        low, high = self._range or self._seen
        if low == high:
            return None
        state = self._operator.state
        corners = boundary(state, low, high)
        size = (high - low) / _STEPS
        seen = np.round(np.round(corners / size) * size, 6).tolist()
        drawn = [point for k, point in enumerate(seen) if k == 0 or point != seen[k - 1]]
        found = {
            "range": [round(low, 3), round(high, 3)],
            "corners": drawn,
            "count": len(corners) - 1,
            "input": round(float(state.u), 1),
        }
        if found == self._sent:
            return None
        self._sent = found
        return found
