"""Friction at the pulley holds the wire until the force has changed enough.

    T_h = play_d(T), d = F_f/(A C): friction acts through the stress, on the input side; T_h: hysteresis input

relay(a, b) after play_d is relay(a + d, b − d): the loop becomes wider and is otherwise unchanged.
"""

from collections.abc import Mapping

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values


def _act(p: Values, _context: EffectContext) -> Mapping[Stage, Hook]:
    half = p["half_width_K"]
    held: float | None = None

    def hysteresis_input(u: float, _now: PlantState) -> float:
        nonlocal held
        held = u if held is None else min(max(held, u - half), u + half)
        return held

    return {Stage.INPUT: hysteresis_input}


coulomb_friction = EffectType(
    name="coulomb_friction",
    summary="Friction at the pulley holds the wire until the force has changed enough.",
    number="E19b",
    enters="input map: widens every relay",
    looks_like="nothing that a refitted density cannot represent",
    confused_with=("backlash",),
    separated_by="a manual push in the middle of a branch; another pulley",
    remedy="clean or replace the bearing of the pulley",
    parameters=(Parameter("half_width_K", "K", 0.0, 8.0, 2.0, "1 N on a 0.2 mm wire is 4.5 K"),),
    act=_act,
    output_independent=True,
)
