"""The largest gains of an integral loop for which convergence is proved (docs/explanation/convergence.md).

The loop: source s_{k+1} = s_k + kT e_k (K), e_k = r − y_k; the wire follows s with time constant τ after a dead time of
d ticks of length T; y = Γ[temperature], and every move of the wire changes the output by σ ΔT_wire, 0 ≤ σ ≤ λ
(``largest_slope``, Assumption 2.1). With a = e^(−T/τ):

    any_state    k λ (dT + (T/2) coth(T/2τ)) < 1                      y → r from every state inside the limits
    from_rest    k λ T ≤ max_{a<γ<1} (1 − γ) γ^(d−1) (γ − a)/(1 − a)   no overshoot; limits and counts included

For T ≪ τ the first is k λ (dT + τ) < 1, the circle criterion for 1/(s(1 + τs)) with a dead time; without dead time the
second is k λ τ ≤ 1/4. The state is that of the wire when the loop is closed.
"""

import math
from dataclasses import dataclass

from smarig.control.argument_checks import not_negative, positive
from smarig.core import UsageError, spaced
from smarig.preisach import Everett
from smarig.theory import largest_slope, monotone


def integral_gain_unit(unit: str) -> str:
    """The unit of an integral gain for outputs in ``unit``; "" if that is not known.

    >>> integral_gain_unit("mm")
    'K/(mm·s)'
    """
    return f"K/({unit}·s)" if unit else ""


@dataclass(frozen=True)
class LoopTiming:
    """Tick, time constant of the wire, and dead time between a reading and its effect beyond the tick itself, s.

    >>> timing = LoopTiming(period_s=0.1, tau_s=5.3, delay_s=0.1)
    >>> timing.delay_ticks, round(timing.total_lag_s, 4)
    (1, 5.4002)
    """

    period_s: float
    tau_s: float
    delay_s: float = 0.0

    def __post_init__(self) -> None:
        positive("The period of a tick", self.period_s)
        positive("The time constant", self.tau_s)
        not_negative("The dead time", self.delay_s)

    @property
    def delay_ticks(self) -> int:
        """d: the dead time in whole ticks, rounded up."""
        return math.ceil(self.delay_s / self.period_s - 1e-9)

    @property
    def decay(self) -> float:
        """a = e^(−T/τ)."""
        return math.exp(-self.period_s / self.tau_s)

    @property
    def total_lag_s(self) -> float:
        """dT + (T/2) coth(T/2τ), s: the lag that the first bound contains."""
        half = self.period_s / (2 * self.tau_s)
        return self.delay_ticks * self.period_s + self.period_s / (2 * math.tanh(half))


@dataclass(frozen=True)
class IntegralGains:
    """The largest proved gains, in K/s per unit of output, for one model and one timing.

    ``slope`` is λ in units of output per K.
    """

    any_state: float
    from_rest: float
    slope: float
    timing: LoopTiming

    def limits_text(self, unit: str) -> str:
        """Both gains with their unit, and the timing for which they hold. ``unit``: of the output.

        >>> IntegralGains(0.52, 0.13, 0.35, LoopTiming(0.1, 5.3, 0.1)).limits_text("mm")
        '0.13 K/(mm·s) from rest and 0.52 K/(mm·s) from any state (τ 5.3 s, dead time 0.1 s, no noise)'
        """
        gain_unit = spaced(integral_gain_unit(unit))
        return (
            f"{self.from_rest:.4g}{gain_unit} from rest and {self.any_state:.4g}{gain_unit} from any state "
            f"(τ {self.timing.tau_s:.3g} s, dead time {self.timing.delay_ticks * self.timing.period_s:.3g} s, no noise)"
        )

    def statement(self, gain: float, unit: str = "") -> str:
        """What is proved about a loop with this gain around the model, in two sentences. ``unit``: of the output."""
        head = (
            f"Integral gain {gain:.4g}{spaced(integral_gain_unit(unit))}; convergence of this model is certified up to "
            f"{self.limits_text(unit)}."
        )
        if gain <= self.from_rest * (1 + 1e-12):
            return f"{head} From rest it does not overshoot and stays within a count of the set-point."
        if gain < self.any_state:
            return f"{head} It may overshoot, and the proof requires that the source stays inside its limits."
        return f"{head} For this gain nothing is certified."


def integral_gains(hysteresis: Everett, timing: LoopTiming) -> IntegralGains:
    """The gains for a hysteresis. Raises UsageError if its output can fall as the input rises, or jump.

    >>> from smarig.preisach import thesis_surface
    >>> gains = integral_gains(thesis_surface("one_e"), LoopTiming(0.1, 5.3))
    >>> round(gains.any_state * gains.slope * 5.3, 3), round(gains.from_rest * gains.slope * 5.3, 3)
    (1.0, 0.25)
    """
    slope = largest_slope(hysteresis)
    steepest = slope.value if math.isnan(slope.bound) else slope.bound
    if not math.isfinite(steepest):
        raise UsageError(
            "The output of this model jumps at the thresholds of its relays, so no integral gain is certified. "
            "Give a gain, or use a surface or a table."
        )
    if not monotone(hysteresis).holds:
        raise UsageError(
            "The output of this model falls somewhere as its input rises (Assumption 2.1 fails), so no integral gain "
            "is certified. Give a gain, or use a model that satisfies it."
        )
    if steepest <= 0.0:
        raise UsageError("The output of this model does not move, so no integral gain is certified.")
    from_rest = _without_overshoot(timing.decay, timing.delay_ticks) / (timing.period_s * steepest)
    return IntegralGains(1.0 / (steepest * timing.total_lag_s), from_rest, steepest, timing)


def _without_overshoot(a: float, d: int) -> float:
    """max over a < γ < 1 of (1 − γ) γ^(d−1) (γ − a)/(1 − a), at the root of (d+1)γ² − d(1+a)γ + (d−1)a = 0."""
    middle = d * (1 + a)
    gamma = (middle + math.sqrt(middle * middle - 4 * (d * d - 1) * a)) / (2 * (d + 1))
    return (1 - gamma) * gamma ** (d - 1) * (gamma - a) / (1 - a)
