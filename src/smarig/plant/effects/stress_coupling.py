"""A compliant load increases the stress with the stroke, which shifts the transformation temperatures.

    T_h = T − S (ξ − ξ₀),    S = Δσ/C (Clausius–Clapeyron),    ξ₀ = 0 with one wire, ½ with two

T_h is the hysteresis input and ξ the present share of the stroke: an algebraic feedback, solved in each tick.
"""

from collections.abc import Mapping

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values


def _act(p: Values, context: EffectContext) -> Mapping[Stage, Hook]:
    shift, middle = p["shift_K"], 0.5 if context.actuator.two_wire else 0.0

    def hysteresis_input(u: float, now: PlantState) -> float:
        return u - shift * (now.share - middle)

    return {Stage.FEEDBACK: hysteresis_input}


stress_coupling = EffectType(
    name="stress_coupling",
    summary="A compliant load increases the stress with the stroke, which shifts the transformation temperatures.",
    number="E14",
    enters="feedback of the output on the input (a moving Preisach model)",
    looks_like="the loop leans and the family of curves shears",
    confused_with=("resistance_phase", "noncongruency", "thermal_expansion"),
    separated_by="a second load or spring: the curves shift by Δσ/C",
    remedy="keep the load constant, or identify at the load at which the wire will work",
    parameters=(
        Parameter("shift_K", "K", -25.0, 25.0, 8.0, "1 N on a 0.2 mm wire is 32 MPa, 4.5 K at C = 7 MPa/K"),
    ),
    act=_act,
    memoryless=True,
)
