"""Series diodes: no current flows below a threshold.

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
    summary="Series diodes: no current flows below a threshold.",
    number="E11",
    enters="input map: current",
    looks_like="no response at small currents; visible in the measured current",
    confused_with=("slack", "amplifier_gain"),
    separated_by="the measured current",
    remedy="use a current source without a dead zone, or command only currents above it",
    parameters=(
        Parameter(
            "below_A",
            "A",
            0.0,
            0.3,
            0.05,
            "0.6–1.4 V of the diodes divided by the wire's resistance, less what feedback compensates",
            tries=(0.004, 0.0125, 0.05, 0.12),
        ),
    ),
    act=_act,
    output_independent=True,
)
