"""The centre of minor loops drifts towards the state, so repeated loops do not close.

    dz = |dξ|/l (ξ − z),    T_h = T + Λ (z − z₀)        T_h: hysteresis input, z₀: initial state of the run

z follows the output over l strokes of travel. Return-point memory is lost in proportion.
"""

from collections.abc import Mapping
from math import exp

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values


def _act(p: Values, _context: EffectContext) -> Mapping[Stage, Hook]:
    shift, strokes = p["shift_K"], p["strokes"]
    start: float | None = None
    follower = before = travel = 0.0

    def hysteresis_input(u: float, now: PlantState) -> float:
        nonlocal start, follower, before, travel
        if start is None:
            start = follower = before = now.share
            travel = now.travel
        progress = (now.travel - travel) / strokes
        if progress > 0:  # exact if the state changes at a constant rate along its travel
            left = exp(-progress)
            mean_follower = (now.share - before) * (1 - left) / progress
            follower = now.share - mean_follower + (follower - before) * left
            before, travel = now.share, now.travel
        return u + shift * (follower - start)

    return {Stage.INPUT: hysteresis_input}


accommodation = EffectType(
    name="accommodation",
    summary="The centre of minor loops drifts towards the state, so repeated loops do not close.",
    number="E15",
    enters="input map with memory",
    looks_like="repeated minor loops approach their limit geometrically; wiping-out fails",
    confused_with=("settling", "walking", "temperature_memory"),
    separated_by="a pause between repetitions: settling decays with time, accommodation does not",
    remedy="cycle the wire between the same levels until its loop repeats, then measure",
    parameters=(
        Parameter(
            "shift_K", "K", -8.0, 8.0, 3.0, "0.3–5 K, engineering estimate; mixing models after Della Torre"
        ),
        Parameter(
            "strokes", "stroke", 0.1, 5.0, 0.8, "0.2–2 strokes, engineering estimate", tries=(0.3, 0.8, 2.0)
        ),
    ),
    act=_act,
)
