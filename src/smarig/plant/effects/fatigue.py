"""Transformation temperatures drift with the number of cycles.

T_h = T − B (1 − exp(−N/N₀))        T_h: hysteresis input, N: number of full cycles
"""

from collections.abc import Mapping
from math import expm1

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values


def _act(p: Values, _context: EffectContext) -> Mapping[Stage, Hook]:
    shift, cycles = p["shift_K"], p["cycles"]

    def hysteresis_input(u: float, now: PlantState) -> float:
        return u + shift * expm1(-now.cycles / cycles)

    return {Stage.INPUT: hysteresis_input}


fatigue = EffectType(
    name="fatigue",
    summary="Transformation temperatures drift with the number of cycles.",
    number="E17",
    enters="input map, by the number of cycles",
    looks_like="local slope × a saturating function of the number of cycles",
    confused_with=("ambient_drift", "walking"),
    separated_by="a pause: cycles stop, ambient drift continues",
    remedy="lower the load or the highest temperature; replace the wire if the loss goes on",
    parameters=(
        Parameter(
            "shift_K", "K", -8.0, 8.0, 3.0, "untrained wire: several kelvin in the first tens of cycles"
        ),
        Parameter("cycles", "cycle", 0.5, 500.0, 8.0, "engineering estimate", tries=(2.0, 8.0, 40.0)),
    ),
    act=_act,
)
