"""What a wire felt along a story where that does not ask what it did: the same for every density, so walked once.

An effect that looks at the output before the hysteresis moves, or is driven by it, has no such path; a blind moment
finds that out. Knows no hysteresis but its range.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from smarig.plant.actuator import Actuator
from smarig.plant.effect import Effect, EffectContext, EffectType, Stage, SupportsHooks, ThermalState, chains
from smarig.plant.thermal_stages import EARLY_STAGES, ThermalStages
from smarig.preisach.operator import Initial
from smarig.replay.plant_model import PlantModel
from smarig.replay.timeline import Timeline

Array = NDArray[np.float64]
Values = tuple[tuple[EffectType, tuple[tuple[str, float], ...]], ...]
CACHE_SIZE = 24  # paths remembered
INPUT_COLUMNS = (
    "t_s",
    "dt_s",
    "command_A",
    "current_A",
    "resistance",
    "ambient_K",
    "source_K",
    "input_K",
    "hysteresis_input_K",
)
_row = attrgetter(*INPUT_COLUMNS)


@dataclass(frozen=True, eq=False)
class InputTrajectory:
    """Moments at the ends of parts of ticks, ``columns`` (9, m) as in ``INPUT_COLUMNS``; the last part of each tick."""

    columns: Array
    ends: NDArray[np.int64]

    def __getitem__(self, name: str) -> Array:
        return self.columns[INPUT_COLUMNS.index(name)]


@dataclass(frozen=True)
class _HysteresisRange:
    """All that an early effect may know of a hysteresis."""

    lower: float
    upper: float


def hysteresis_input(
    timeline: Timeline, plant_model: PlantModel, effects: Sequence[SupportsHooks]
) -> InputTrajectory | None:
    """The path, or None where it depends on the output."""
    h, initial = plant_model.hysteresis, plant_model.initial
    context, early = EffectContext(plant_model.actuator, h, initial), []
    for effect in effects:
        stages = set(effect.hooks(context))
        if Stage.FEEDBACK in stages or (stages & set(EARLY_STAGES) and stages - set(EARLY_STAGES)):
            return None
        if stages & set(EARLY_STAGES):
            if not isinstance(effect, Effect):
                return None
            early.append((effect.kind, tuple(effect.values.items())))
    return _cached_trajectory(timeline, plant_model.actuator, (h.lower, h.upper), initial, tuple(early))


@lru_cache(maxsize=CACHE_SIZE)
def _cached_trajectory(
    timeline: Timeline, actuator: Actuator, input_range: tuple[float, float], initial: Initial, early: Values
) -> InputTrajectory | None:
    context = EffectContext(actuator, _HysteresisRange(*input_range), initial)  # pyright: ignore[reportArgumentType]
    try:
        hooks = chains([kind(**dict(values)) for kind, values in early], context)
        return _computed_trajectory(timeline, ThermalStages(actuator, hooks, ThermalState()))  # pyright: ignore[reportArgumentType]
    except AttributeError:  # it looked for the output
        return None


def _computed_trajectory(timeline: Timeline, thermal_stages: ThermalStages) -> InputTrajectory:
    t, current, _ = timeline.ticks
    now, before, rows, ends = thermal_stages.now, 0.0, [], []
    for end, command_A in zip(t.tolist(), current.tolist()):
        dt_s, start_s = end - before, now.t_s
        parts = thermal_stages.parts(command_A, dt_s)
        now.dt_s = dt_s / parts
        for k in range(1, parts + 1):
            thermal_stages.hysteresis_input(command_A, 0.0, start_s + dt_s * k / parts)
            rows.append(_row(now))
        ends.append(len(rows) - 1)
        before = end
    return InputTrajectory(np.array(rows).T.copy(), np.array(ends))
