"""Integral action with the largest gain for which convergence is proved (``integral_gain``)."""

from smarig.control.regulation.integral_action import IntegralAction
from smarig.control.regulation.integral_gain import IntegralGains, LoopTiming, integral_gains
from smarig.core import UsageError
from smarig.preisach import Everett
from smarig.protocols import Setup


def integral(
    setup: Setup,
    hysteresis: Everett,
    count: float,
    *,
    gain: float | None = None,
    delay_s: float | None = None,
) -> IntegralAction:
    """Integral action with a gain for which convergence is certified, limits and counts included.

    gain (K/s/unit): change of the steady temperature per second and unit of error; the largest certified from rest
    delay_s (s): dead time of the rig beyond its tick; one tick unless given
    """
    timing = LoopTiming(setup.period_s, setup.tau_s, setup.period_s if delay_s is None else delay_s)
    unit, limits_K = setup.actuator.unit, (setup.lower_K, setup.upper_K)
    if gain is None:
        gains = integral_gains(hysteresis, timing)
        return IntegralAction(gains.from_rest, setup.period_s, limits_K, count, gains, unit)
    return IntegralAction(gain, setup.period_s, limits_K, count, _certified(hysteresis, timing), unit)


def _certified(hysteresis: Everett, timing: LoopTiming) -> IntegralGains | None:
    """The certified gains beside a gain of the user's own; None if there are none for this model."""
    try:
        return integral_gains(hysteresis, timing)
    except UsageError:
        return None
