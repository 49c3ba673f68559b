"""The effects of boxes: names, bounds, typical strengths and plausible ranges.

They are written a second time on purpose: nothing here is shared with the diagnosis.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from smarig.core import UsageError

Hidden = dict[str, dict[str, float]]  # parameters of effects by name
SESSION = "session"  # a range in shares of the session's length, in hours
_WEAKEST, _STRONGEST = 0.25, 2.0


@dataclass(frozen=True)
class SecondaryParameter:
    """A secondary parameter: plausible range, its distribution ("even", "log", "session"), and its usual
    value."""

    name: str
    low: float
    high: float
    scale: str
    default: float


@dataclass(frozen=True)
class BoxEffect:
    """An effect: name, bounds and typical value of its strength; ``only`` names the one arrangement it
    occurs in, if any."""

    strength: str
    lower: float
    upper: float
    typical: float
    secondary: tuple[SecondaryParameter, ...] = ()
    only: str = ""

    def values(self, parameters: Mapping[str, float]) -> dict[str, float]:
        """All parameters. Parameters that are not given have their usual values."""
        defaults = {self.strength: self.typical} | {s.name: s.default for s in self.secondary}
        unknown = set(parameters) - set(defaults)
        if unknown:
            raise UsageError(f"An effect of a box has no parameter {sorted(unknown)[0]!r}.")
        return defaults | {name: float(value) for name, value in parameters.items()}

    def random_values(self, rng: np.random.Generator, session_h: float) -> dict[str, float]:
        """Strength log-uniform about the typical one, with a sign that the bounds allow; plausible secondary
        parameters."""
        size = abs(self.typical) * math.exp(rng.uniform(math.log(_WEAKEST), math.log(_STRONGEST)))
        negative = self.lower < 0 and rng.random() < 0.5
        strength = min(max(-size if negative else size, self.lower), self.upper)
        return {self.strength: strength} | {
            s.name: _random_secondary(s, rng, session_h) for s in self.secondary
        }


def _random_secondary(s: SecondaryParameter, rng: np.random.Generator, session_h: float) -> float:
    if s.scale == "log":
        return math.exp(rng.uniform(math.log(s.low), math.log(s.high)))
    return rng.uniform(s.low, s.high) * (session_h if s.scale == SESSION else 1.0)


EFFECTS: dict[str, BoxEffect] = {
    "accommodation": BoxEffect("shift_K", -8, 8, 3, (SecondaryParameter("strokes", 0.3, 2, "log", 0.8),)),
    "ambient_drift": BoxEffect(
        "swing_K",
        -5,
        5,
        1.5,
        (SecondaryParameter("period_h", 0.5, 24, "log", 12), SecondaryParameter("phase", 0, 1, "even", 0)),
        only="one_wire",  # two wires share the room
    ),
    "amplifier_gain": BoxEffect(
        "gain_percent", -15, 15, 3, (SecondaryParameter("offset_A", 0, 0, "even", 0),)
    ),
    "backlash": BoxEffect("play_percent", 0, 10, 1.5),
    "convection": BoxEffect("exponent", -0.3, 0.5, 0.15),
    "coulomb_friction": BoxEffect("half_width_K", 0, 8, 2),
    "creep": BoxEffect("percent_per_decade", 0, 5, 1),
    "cross_talk": BoxEffect(
        "share_percent",
        0,
        15,
        5,
        (SecondaryParameter("time_constant_s", 20, 300, "log", 60),),
        only="two_wire",
    ),
    "dead_zone": BoxEffect("below_A", 0, 0.3, 0.05),
    "eccentricity": BoxEffect(
        "share_percent", -10, 10, 2, (SecondaryParameter("phase", 0, 1, "even", 0.25),)
    ),
    "end_conduction": BoxEffect(
        "share_percent", 0, 20, 6, (SecondaryParameter("cooler", 0.4, 0.8, "even", 0.6),)
    ),
    "fatigue": BoxEffect("shift_K", -8, 8, 3, (SecondaryParameter("cycles", 2, 30, "log", 8),)),
    "latent_heat": BoxEffect(
        "latent_J_per_g",
        0,
        60,
        20,
        (
            SecondaryParameter("cooling_ratio", 0.3, 1.2, "even", 1),
            SecondaryParameter("specific_heat_change_percent", 0, 0, "even", 0),
        ),
    ),
    "noncongruency": BoxEffect("bend_percent", -40, 40, 10),
    "r_phase": BoxEffect(
        "share_percent",
        0,
        30,
        12,
        (SecondaryParameter("at", 0.15, 0.7, "even", 0.3), SecondaryParameter("width_K", 1, 5, "log", 2)),
    ),
    "resistance_phase": BoxEffect("change_percent", -30, 30, -10),
    "saturation": BoxEffect("clip_percent", 0, 60, 20),
    "sensor_lag": BoxEffect("lag_s", 0, 30, 3, (SecondaryParameter("dead_time_s", 0, 0, "even", 0),)),
    "settling": BoxEffect(
        "share_percent", 0, 10, 2, (SecondaryParameter("time_constant_s", 150, 2000, "log", 600),)
    ),
    "slack": BoxEffect("floor_percent", 0, 30, 4),
    "slip": BoxEffect("jump_percent", -30, 30, 2, (SecondaryParameter("at_h", 0.15, 0.85, SESSION, 1),)),
    "stress_coupling": BoxEffect("shift_K", -25, 25, 8),
    "temperature_memory": BoxEffect("retard_K", 0, 3, 1.5, (SecondaryParameter("width_K", 2, 8, "log", 4),)),
    "thermal_expansion": BoxEffect("percent_per_100K", 0, 10, 2),
    "walking": BoxEffect("percent_per_cycle", -3, 3, 0.3),
    "wire_lag": BoxEffect("change_percent", -80, 400, 40),
}

# Effects that no record without these channels can show, because a classical density represents them.
INVISIBLE_WITHOUT: dict[str, tuple[str, ...]] = {
    "amplifier_gain": ("current", "voltage"),
    "convection": ("current", "voltage", "transients"),
    "coulomb_friction": (),
    "dead_zone": ("current", "voltage", "transients"),
    "end_conduction": (),
}


def possible_effects(arrangement: str) -> list[str]:
    """Names of the effects that a rig can have."""
    return [name for name, effect in EFFECTS.items() if effect.only in ("", arrangement)]


def complete_parameters(
    hidden: Mapping[str, Mapping[str, float]], arrangement: str
) -> dict[str, dict[str, float]]:
    """Effects with all their parameters. Raises UsageError if an effect does not exist on this rig."""
    for name in hidden:
        if name not in possible_effects(arrangement):
            raise UsageError(f"No effect '{name}' can be hidden in a {arrangement} box.")
    return {name: EFFECTS[name].values(parameters) for name, parameters in sorted(hidden.items())}
