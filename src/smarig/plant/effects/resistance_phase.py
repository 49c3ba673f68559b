"""The wire's resistance depends on the phase, so the heating by a current depends on the state.

    R(ξ) = R̄ [1 + ρ (ξ − ½)],    T_ss = (R(ξ)/hA) i²        ρ = (R_A − R_M)/R̄

With R_M > R_A (ρ < 0) heating decreases as the wire transforms, which gives the skew of thesis §5.4.1. In the
differential rig ξ is that of the wire that carries the current. The voltage of the phase, R_M + ξ (R_A − R_M) of the
actuator file, is multiplied by the same factor. So the heat is V·i only if the file's ``twin_heat`` is that of the
phase (docs/explanation/heat_of_a_twin.md).
"""

from collections.abc import Mapping

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values


def _act(p: Values, context: EffectContext) -> Mapping[Stage, Hook]:
    del context
    change = p["change_percent"] / 100

    def resistance(factor: float, now: PlantState) -> float:
        return factor * (1 + change * (now.austenite - 0.5))

    return {Stage.RESISTANCE: resistance}


resistance_phase = EffectType(
    name="resistance_phase",
    summary="The wire's resistance depends on the phase, so the heating by a current depends on the state.",
    number="E9",
    enters="feedback of the output on the heating, and the voltage",
    looks_like="a shift in temperature in proportion to power and ξ: the loop leans",
    confused_with=("stress_coupling", "noncongruency", "backlash"),
    separated_by="the voltage; or a second load, which changes the stress effect and not the resistance",
    remedy="command power instead of current, or correct the current by the measured voltage",
    parameters=(
        Parameter(
            "change_percent",
            "%",
            -30.0,
            30.0,
            -10.0,
            "5–20 % decrease measured in situ; martensite 80, austenite 100 µΩ cm (Flexinol data)",
        ),
    ),
    act=_act,
)
