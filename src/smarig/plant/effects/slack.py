"""The cold wire is slack: below a certain stroke it does not turn the pulley.

    y ← max(y, y₋ + s (y₊ − y₋))

The wire continues to transform meanwhile.
"""

from collections.abc import Mapping

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values


def _act(p: Values, context: EffectContext) -> Mapping[Stage, Hook]:
    floor = context.y_lower + p["floor_percent"] / 100 * context.stroke

    def output(y: float, _now: PlantState) -> float:
        return max(y, floor)

    return {Stage.OUTPUT: output}


slack = EffectType(
    name="slack",
    summary="The cold wire is slack: below a certain stroke it does not turn the pulley.",
    number="E24",
    enters="output map",
    looks_like="a flat floor at the cold end, always at the same position",
    confused_with=("dead_zone", "backlash"),
    separated_by="more pre-load; the voltage, which changes while y is constant",
    remedy="raise the pre-load until the wire is never slack",
    change=("The cold wire is slack: it does not turn the pulley in the lowest {size}.",),
    parameters=(
        Parameter(
            "floor_percent", "%", 0.0, 30.0, 4.0, "0–1 mm of a stroke of 12 mm", tries=(1.0, 4.0, 10.0)
        ),
    ),
    act=_act,
    memoryless=True,
)
