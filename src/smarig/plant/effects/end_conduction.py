"""The clamps cool the ends of the wire.

y = (1 − f) Γ[u] + f Γ[κ u]        a share f of the wire has the temperature κ u
"""

from collections.abc import Mapping

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values
from smarig.preisach import Preisach


def _act(p: Values, context: EffectContext) -> Mapping[Stage, Hook]:
    share, cooler = p["share_percent"] / 100, p["cooler"]
    ends = Preisach(context.hysteresis, context.initial)

    def output(y: float, now: PlantState) -> float:
        return y + share * (ends.step(cooler * now.hysteresis_input_K) - y)

    return {Stage.OUTPUT: output}


end_conduction = EffectType(
    name="end_conduction",
    summary="The clamps cool the ends of the wire.",
    number="E7",
    enters="adds relays in parallel",
    looks_like="a wider tail towards high currents; nothing that steady states can distinguish",
    confused_with=("r_phase", "convection"),
    separated_by="two lengths of wire; an infrared image",
    remedy="use a longer wire, or clamps that conduct less heat",
    parameters=(
        Parameter(
            "share_percent", "%", 0.0, 20.0, 6.0, "1–2 conduction lengths of 2–7 mm at each end: 2–7 %"
        ),
        Parameter("cooler", "1", 0.2, 1.0, 0.6, "mean temperature of the ends relative to the middle"),
    ),
    act=_act,
)
