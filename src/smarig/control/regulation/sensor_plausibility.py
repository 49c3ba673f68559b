"""Whether what a set-point loop sees makes sense: an integral would follow a dead encoder to the end of the range.

Two signs that no set-point will come of it: the source at its limit and the wire still off, and a wire that by the
model must have moved far while its readings stood still. A room that warms or cools shifts the source as well, so only
what no room does counts. Knows the model's hysteresis; refuses to know the loop.
"""

import math

from smarig.core import LimitExceeded
from smarig.preisach import Everett, Preisach, State
from smarig.protocols import Setup

LIMIT_TAUS = 10.0  # at the limit, until the wire has come to rest there
OFF_TARGET = 0.03  # of the output's range: off the set-point
EXPECTED_MOTION = 0.3  # of the output's range: so far the model must have gone
STANDSTILL = 0.03  # of it: what counts as standing still


class SensorPlausibility:
    """``look(source_K, position, error)`` at every sample of a loop that was closed in ``state`` at rest."""

    def __init__(self, setup: Setup, hysteresis: Everett, state: State) -> None:
        self._setup, self._operator = setup, Preisach(hysteresis, state)
        self._range = abs(hysteresis.everett(hysteresis.upper, hysteresis.lower))
        self._wire_K, self._at_limit_s = state.u, 0.0
        self._last_motion = (state.y, math.nan)  # by the model and by the encoder, where that moved last

    def check(self, source_K: float, position: float, error: float) -> None:
        """Raise LimitExceeded when the set-point cannot be reached, or the readings cannot be true."""
        self._follow(source_K)
        self._check_reach(source_K, error)
        self._check_motion(position)

    def _follow(self, source_K: float) -> None:
        setup = self._setup
        self._wire_K += (source_K - self._wire_K) * -math.expm1(-setup.period_s / setup.tau_s)
        self._operator.step(self._wire_K)

    def _check_reach(self, source_K: float, error: float) -> None:
        setup = self._setup
        limited = source_K <= setup.lower_K or source_K >= setup.upper_K
        held_off_target = limited and abs(error) > OFF_TARGET * self._range
        self._at_limit_s = self._at_limit_s + setup.period_s if held_off_target else 0.0
        if self._at_limit_s > LIMIT_TAUS * setup.tau_s:
            raise LimitExceeded(
                f"The set-point is out of the wire's reach: the source has been at its limit of {source_K:.3g} K for "
                f"{self._at_limit_s:.0f} s, and the position is {abs(error):.3g} off. The current is at zero."
            )

    def _check_motion(self, position: float) -> None:
        output, read = self._last_motion
        if not abs(position - read) <= STANDSTILL * self._range:
            self._last_motion = self._operator.y, position
        elif abs(self._operator.y - output) > EXPECTED_MOTION * self._range:
            raise LimitExceeded(
                f"The wire must have moved by {abs(self._operator.y - output):.3g}, and the encoder says "
                f"{abs(position - read):.3g}: is the encoder stuck, or the wire broken? The current is at zero."
            )
