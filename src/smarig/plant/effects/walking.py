"""The wire lengthens or shortens slightly with every cycle (ratchet strain).

y ← y + d (y₊ − y₋) N        N: number of full cycles
"""

from collections.abc import Mapping

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values


def _act(p: Values, context: EffectContext) -> Mapping[Stage, Hook]:
    per_cycle = p["percent_per_cycle"] / 100 * context.stroke

    def added(y: float, now: PlantState) -> float:
        return y + per_cycle * now.cycles

    return {Stage.ADDITIVE: added}


walking = EffectType(
    name="walking",
    summary="The wire lengthens or shortens slightly with every cycle (ratchet strain).",
    number="E18",
    enters="additive",
    looks_like="the same at all positions, saturated ends included; depends on cycles, not on hours",
    confused_with=("slip", "ambient_drift", "fatigue"),
    separated_by="a pause; readings in saturation, where temperature does not matter",
    remedy="lower the load or the highest temperature, cycle the wire until it stops, and zero it in saturation",
    change=(
        "With every full cycle the position rises by {size}.",
        "With every full cycle the position falls by {size}.",
    ),
    parameters=(
        Parameter(
            "percent_per_cycle", "%/cycle", -3.0, 3.0, 0.3, "1e-4 strain per cycle is 0.2 % of a 4 % stroke"
        ),
    ),
    act=_act,
    memoryless=True,
)
