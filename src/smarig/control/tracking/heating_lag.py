"""Through the heating lag: which source brings a wire to a temperature within a time, and which current makes it.

    T(t + h) = s + (T − s) e^(−h/λτ)   ⇒   s = T + (T* − T) / (1 − e^(−h/λτ)),        i = sgn(s) √(|s| hA/κR)

(5.1) solved for a source that is constant over the horizon h. λ and κ are what effects make of the time constant and
of the steady temperature (latent heat, convection, …), as the model had them in the last tick; 1 without effects.
Short horizons ask for much: what the current cannot give is clipped, and cooling of one wire is never faster than no
current at all. Knows no hysteresis.
"""

import math

from smarig.plant import Plant
from smarig.protocols import Setup

MIN_FACTOR, MAX_FACTOR = (
    0.3,
    8.0,
)  # of λ and κ that are believed: relays that wait for a wire at rest make λ what they please


def current_towards(setup: Setup, model: Plant, goal_K: float, horizon_s: float) -> float:
    """The current, A, that brings the model's wire to ``goal_K`` in ``horizon_s``, its effects included."""
    source_K = source_towards(setup, model.heating.input_K, goal_K, horizon_s, _plausible(model.lag))
    return setup.current_for(clipped(setup, source_K / _plausible(model.heating_ratio)))


def source_towards(setup: Setup, wire_K: float, goal_K: float, horizon_s: float, lag: float = 1.0) -> float:
    """Steady temperature, within the range, that brings a wire of time constant λτ to ``goal_K`` in ``horizon_s``."""
    return clipped(setup, wire_K + (goal_K - wire_K) / -math.expm1(-horizon_s / (lag * setup.tau_s)))


def clipped(setup: Setup, input_K: float) -> float:
    """A temperature within the rig's range."""
    return min(max(input_K, setup.lower_K), setup.upper_K)


def _plausible(ratio: float) -> float:
    return min(max(ratio, MIN_FACTOR), MAX_FACTOR)
