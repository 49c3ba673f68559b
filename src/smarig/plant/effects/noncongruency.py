"""The output is a nonlinear function of the sum of the relays.

    m = ξ of the operator,    y = y₋ + (y₊ − y₋) [m + 2g m (1 − m)]

Minor loops between the same inputs then differ in height with their level: congruency fails.
"""

from collections.abc import Mapping

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values


def _act(p: Values, context: EffectContext) -> Mapping[Stage, Hook]:
    bend, stroke = p["bend_percent"] / 100, context.stroke

    def output(y: float, now: PlantState) -> float:
        m = now.share
        return y + stroke * 2 * bend * m * (1 - m)

    return {Stage.OUTPUT: output}


noncongruency = EffectType(
    name="noncongruency",
    summary="The output is a nonlinear function of the sum of the relays.",
    number="E16",
    enters="output map",
    looks_like="loops between the same inputs are higher at one level than at another",
    confused_with=("resistance_phase", "stress_coupling", "eccentricity"),
    separated_by="turning the pulley (eccentricity turns with it); the voltage; a second load",
    remedy="identify with minor loops at the outputs at which the wire will work",
    parameters=(Parameter("bend_percent", "%", -40.0, 40.0, 10.0, "1–20 %, engineering estimate"),),
    act=_act,
    memoryless=True,
)
