"""The pulley slips once, or the encoder loses counts once.

    y ← y + J (y₊ − y₋) for t ≥ t₁

The saturated ends shift by the same amount.
"""

from collections.abc import Mapping

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values


def _act(p: Values, context: EffectContext) -> Mapping[Stage, Hook]:
    jump, at_s = p["jump_percent"] / 100 * context.stroke, 3600 * p["at_h"]

    def added(y: float, now: PlantState) -> float:
        return y + jump if now.t_s >= at_s else y

    return {Stage.ADDITIVE: added}


slip = EffectType(
    name="slip",
    summary="The pulley slips once, or the encoder loses counts once.",
    number="E21",
    enters="additive",
    looks_like="a simultaneous step in all later residuals, including the saturated ends",
    confused_with=("walking", "ambient_drift"),
    separated_by="the index pulse, or a reading in saturation before and after",
    remedy="tighten the clamps and the coupling of the encoder, and zero it again",
    change=(
        "The position jumped up once, by {size}.",
        "The position jumped down once, by {size}.",
    ),
    parameters=(
        Parameter("jump_percent", "%", -30.0, 30.0, 2.0, "1–50 counts of a stroke of 255"),
        Parameter(
            "at_h",
            "h",
            0.0,
            1000.0,
            1.0,
            "when",
            tries=tuple((k + 0.5) / 24 for k in range(24)),
            of_record=True,
        ),
    ),
    act=_act,
    memoryless=True,
)
