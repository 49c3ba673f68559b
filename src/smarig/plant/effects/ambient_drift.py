"""The ambient temperature changes during the experiment.

    T = T_a(t) − T_a(0) + wire above ambient,    T_a(t) − T_a(0) = D [sin 2π(t/P + φ) − sin 2πφ]

Both wires of the differential rig have the same ambient temperature, so it cancels in T₁ − T₂.
"""

from collections.abc import Mapping
from math import pi, sin

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values


def _act(p: Values, _context: EffectContext) -> Mapping[Stage, Hook]:
    swing, per_s, phase = p["swing_K"], 1 / (3600 * p["period_h"]), p["phase"]

    def ambient(ambient_K: float, now: PlantState) -> float:
        return ambient_K + swing * (sin(2 * pi * (now.t_s * per_s + phase)) - sin(2 * pi * phase))

    return {Stage.AMBIENT: ambient}


ambient_drift = EffectType(
    name="ambient_drift",
    summary="The ambient temperature changes during the experiment.",
    number="E3",
    enters="input map: adds to the wire's temperature",
    looks_like="local slope of the hysteresis × a smooth function of clock time; nothing in saturation",
    confused_with=("walking", "fatigue", "slip"),
    separated_by="a thermometer in the box, or a pause of an hour: ambient drift continues, cycles do not",
    remedy="shield the wire from draughts and keep the room at one temperature",
    parameters=(
        Parameter(
            "swing_K", "K", -5.0, 5.0, 1.5, "rooms without temperature control vary by 0.2–3 K in hours"
        ),
        Parameter(
            "period_h",
            "h",
            0.1,
            48.0,
            12.0,
            "air conditioning 10–30 min, day 24 h",
            tries=(0.3, 0.7, 2.0),
            of_record=True,
            period_of="room",
        ),
        Parameter(
            "phase", "turn", 0.0, 1.0, 0.0, "phase of the period at the start of the run", tries=(0.0, 0.25)
        ),
    ),
    act=_act,
    output_independent=True,
)
