"""The pulley is eccentric to its axle.

y ← y + ε r [sin(y/r + 2πφ) − sin 2πφ]        r in the unit of y per radian
"""

from collections.abc import Mapping
from math import degrees, pi, sin

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values


def _act(p: Values, context: EffectContext) -> Mapping[Stage, Hook]:
    wire = context.actuator
    radius = wire.file.transmission.radius.value if wire.unit == "mm" else degrees(1)
    height, phase = p["share_percent"] / 100 * radius, 2 * pi * p["phase"]

    def output(y: float, _now: PlantState) -> float:
        return y + height * (sin(y / radius + phase) - sin(phase))

    return {Stage.OUTPUT: output}


eccentricity = EffectType(
    name="eccentricity",
    summary="The pulley is eccentric to its axle.",
    number="E22",
    enters="output map",
    looks_like="a wave along the position, the same on the way up and down",
    confused_with=("noncongruency",),
    separated_by="turning the pulley by half a turn: the wave turns with it",
    remedy="centre the pulley, or calibrate the encoder over a full turn",
    parameters=(
        Parameter("share_percent", "%", -10.0, 10.0, 2.0, "0.1–2 % of the radius"),
        Parameter("phase", "turn", 0.0, 1.0, 0.25, "angle of the pulley at y = 0", tries=(0.0, 0.25)),
    ),
    act=_act,
    memoryless=True,
    needs_wheel=True,
)
