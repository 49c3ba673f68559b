"""The amplifier cannot deliver the largest commanded currents.

i = sign(i_c) min(|i_c|, i_max),    i_max = (1 − c) × the current that saturates the hysteresis
"""

from collections.abc import Mapping

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values


def _act(p: Values, context: EffectContext) -> Mapping[Stage, Hook]:
    most = (1 - p["clip_percent"] / 100) * context.largest_A

    def current(i: float, _now: PlantState) -> float:
        return min(max(i, -most), most)

    return {Stage.CURRENT: current}


saturation = EffectType(
    name="saturation",
    summary="The amplifier cannot deliver the largest commanded currents.",
    number="E11/E12",
    enters="input map: current",
    looks_like="different large commands give the same position; the measured current stops growing",
    confused_with=("dead_zone", "resistance_phase"),
    separated_by="the measured current",
    remedy="use a source with more current or voltage, or command only what it delivers",
    parameters=(
        Parameter(
            "clip_percent",
            "%",
            0.0,
            60.0,
            20.0,
            "supply voltage divided by wire resistance",
            tries=(5.0, 15.0, 30.0, 45.0),
        ),
    ),
    act=_act,
    output_independent=True,
)
