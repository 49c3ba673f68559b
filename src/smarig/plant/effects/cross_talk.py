"""Each wire heats the other through the air in the box.

    u_1 ← u_1 + k s_2,  u_2 ← u_2 + k s_1,    ds_j/dt = (u_j,∞ − s_j)/τ_p

This is slower than the wires themselves, so the differential temperature overshoots and returns.
"""

from collections.abc import Mapping
from math import exp

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values


def _act(p: Values, _context: EffectContext) -> Mapping[Stage, Hook]:
    share, tau_s = p["share_percent"] / 100, p["time_constant_s"]
    plume_K = 0.0  # s₁ − s₂

    def hysteresis_input(u: float, now: PlantState) -> float:
        nonlocal plume_K
        plume_K = now.source_K + (plume_K - now.source_K) * exp(-now.dt_s / tau_s)
        return u - share * plume_K

    return {Stage.INPUT: hysteresis_input}


cross_talk = EffectType(
    name="cross_talk",
    summary="Each wire heats the other through the air in the box.",
    number="E8",
    enters="input map: current of the other wire",
    looks_like="after a change of current, an approach that is slower than the wire's own",
    confused_with=("settling", "amplifier_gain"),
    separated_by="heating one wire with the other disconnected",
    remedy="move the wires apart, or put a shield between them",
    parameters=(
        Parameter("share_percent", "%", 0.0, 15.0, 5.0, "1–10 %, engineering estimate"),
        Parameter(
            "time_constant_s",
            "s",
            2.0,
            1000.0,
            60.0,
            "plume: seconds; enclosure: minutes",
            tries=(20.0, 60.0, 300.0),
        ),
    ),
    act=_act,
    arrangement="two_wire",
    output_independent=True,
)
