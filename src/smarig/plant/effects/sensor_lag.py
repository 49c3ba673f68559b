"""The sensor responds late: a first-order lag or a dead time.

    dc/dt = (c_true(t − d) − c)/τ

The motion of the wire does not change.
"""

from collections import deque
from collections.abc import Mapping
from math import exp

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values


def _act(p: Values, _context: EffectContext) -> Mapping[Stage, Hook]:
    lag_s, dead_s = p["lag_s"], p["dead_time_s"]
    delayed: deque[tuple[float, float]] = deque()
    reading: float | None = None
    arrived = 0.0

    def counts(true: float, now: PlantState) -> float:
        nonlocal reading, arrived
        delayed.append((now.t_s + dead_s, true))
        if reading is None:
            reading = arrived = true
        before = arrived
        while delayed and delayed[0][0] <= now.t_s + 1e-9:
            arrived = delayed.popleft()[1]
        left = exp(-now.dt_s / lag_s)  # exact for a constant rate within a tick
        reading = arrived - (arrived - before) * (1 - left) * lag_s / now.dt_s + (reading - before) * left
        return reading

    return {Stage.SENSOR: counts}


sensor_lag = EffectType(
    name="sensor_lag",
    summary="The sensor responds late: a first-order lag or a dead time.",
    number="—",
    enters="transient, in the sensor",
    looks_like="every approach is delayed by the same time, also outside the transformation",
    confused_with=("wire_lag",),
    separated_by="a step of the measurand itself (a tap on the pulley, hot water on the thermocouple)",
    remedy="use a faster sensor, or wait until it has settled",
    parameters=(
        Parameter("lag_s", "s", 0.0, 30.0, 3.0, "glued thermocouples 0.5–10 s; filtered encoders less"),
        Parameter("dead_time_s", "s", 0.0, 30.0, 0.0, "logging and filters"),
    ),
    act=_act,
)
