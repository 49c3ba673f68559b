"""What a rig's limits leave of the current that a controller asks for: range and rate, once for every loop.

Refuses what is no number: such a loop is broken, and the run ends at zero.
"""

import math

from smarig.command import Drive, Protocol
from smarig.errors import LimitExceeded
from smarig.protocols._setup import Setup

_WITHIN = 0.999  # of the largest step: rounding must not make it more


def allowed(setup: Setup, asked_A: float, last_A: float) -> float:
    """The nearest current to what is asked for that range and rate leave, after ``last_A``; LimitExceeded for NaN."""
    if not math.isfinite(asked_A):
        raise LimitExceeded(
            f"The controller asked for {asked_A} A: the loop is broken. The current is at zero."
        )
    step_A = _WITHIN * setup.limits.current_rate_A_per_s * setup.period_s
    slow = min(max(asked_A, last_A - step_A), last_A + step_A)
    return min(max(slow, setup.current_for(setup.lower_K)), setup.current_for(setup.upper_K))


def let_go(setup: Setup, current_A: float) -> Protocol:
    """From a current to zero, as fast as the rate limit allows."""
    while current_A:
        current_A = allowed(setup, 0.0, current_A)
        yield Drive(current_A)
