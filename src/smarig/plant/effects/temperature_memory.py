"""A heating curve halts where an earlier incomplete heating stopped.

    while heating:    T_h = T − S exp(−((T − T_a)/w)²)        T_h: hysteresis input

T_a is the last incomplete peak. Cooling does not erase it (as wiping-out would); heating beyond T_a + 3 w does.
"""

from collections.abc import Mapping
from math import e, exp, sqrt

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values

_REVERSAL_K = 0.5  # smaller reversals are noise


def _act(p: Values, context: EffectContext) -> Mapping[Stage, Hook]:
    width = p["width_K"]
    retard = min(p["retard_K"], 0.8 * width * sqrt(e / 2))  # so that the hysteresis input still rises with T
    complete = context.hysteresis.upper - 3 * width
    heating, turn, held, arrest = True, float("-inf"), 0.0, float("-inf")

    def hysteresis_input(u: float, _now: PlantState) -> float:
        nonlocal heating, turn, held, arrest
        if heating and u < turn - _REVERSAL_K:
            heating, arrest = False, turn if turn < complete else float("-inf")
            turn = u
        elif not heating and u > turn + _REVERSAL_K:
            heating, turn = True, u
        turn = max(turn, u) if heating else min(turn, u)
        if not heating:
            held = min(held, u)
            return held
        if u > arrest + 3 * width:
            arrest = float("-inf")
        held = u - retard * exp(-(((u - arrest) / width) ** 2))
        return held

    return {Stage.INPUT: hysteresis_input}


temperature_memory = EffectType(
    name="temperature_memory",
    summary="A heating curve halts where an earlier incomplete heating stopped.",
    number="E15b",
    enters="input map with memory",
    looks_like="a dent in a heating branch at an earlier arrest, although saturation lay between",
    confused_with=("accommodation", "noncongruency"),
    separated_by="a full loop, several arrests at one temperature, a full loop",
    remedy="begin each run with a full heating and cooling cycle",
    parameters=(
        Parameter(
            "retard_K",
            "K",
            0.0,
            3.0,
            1.5,
            "differential scanning calorimetry of NiTi: a halt near the arrest",
            tries=(0.4, 1.5),
        ),
        Parameter("width_K", "K", 1.0, 15.0, 4.0, "1–5 K, engineering estimate", tries=(2.0, 4.0, 9.0)),
    ),
    act=_act,
    output_independent=True,
)
