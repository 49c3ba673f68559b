"""Series diodes: below a current nothing flows.

    i = sign(i_c) max(0, |i_c| − i_d)

The two-wire rig steers its current by diodes (§5.1.2).
"""

from collections.abc import Mapping
from math import copysign

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values


def _act(p: Values, _context: EffectContext) -> Mapping[Stage, Hook]:
    below = p["below_A"]

    def current(i: float, _now: PlantState) -> float:
        return copysign(max(0.0, abs(i) - below), i)

    return {Stage.CURRENT: current}


dead_zone = EffectType(
    name="dead_zone",
    summary="Series diodes: below a current nothing flows.",
    number="E11",
    enters="input map: current",
    looks_like="a flat foot at small currents; the measured current shows it",
    confused_with=("slack", "amplifier_gain"),
    separated_by="the measured current",
    parameters=(
        Parameter(
            "below_A",
            "A",
            0.0,
            0.3,
            0.05,
            "0.6–1.4 V of diodes over the wire's resistance, less what feedback removes",
            tries=(0.004, 0.0125, 0.05, 0.12),
        ),
    ),
    act=_act,
    output_independent=True,
)
