"""What can be hidden in a box: names, bounds, typical strengths and plausible ranges. Knows no equation.

Written down a second time on purpose: nothing here is shared with what will look for it.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from smarig.errors import UsageError

SESSION = "session"  # a range in shares of the session's length, in hours
_WEAKEST, _STRONGEST = 0.25, 2.0


@dataclass(frozen=True)
class Second:
    """A secondary parameter: plausible range, how it is drawn ("even", "log", "session"), and its usual value."""

    name: str
    low: float
    high: float
    scale: str
    usual: float


@dataclass(frozen=True)
class Effect:
    """An effect: its strength's name, bounds and typical value; ``only`` one arrangement, where that is so."""

    strength: str
    lower: float
    upper: float
    typical: float
    seconds: tuple[Second, ...] = ()
    only: str = ""

    def values(self, given: Mapping[str, float]) -> dict[str, float]:
        """All parameters; those not given are usual."""
        known = {self.strength: self.typical} | {s.name: s.usual for s in self.seconds}
        unknown = set(given) - set(known)
        if unknown:
            raise UsageError(f"An effect of a box has no parameter {sorted(unknown)[0]!r}.")
        return known | {name: float(value) for name, value in given.items()}

    def drawn(self, rng: np.random.Generator, session_h: float) -> dict[str, float]:
        """Strength log-uniform about the typical one, of any sign that the bounds allow; plausible seconds."""
        size = abs(self.typical) * math.exp(rng.uniform(math.log(_WEAKEST), math.log(_STRONGEST)))
        negative = self.lower < 0 and rng.random() < 0.5
        strength = min(max(-size if negative else size, self.lower), self.upper)
        return {self.strength: strength} | {s.name: _second(s, rng, session_h) for s in self.seconds}


def _second(s: Second, rng: np.random.Generator, session_h: float) -> float:
    if s.scale == "log":
        return math.exp(rng.uniform(math.log(s.low), math.log(s.high)))
    return rng.uniform(s.low, s.high) * (session_h if s.scale == SESSION else 1.0)


EFFECTS: dict[str, Effect] = {
    "accommodation": Effect("shift_K", -8, 8, 3, (Second("strokes", 0.3, 2, "log", 0.8),)),
    "ambient_drift": Effect(
        "swing_K",
        -5,
        5,
        1.5,
        (Second("period_h", 0.5, 24, "log", 12), Second("phase", 0, 1, "even", 0)),
        only="one_wire",  # two wires share the room
    ),
    "amplifier_gain": Effect("gain_percent", -15, 15, 3, (Second("offset_A", 0, 0, "even", 0),)),
    "backlash": Effect("play_percent", 0, 10, 1.5),
    "convection": Effect("exponent", -0.3, 0.5, 0.15),
    "coulomb_friction": Effect("half_width_K", 0, 8, 2),
    "creep": Effect("percent_per_decade", 0, 5, 1),
    "cross_talk": Effect(
        "share_percent", 0, 15, 5, (Second("time_constant_s", 20, 300, "log", 60),), only="two_wire"
    ),
    "dead_zone": Effect("below_A", 0, 0.3, 0.05),
    "eccentricity": Effect("share_percent", -10, 10, 2, (Second("phase", 0, 1, "even", 0.25),)),
    "end_conduction": Effect("share_percent", 0, 20, 6, (Second("cooler", 0.4, 0.8, "even", 0.6),)),
    "fatigue": Effect("shift_K", -8, 8, 3, (Second("cycles", 2, 30, "log", 8),)),
    "latent_heat": Effect(
        "latent_J_per_g",
        0,
        60,
        20,
        (
            Second("cooling_ratio", 0.3, 1.2, "even", 1),
            Second("specific_heat_change_percent", 0, 0, "even", 0),
        ),
    ),
    "noncongruency": Effect("bend_percent", -40, 40, 10),
    "r_phase": Effect(
        "share_percent",
        0,
        30,
        12,
        (Second("at", 0.15, 0.7, "even", 0.3), Second("width_K", 1, 5, "log", 2)),
    ),
    "resistance_phase": Effect("change_percent", -30, 30, -10),
    "saturation": Effect("clip_percent", 0, 60, 20),
    "sensor_lag": Effect("lag_s", 0, 30, 3, (Second("dead_time_s", 0, 0, "even", 0),)),
    "settling": Effect("share_percent", 0, 10, 2, (Second("time_constant_s", 150, 2000, "log", 600),)),
    "slack": Effect("floor_percent", 0, 30, 4),
    "slip": Effect("jump_percent", -30, 30, 2, (Second("at_h", 0.15, 0.85, SESSION, 1),)),
    "stress_coupling": Effect("shift_K", -25, 25, 8),
    "temperature_memory": Effect("retard_K", 0, 3, 1.5, (Second("width_K", 2, 8, "log", 4),)),
    "thermal_expansion": Effect("percent_per_100K", 0, 10, 2),
    "walking": Effect("percent_per_cycle", -3, 3, 0.3),
    "wire_lag": Effect("change_percent", -80, 400, 40),
}

# What no record without these channels can show: a classical density takes it up.
INVISIBLE_WITHOUT: dict[str, tuple[str, ...]] = {
    "amplifier_gain": ("current", "voltage"),
    "convection": ("current", "voltage", "transients"),
    "coulomb_friction": (),
    "dead_zone": ("current", "voltage", "transients"),
    "end_conduction": (),
}


def possible(arrangement: str) -> list[str]:
    """Names of the effects that a rig can have."""
    return [name for name, effect in EFFECTS.items() if effect.only in ("", arrangement)]


def checked(hidden: Mapping[str, Mapping[str, float]], arrangement: str) -> dict[str, dict[str, float]]:
    """Effects with all their parameters; UsageError where there is no such thing on this rig."""
    for name in hidden:
        if name not in possible(arrangement):
            raise UsageError(f"No effect '{name}' can be hidden in a {arrangement} box.")
    return {name: EFFECTS[name].values(given) for name, given in sorted(hidden.items())}
