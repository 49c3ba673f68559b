"""The amplifier delivers a current that differs from the command.

    i = (1 + g) i_c + o

If the output is off, it stays off.
"""

from collections.abc import Mapping

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values


def _act(p: Values, _context: EffectContext) -> Mapping[Stage, Hook]:
    gain, offset = 1 + p["gain_percent"] / 100, p["offset_A"]

    def current(i: float, _now: PlantState) -> float:
        return gain * i + offset if i else i

    return {Stage.CURRENT: current}


amplifier_gain = EffectType(
    name="amplifier_gain",
    summary="The amplifier delivers a current that differs from the command.",
    number="E10",
    enters="input map: current",
    looks_like="no change in steady states as a function of the command; visible in the measured current",
    confused_with=("convection", "dead_zone"),
    separated_by="the measured current, checked with a shunt",
    remedy="calibrate the current source against a shunt",
    parameters=(
        Parameter("gain_percent", "%", -15.0, 15.0, 3.0, "0.1–2 %, engineering estimate"),
        Parameter("offset_A", "A", -0.05, 0.05, 0.0, "0–10 mA, engineering estimate"),
    ),
    act=_act,
    output_independent=True,
)
