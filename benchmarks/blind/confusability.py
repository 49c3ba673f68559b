"""What may be taken for what, and which variable gives a missing effect away.

Groups after the confusability of static one-load data, and of transients; variables by the effects' own
equations. Written after some tuning boxes had been seen, before any table was reported.
"""

GROUPS: tuple[frozenset[str], ...] = (
    frozenset({"resistance_phase", "stress_coupling", "noncongruency", "eccentricity", "backlash"}),
    frozenset({"ambient_drift", "fatigue", "walking", "slip"}),
    frozenset({"settling", "creep"}),
    frozenset({"accommodation", "settling", "temperature_memory"}),
    frozenset({"wire_lag", "latent_heat", "sensor_lag", "convection"}),
    frozenset({"amplifier_gain", "dead_zone", "saturation"}),
    frozenset({"r_phase", "thermal_expansion", "end_conduction", "coulomb_friction", "noncongruency"}),
    frozenset({"slack", "dead_zone", "backlash"}),
)
_CLOCK = frozenset({"time", "cycle", "reversals"})  # one session: they grow together
_HISTORY = frozenset({"history", "step", "hold"})
VARIABLES: dict[str, frozenset[str]] = {
    **dict.fromkeys(("ambient_drift", "fatigue", "walking", "slip"), _CLOCK),
    **dict.fromkeys(("settling", "creep", "cross_talk"), _HISTORY | {"rate"} | _CLOCK),
    **dict.fromkeys(("accommodation", "temperature_memory", "backlash"), _HISTORY | {"level", "cycle"}),
    **dict.fromkeys(("wire_lag", "sensor_lag", "latent_heat", "convection"), frozenset({"rate", "step"})),
}
STATE_VARIABLES = frozenset({"level"}) | _HISTORY  # effects that depend on where the wire stands


def confusable(a: str, b: str) -> bool:
    """Whether two effects share a group."""
    return a == b or any(a in group and b in group for group in GROUPS)


def is_correct_variable(effect: str, variable: str | None) -> bool:
    """Whether a variable is one that the effect depends on."""
    return variable is not None and variable in VARIABLES.get(effect, STATE_VARIABLES)
