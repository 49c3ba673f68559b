"""Inverts the heating lag: the source that brings a wire to a temperature within a time, and its current.

    T(t + h) = s + (T − s) e^(−h/λτ)   ⇒   s = T + (T* − T) / (1 − e^(−h/λτ)),        i = sgn(s) √(|s| hA/κR)

This is (5.1) solved for a source that is constant over the horizon h. λ and κ are the factors of effects (latent heat,
convection, …) on the time constant and on the steady temperature, from the model's last tick; 1 without effects. Short
horizons need large sources. The source is clipped to the range of the current; one wire cools no faster than at zero
current.
"""

import math

from smarig.plant import Plant
from smarig.protocols import Setup

MIN_FACTOR, MAX_FACTOR = (
    0.3,
    8.0,
)  # range of plausible λ and κ: relays that switch at rest make λ arbitrary


def current_towards(setup: Setup, model: Plant, goal_K: float, horizon_s: float) -> float:
    """The current, A, that brings the model's wire with its effects to ``goal_K`` in ``horizon_s``."""
    source_K = source_towards(setup, model.heating.input_K, goal_K, horizon_s, _plausible(model.lag))
    return setup.current_for(clipped(setup, source_K / _plausible(model.heating_ratio)))


def source_towards(setup: Setup, wire_K: float, goal_K: float, horizon_s: float, lag: float = 1.0) -> float:
    """Steady temperature within the range that brings a wire of time constant λτ to ``goal_K`` in ``horizon_s``."""
    return clipped(setup, wire_K + (goal_K - wire_K) / -math.expm1(-horizon_s / (lag * setup.tau_s)))


def clipped(setup: Setup, input_K: float) -> float:
    """The temperature, clipped to the rig's range."""
    return min(max(input_K, setup.lower_K), setup.upper_K)


def _plausible(ratio: float) -> float:
    return min(max(ratio, MIN_FACTOR), MAX_FACTOR)
