"""How a hold comes to rest: how far each sample is from the mean of its window, and the seconds left at least.

Follows the rule of ``runner.settling`` from the outside, with the band and window a run was given. Draws nothing.
"""

from collections import deque

from smarig.core.command import Settled
from smarig.core.sample import Sample
from smarig.plant.actuator import Actuator
from smarig.runner.settling_detection import Approach, SettleWindow

NAN = float("nan")


class SettlingMonitor:
    """Watches samples of holds; ``after`` gives (counts off the window's mean, seconds left at least)."""

    def __init__(self, until: Settled, actuator: Actuator, period_s: float) -> None:
        self._until, self._actuator, self._period_s = until, actuator, period_s
        self.band_counts = until.band_counts
        self._size = max(1, round(until.window_s / period_s))
        self._step: int | None = None
        self._input_K = 0.0
        self._begin(0.0)

    def _begin(self, current_A: float) -> None:
        self._window = SettleWindow(self._until, self._period_s)
        steady_input_K = self._actuator.input_for(current_A)
        self._approach = Approach(steady_input_K, self._until.approach_K, self._input_K)
        self._counts: deque[int] = deque()
        self._sum = 0

    def after(self, s: Sample, step: int | None, input_K: float) -> tuple[float, float]:
        """Of the step that the sample belongs to; NaN between steps."""
        if step != self._step:
            self._step = step
            self._begin(s.current_command_A)
        arrived = self._approach.passed(input_K)
        self._input_K = input_K
        if step is None:
            return NAN, NAN
        self._window.add(s.counts, arrived)
        self._counts.append(s.counts)
        self._sum += s.counts
        if len(self._counts) > self._size:
            self._sum -= self._counts.popleft()
        left_s = 0.0 if self._window.settled else self._window.min_ticks_left * self._period_s
        return s.counts - self._sum / len(self._counts), left_s
