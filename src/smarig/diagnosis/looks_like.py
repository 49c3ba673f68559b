"""The effects of both catalogues that leave an error which depends on a variable."""

from smarig.measurement import measurement_effect_types
from smarig.plant import MEAN_LEVELS, MEAN_POWERS

PLANT_EFFECTS = {
    "rate": ("latent_heat", "sensor_lag", "wire_lag"),
    "time": ("ambient_drift", "creep", "settling", "slip"),
    "cycle": ("accommodation", "fatigue", "training", "walking"),
    "history": ("accommodation", "creep", "noncongruency", "settling", "temperature_memory"),
    "time_since_reversal": ("backlash", "creep", "settling", "temperature_memory"),
    "level": (
        "eccentricity",
        "noncongruency",
        "resistance_phase",
        "saturation",
        "slack",
        "stress_coupling",  # of a load that changes with the stroke
    ),
    "input": ("r_phase", "thermal_expansion"),
    **dict.fromkeys(MEAN_POWERS, ("settling",)),
    **dict.fromkeys(MEAN_LEVELS, ("accommodation", "creep")),
}


def acts_through(effect: str) -> tuple[str, ...]:
    """The variables that the error of a plant's effect depends on."""
    return tuple(v for v, names in PLANT_EFFECTS.items() if effect in names)


def looks_like(variable: str) -> list[str]:
    """Names of effects, those of the measurement first."""
    measured = [k.name for k in measurement_effect_types() if variable in k.depends_on]
    return [*measured, *PLANT_EFFECTS.get(variable, ())]
