"""Friction at the pulley holds the wire until its force changes enough.

    T_felt = play_d(T), d = F_f/(A C): friction acts through the stress, on the input side

relay(a, b) after play_d is relay(a + d, b − d): the loop is wider, and nothing else.
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
    summary="Friction at the pulley holds the wire until its force changes enough.",
    number="E19b",
    enters="input map: widens every relay",
    looks_like="nothing that a refitted density does not take up",
    confused_with=("backlash",),
    separated_by="a push by hand in the middle of a branch; another pulley",
    parameters=(Parameter("half_width_K", "K", 0.0, 8.0, 2.0, "1 N on a 0.2 mm wire is 4.5 K"),),
    act=_act,
    output_independent=True,
)
