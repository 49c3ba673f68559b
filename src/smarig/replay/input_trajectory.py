"""The input of the hysteresis along a timeline, with the thermal states that lead to it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from operator import attrgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.plant import (
    EARLY_STAGES,
    Actuator,
    Effect,
    EffectContext,
    Hook,
    PlantState,
    Stage,
    SupportsHooks,
    ThermalStages,
    ThermalState,
    hook_chains,
)
from smarig.preisach import Initial
from smarig.replay.plant_model import PlantModel
from smarig.replay.timeline import Timeline

CACHE_SIZE = 24  # number of cached trajectories
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
HEATING_STAGES = (Stage.CURRENT, Stage.RESISTANCE, Stage.SOURCE, Stage.LAG)
WIRE_COLUMNS = ("wire_1_K", "wire_2_K")
_row = attrgetter(*INPUT_COLUMNS)


@dataclass(frozen=True, eq=False)
class InputTrajectory:
    """Thermal states at the ends of parts of ticks, ``columns`` (11, m) as in ``INPUT_COLUMNS`` and ``WIRE_COLUMNS``.

    ``ends`` (ticks,) is the index of the last part of each tick.
    """

    columns: Array
    ends: NDArray[np.int64]

    def __getitem__(self, name: str) -> Array:
        return self.columns[(*INPUT_COLUMNS, *WIRE_COLUMNS).index(name)]


def turns_and_readings(
    timeline: Timeline, inputs: InputTrajectory
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """(parts at which a path turns or a reading is taken, the latter of them)."""
    path, at = inputs["hysteresis_input_K"], inputs.ends[timeline.ticks[2]]
    move = np.diff(path, prepend=path[0], append=path[-1])
    turns = move[:-1] * move[1:] <= 0
    turns[at] = True
    return np.flatnonzero(turns), at


def set_inputs(now: PlantState, row: Sequence[float]) -> None:
    """The thermal state at the end of a part, in the order of ``INPUT_COLUMNS``."""
    (
        now.t_s,
        now.dt_s,
        now.command_A,
        now.current_A,
        now.resistance,
        now.ambient_K,
        now.source_K,
        now.input_K,
        now.hysteresis_input_K,
    ) = row


@dataclass(frozen=True)
class _HysteresisRange:
    """The range of the hysteresis, which is all that an effect before it may depend on."""

    lower: float
    upper: float


def hysteresis_input(
    timeline: Timeline, plant_model: PlantModel, effects: Sequence[SupportsHooks]
) -> InputTrajectory | None:
    """The input of the hysteresis along a timeline, or None if an effect makes it depend on the output.

    ``EffectType.output_independent`` marks effects that do not; any other effect before the hysteresis counts as
    dependent on the output.
    """
    h, initial = plant_model.hysteresis, plant_model.initial
    context, early = EffectContext(plant_model.actuator, h, initial), []
    for effect in effects:
        stages = set(effect.hooks(context))
        if Stage.FEEDBACK in stages:
            return None
        if not stages & set(EARLY_STAGES):
            continue
        if stages - set(EARLY_STAGES) or not (isinstance(effect, Effect) and effect.kind.output_independent):
            return None
        early.append(effect)
    return _cached_trajectory(timeline, plant_model.actuator, (h.lower, h.upper), initial, tuple(early))


@lru_cache(maxsize=CACHE_SIZE)
def _cached_trajectory(
    timeline: Timeline,
    actuator: Actuator,
    input_range: tuple[float, float],
    initial: Initial,
    early: tuple[Effect, ...],
) -> InputTrajectory:
    context = EffectContext(actuator, _HysteresisRange(*input_range), initial)  # pyrefly: ignore [bad-argument-type]
    hooks = hook_chains(early, context)
    if early and not any(hooks[stage] for stage in HEATING_STAGES):
        alone = _cached_trajectory(timeline, actuator, input_range, initial, ())
        return _around_heating(alone, hooks, two_wire=actuator.two_wire)
    return _computed_trajectory(timeline, ThermalStages(actuator, hooks, ThermalState()))  # pyrefly: ignore [bad-argument-type]


def _around_heating(
    alone: InputTrajectory, hooks: Mapping[Stage, tuple[Hook, ...]], *, two_wire: bool
) -> InputTrajectory:
    """The trajectory with effects that heat no wire: they act on the temperatures of the wires ``alone``."""
    now: Any = ThermalState()
    ambient, at_input = hooks[Stage.AMBIENT], hooks[Stage.INPUT]
    heated_K = alone["wire_1_K"] - alone["wire_2_K"]
    names = ("t_s", "dt_s", "command_A", "current_A", "resistance", "source_K")
    changed: list[float] = []
    for t_s, dt_s, command_A, current_A, resistance, source_K, wire_K in zip(
        *(alone[name].tolist() for name in names), heated_K.tolist()
    ):
        now.t_s, now.dt_s, now.command_A = t_s, dt_s, command_A
        ambient_K = 0.0
        for hook in ambient:  # the rest of its state is that of the last tick
            ambient_K = hook(ambient_K, now)
        now.current_A, now.resistance, now.source_K = current_A, resistance, source_K
        now.ambient_K, now.input_K = ambient_K, wire_K + (0.0 if two_wire else ambient_K)
        input_K = now.input_K
        for hook in at_input:
            input_K = hook(input_K, now)
        now.hysteresis_input_K = input_K
        changed += (ambient_K, now.input_K, input_K)
    columns = alone.columns.copy()
    rows = [INPUT_COLUMNS.index(name) for name in ("ambient_K", "input_K", "hysteresis_input_K")]
    columns[rows] = np.array(changed).reshape(-1, len(rows)).T
    return InputTrajectory(columns, alone.ends)


def _computed_trajectory(timeline: Timeline, thermal_stages: ThermalStages) -> InputTrajectory:
    t, current, _ = timeline.ticks
    now, before, ends = thermal_stages.now, 0.0, []
    values: list[float] = []
    width = len(INPUT_COLUMNS) + len(WIRE_COLUMNS)
    for end, command_A in zip(t.tolist(), current.tolist()):
        dt_s, start_s = end - before, now.t_s
        parts = thermal_stages.parts(command_A, dt_s)
        now.dt_s = dt_s / parts
        for k in range(1, parts + 1):
            thermal_stages.hysteresis_input(command_A, 0.0, start_s + dt_s * k / parts)
            values += _row(now)
            values += thermal_stages.heating.wire_K
        ends.append(len(values) // width - 1)
        before = end
    return InputTrajectory(np.array(values).reshape(-1, width).T.copy(), np.array(ends))
