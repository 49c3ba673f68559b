"""Through the heating lag: which source brings a wire to a temperature within a time, and which current makes it.

    T(t + h) = s + (T − s) e^(−h/τ)   ⇒   s = T + (T* − T) / (1 − e^(−h/τ)),        i = sgn(s) √(|s| hA/R)

(5.1) solved for a source that is constant over the horizon h. Short horizons ask for much: what the current
cannot give is clipped, and cooling of one wire is never faster than no current at all. Knows no hysteresis.
"""

import math

from smarig.protocols._setup import Setup


def source_towards(setup: Setup, wire_K: float, goal_K: float, horizon_s: float) -> float:
    """Steady temperature, within the range, whose current brings the wire to ``goal_K`` in ``horizon_s``."""
    asked = wire_K + (goal_K - wire_K) / -math.expm1(-horizon_s / setup.tau_s)
    return min(max(asked, setup.lower_K), setup.upper_K)


def clipped(setup: Setup, input_K: float) -> float:
    """A temperature within the rig's range."""
    return min(max(input_K, setup.lower_K), setup.upper_K)
