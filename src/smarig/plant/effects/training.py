"""A new wire ratchets fast at first and more slowly with every cycle (training).

y ← y + c (y₊ − y₋) ln(1 + N/N₀)        N: number of full cycles (Bo and Lagoudas 1999, ε = C₁ ln(1 + C₂ ζ))
"""

from collections.abc import Mapping
from math import log1p

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values


def _act(p: Values, context: EffectContext) -> Mapping[Stage, Hook]:
    size, cycles = p["percent_per_e_fold"] / 100 * context.stroke, p["cycles"]

    def added(y: float, now: PlantState) -> float:
        return y + size * log1p(now.cycles / cycles)

    return {Stage.ADDITIVE: added}


training = EffectType(
    name="training",
    summary="A new wire ratchets fast at first and more slowly with every cycle (training).",
    number="E18",
    enters="additive",
    looks_like="the same at all positions, saturated ends included; grows with the logarithm of the number of cycles",
    confused_with=("walking", "fatigue"),
    separated_by="ten times as many cycles: walking continues, training nearly stops",
    remedy="cycle the wire at its working load until its loop repeats",
    parameters=(
        Parameter(
            "percent_per_e_fold",
            "%",
            -20.0,
            20.0,
            1.0,
            "new NiTi under load gains 0.5–5 % of its stroke in tens of cycles; engineering estimate",
        ),
        Parameter("cycles", "cycle", 0.05, 200.0, 2.0, "engineering estimate", tries=(0.3, 2.0, 15.0)),
    ),
    act=_act,
    memoryless=True,
    arrangement="untrained",
)
