"""Limits the current that a controller commands to the range and rate of the rig, for every loop.

A command that is not finite ends the run at zero current.
"""

import math

from smarig.core import Drive, LimitExceeded, Protocol
from smarig.protocols import Setup

_RATE_MARGIN = 0.999  # of the largest step, so that rounding does not exceed it


def limited_current(setup: Setup, commanded_A: float, last_A: float) -> float:
    """The current nearest to the command within range and rate, after ``last_A``. Raises LimitExceeded for NaN."""
    if not math.isfinite(commanded_A):
        raise LimitExceeded(f"The controller commanded {commanded_A} A, so the loop is invalid.").at_zero()
    step_A = _RATE_MARGIN * setup.limits.current_rate_A_per_s * setup.period_s
    rate_limited_A = min(max(commanded_A, last_A - step_A), last_A + step_A)
    return min(max(rate_limited_A, setup.current_for(setup.lower_K)), setup.current_for(setup.upper_K))


def ramp_to_zero(setup: Setup, current_A: float) -> Protocol:
    """Drive from a current to zero as fast as the rate limit allows."""
    while current_A:
        current_A = limited_current(setup, 0.0, current_A)
        yield Drive(current_A)
