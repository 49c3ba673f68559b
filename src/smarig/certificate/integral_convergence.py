"""Convergence of a position loop with integral action: what the slopes of a model permit, for any wire lag.

With λ the steepest slope of the model and no falling branch (Assumption 2.1), y → r for every set-point of the range if
k λ (τ + dead time) < 1; from rest and without overshoot up to about a quarter of it
(docs/explanation/convergence.md). The gain of a rig follows with its τ and tick (``smarig.control.integral_gains``).
"""

import math
from dataclasses import dataclass
from typing import Any

from smarig.certificate.certificate_units import Units, with_unit
from smarig.certificate.hysteresis_analysis import HysteresisAnalysis
from smarig.control import IntegralGains, LoopTiming, integral_gain_unit, integral_gains
from smarig.theory import largest_slope


@dataclass(frozen=True)
class IntegralConvergence:
    """``slope`` λ, output per input; ``holds`` whether any gain is proved, with the reason if not.

    ``gains`` are those of a rig, None if nothing is proved or no rig was given.
    """

    holds: bool
    slope: float
    why: str
    units: Units
    gains: IntegralGains | None = None

    @property
    def gain_times_lag(self) -> float | None:
        """1/λ: the upper limit of k (τ + dead time), input per output; None if nothing is proved."""
        return 1.0 / self.slope if self.holds else None

    @property
    def text(self) -> str:
        """The result in a sentence or two."""
        if not self.holds:
            return f"Integral action on the position: no gain is certified, because {self.why}."
        limit = with_unit(1.0 / self.slope, self._unit)
        return (
            f"Integral action on the position converges to every set-point of the range if k·(τ + dead time) is below "
            f"{limit} (steepest slope {with_unit(self.slope, self.units.slope)}); from rest up to about a quarter of "
            f"it without overshoot, within a count (smarig regulate --controller integral).{self._gain_text}"
        )

    @property
    def _gain_text(self) -> str:
        if self.gains is None:
            return ""
        return f" On the rig of the model: a gain k up to {self.gains.limits_text(self.units.output)}."

    def to_json(self) -> dict[str, Any]:
        """Plain values; a slope that is not finite is None."""
        return {
            "holds": self.holds,
            "largest_slope": self.slope if math.isfinite(self.slope) else None,
            "gain_times_lag": self.gain_times_lag,
            "unit": self._unit,
            "gain_from_rest": self.gains and self.gains.from_rest,
            "gain_any_state": self.gains and self.gains.any_state,
            "gain_unit": integral_gain_unit(self.units.output),
            "text": self.text,
        }

    @property
    def _unit(self) -> str:
        return f"{self.units.input}/{self.units.output}" if self.units.gain else ""


def integral_convergence(
    analysis: HysteresisAnalysis, timing: LoopTiming | None = None
) -> IntegralConvergence:
    """What is proved for a hysteresis, and the gains for the timing of a rig.

    >>> from smarig.preisach import thesis_surface
    >>> found = integral_convergence(HysteresisAnalysis.of(thesis_surface("one_e")))
    >>> found.holds, round(found.gain_times_lag, 3)
    (True, 2.838)
    """
    steepest = largest_slope(analysis.hysteresis)
    slope = steepest.value if math.isnan(steepest.bound) else steepest.bound
    if not math.isfinite(slope):
        return IntegralConvergence(
            False, slope, "its output jumps at the thresholds of relays", analysis.units
        )
    if not analysis.monotone.holds:
        why = "its output falls somewhere as its input rises (Assumption 2.1 fails)"
        return IntegralConvergence(False, slope, why, analysis.units)
    if slope <= 0.0:
        return IntegralConvergence(False, slope, "its output does not move", analysis.units)
    gains = integral_gains(analysis.hysteresis, timing) if timing else None
    return IntegralConvergence(True, slope, "", analysis.units, gains)
