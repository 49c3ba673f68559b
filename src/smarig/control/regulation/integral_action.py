"""Integral action on the position error in whole counts, with the source held inside its limits.

    s_{k+1} = min(max(s_k + kT · count · round(e_k/count), s₋), s₊)

The error is rounded to whole counts because a reading is one: an error of less than half a count has no sign that the
encoder could show. The source itself is clipped, so it leaves a limit as soon as the error changes its sign.
``integral_gain`` gives the gains k with a proof of convergence.
"""

import math

from smarig.control.regulation.integral_gain import IntegralGains, integral_gain_unit
from smarig.core import spaced


class IntegralAction:
    """Integral action that holds a set-point; ``gain`` in K/s per unit of position, ``limits_K`` of the source.

    ``certified`` are the largest gains with a proof for the model, None without one; ``unit`` is that of the position.

    >>> loop = IntegralAction(gain=2.0, period_s=0.5, limits_K=(0.0, 100.0), count=0.1)
    >>> loop.start(50.0)
    >>> loop.step(0.04), loop.step(1.02), loop.step(1000.0)
    (50.0, 51.0, 100.0)
    """

    def __init__(
        self,
        gain: float,
        period_s: float,
        limits_K: tuple[float, float],
        count: float = 0.0,
        certified: IntegralGains | None = None,
        unit: str = "",
    ) -> None:
        self.gain, self.count, self.certified, self.unit = gain, count, certified, unit
        self._per_tick = gain * period_s
        self._low_K, self._high_K = limits_K
        self.start(0.0)

    def start(self, source_K: float) -> None:
        """Start at rest at a source temperature."""
        self._source_K = self._clipped(source_K)

    def step(self, error: float) -> float:
        """The source temperature of the next tick, K."""
        if self.count:
            error = self.count * math.floor(error / self.count + 0.5)
        self._source_K = self._clipped(self._source_K + self._per_tick * error)
        return self._source_K

    def settings(self) -> dict[str, float | None]:
        """The numbers for the record."""
        c = self.certified
        return {
            "gain": self.gain,
            "delay_s": None if c is None else c.timing.delay_ticks * c.timing.period_s,
            "certified_from_rest": None if c is None else c.from_rest,
            "certified_any_state": None if c is None else c.any_state,
        }

    def statement(self) -> str:
        """What is proved about this loop, in a sentence."""
        if self.certified is None:
            unit = spaced(integral_gain_unit(self.unit))
            return f"Integral gain {self.gain:.4g}{unit}: no convergence is certified with this model."
        return self.certified.statement(self.gain, self.unit)

    def _clipped(self, source_K: float) -> float:
        return min(max(source_K, self._low_K), self._high_K)
