"""The wire expands with temperature in both phases.

y ← y − e (y₊ − y₋) u/(100 K)        u the wire's temperature above ambient
"""

from collections.abc import Mapping

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values


def _act(p: Values, context: EffectContext) -> Mapping[Stage, Hook]:
    per_K = p["percent_per_100K"] / 1e4 * context.stroke

    def added(y: float, now: PlantState) -> float:
        return y - per_K * now.input_K

    return {Stage.ADDITIVE: added}


thermal_expansion = EffectType(
    name="thermal_expansion",
    summary="The wire expands with temperature in both phases.",
    number="E23",
    enters="additive and reversible",
    looks_like="nothing that reversible relays cannot represent",
    confused_with=("noncongruency", "stress_coupling"),
    separated_by="steps in saturation, where only expansion remains",
    remedy="none is needed: it belongs to the wire, and the extended model contains it",
    parameters=(
        Parameter(
            "percent_per_100K",
            "%/100K",
            0.0,
            10.0,
            2.0,
            "6.6 (martensite) and 11 (austenite) 1e-6/K relative to a strain of 4 %",
        ),
    ),
    act=_act,
    memoryless=True,
)
