"""What a rig's limits leave of the current that a controller asks for: range and rate, once for every loop.

Refuses what is no number: such a loop is broken, and the run ends at zero.
"""

import math

from smarig.core import Drive, LimitExceeded, Protocol
from smarig.protocols import Setup

_RATE_MARGIN = 0.999  # of the largest step: rounding must not make it more


def limited_current(setup: Setup, commanded_A: float, last_A: float) -> float:
    """The nearest current to what is asked for that range and rate leave, after ``last_A``; LimitExceeded for NaN."""
    if not math.isfinite(commanded_A):
        raise LimitExceeded(
            f"The controller asked for {commanded_A} A: the loop is broken. The current is at zero."
        )
    step_A = _RATE_MARGIN * setup.limits.current_rate_A_per_s * setup.period_s
    rate_limited_A = min(max(commanded_A, last_A - step_A), last_A + step_A)
    return min(max(rate_limited_A, setup.current_for(setup.lower_K)), setup.current_for(setup.upper_K))


def ramp_to_zero(setup: Setup, current_A: float) -> Protocol:
    """From a current to zero, as fast as the rate limit allows."""
    while current_A:
        current_A = limited_current(setup, 0.0, current_A)
        yield Drive(current_A)
