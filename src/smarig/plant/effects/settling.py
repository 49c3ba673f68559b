"""A slow second thermal mass (clamp, plate, enclosure) follows the wire's power.

    T = (1 − f) u + f s,    ds/dt = (u_∞ − s)/τ_s        u_∞ the steady temperature of the present current

The test "steady for 25 s" is met while up to τ_s/25 counts of movement remain.
"""

from collections.abc import Mapping
from math import exp

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values


def _act(p: Values, _context: EffectContext) -> Mapping[Stage, Hook]:
    share, tau_s = p["share_percent"] / 100, p["time_constant_s"]
    mass_K = 0.0

    def hysteresis_input(u: float, now: PlantState) -> float:
        nonlocal mass_K
        mass_K = now.source_K + (mass_K - now.source_K) * exp(-now.dt_s / tau_s)
        return u + share * (mass_K - u)

    return {Stage.INPUT: hysteresis_input}


settling = EffectType(
    name="settling",
    summary="A slow second thermal mass (clamp, plate, enclosure) follows the wire's power.",
    number="E2",
    enters="input map",
    looks_like="opposite to the power change of the last τ_s, times the local slope; drift at the end of holds",
    confused_with=("ambient_drift", "creep", "accommodation"),
    separated_by="the same curve with holds ten times as long; power steps outside the transformation",
    remedy="hold each level longer",
    parameters=(
        Parameter("share_percent", "%", 0.0, 10.0, 2.0, "0.3–6 % of the heating, engineering estimate"),
        Parameter(
            "time_constant_s",
            "s",
            50.0,
            3000.0,
            600.0,
            "100–2000 s, engineering estimate",
            tries=(150.0, 500.0, 1800.0),
        ),
    ),
    act=_act,
    output_independent=True,
)
