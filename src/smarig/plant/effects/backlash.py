"""The transmission has play: after a reversal the output does not move at first.

    y = play_b(x): y is constant while |x − y| ≤ b/2, and follows x beyond

The dead band is constant in counts, not in kelvin.
"""

from collections.abc import Mapping

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values


def _act(p: Values, context: EffectContext) -> Mapping[Stage, Hook]:
    half = p["play_percent"] / 200 * context.stroke
    held: float | None = None

    def output(y: float, _now: PlantState) -> float:
        nonlocal held
        held = y if held is None else min(max(held, y - half), y + half)
        return held

    return {Stage.OUTPUT: output}


backlash = EffectType(
    name="backlash",
    summary="The transmission has play: after a reversal the output does not move at first.",
    number="E19a",
    enters="output map with memory",
    looks_like="the first steps after every reversal are missing",
    confused_with=("resistance_phase", "noncongruency", "creep"),
    separated_by="an external push; a second encoder; the voltage, which changes while y is constant",
    remedy="preload the linkage in one direction, or measure the position at the wire itself",
    change=(
        "The transmission has play: after a reversal the output stays still over the first {size} of motion.",
    ),
    parameters=(
        Parameter(
            "play_percent", "%", 0.0, 10.0, 1.5, "0.5–5 counts of a stroke of 255", tries=(0.4, 1.5, 4.0)
        ),
    ),
    act=_act,
)
