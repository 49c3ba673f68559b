"""A model simulated along a timeline: its state at each time of a reading.

If the input of the hysteresis does not depend on its output, it is computed once for all densities
(``hysteresis_input``), and the outputs are computed along it. A feedback without memory then changes the input at
turning points and readings (``_with_feedback``). Otherwise the whole plant is simulated tick by tick. All give the same
numbers.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from smarig.plant import (
    EARLY_STAGES,
    Actuator,
    Effect,
    EffectContext,
    EffectType,
    Hook,
    Plant,
    PlantState,
    Stage,
    SupportsHooks,
    ThermalStages,
    ThermalState,
    apply_hooks,
    austenite_along,
    hook_chains,
    step_with_feedback,
)
from smarig.preisach import Everett, Initial, Preisach, State
from smarig.replay.plant_model import PlantModel
from smarig.replay.timeline import Timeline

Array = NDArray[np.float64]
Values = tuple[tuple[EffectType, tuple[tuple[str, float], ...]], ...]
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
WIRE_COLUMNS = ("wire_1_K", "wire_2_K")
TRAJECTORY_COLUMNS = ("counts", "output", "austenite", "resistance", "command_A", "current_A", "ambient_K")
AFTER_HYSTERESIS = (Stage.OUTPUT, Stage.ADDITIVE, Stage.SENSOR)
_row = attrgetter(*INPUT_COLUMNS)


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Values at each time of a reading (n,): ``columns`` (7, n) as in ``TRAJECTORY_COLUMNS``, and the memory.

    ``hysteresis_input_K`` (ticks,) is the input of the hysteresis at every tick. ``austenite`` is that of the wire that
    carries the current, and ``resistance`` a factor on its resistance at that austenite.
    """

    columns: Array
    states: tuple[State, ...]
    hysteresis_input_K: Array

    def __getitem__(self, name: str) -> Array:
        return self.columns[TRAJECTORY_COLUMNS.index(name)]


@dataclass(frozen=True, eq=False)
class InputTrajectory:
    """Thermal states at the ends of parts of ticks, ``columns`` (11, m) as in ``INPUT_COLUMNS`` and ``WIRE_COLUMNS``.

    ``ends`` (ticks,) is the index of the last part of each tick.
    """

    columns: Array
    ends: NDArray[np.int64]

    def __getitem__(self, name: str) -> Array:
        return self.columns[(*INPUT_COLUMNS, *WIRE_COLUMNS).index(name)]


def simulate_timeline(
    timeline: Timeline, plant_model: PlantModel, effects: Sequence[SupportsHooks]
) -> Trajectory:
    """A plant with these effects along one session."""
    context = EffectContext(plant_model.actuator, plant_model.hysteresis, plant_model.initial)
    feedback = [e for e in effects if _is_feedback_without_memory(e, context)]
    others = [e for e in effects if e not in feedback]
    inputs = hysteresis_input(timeline, plant_model, others)
    if inputs is None or (feedback and not _late_effects_memoryless(others, context)):
        return _by_ticks(timeline, plant_model, effects)
    if feedback:
        inputs = _with_feedback(timeline, plant_model, feedback, inputs)
    return _by_parts(timeline, plant_model, others, inputs)


def _by_ticks(timeline: Timeline, plant_model: PlantModel, effects: Sequence[SupportsHooks]) -> Trajectory:
    plant = Plant(plant_model.actuator, plant_model.hysteresis, plant_model.initial, 0.1, effects)
    per_count, before = plant_model.per_count or 1.0, 0.0
    t, current, is_read = timeline.ticks
    hysteresis_input_K, rows, states = np.empty(t.size), [], []
    for k, (now, i, mark) in enumerate(zip(t.tolist(), current.tolist(), is_read.tolist())):
        plant.advance(i, now - before)
        before = now
        hysteresis_input_K[k] = plant.hysteresis_input_K
        counts = plant.sensed(plant.position / per_count)  # at every tick, because a sensor may have a memory
        if mark:
            at = plant.now
            austenite = plant.austenite[-1 if i < 0 else 0]
            rows.append(
                (counts, plant.operator.y, austenite, at.resistance, i, plant.current(i), at.ambient_K)
            )
            states.append(plant.operator.state)
    return Trajectory(np.array(rows).T, tuple(states), hysteresis_input_K)


def _by_parts(
    timeline: Timeline, plant_model: PlantModel, effects: Sequence[SupportsHooks], inputs: InputTrajectory
) -> Trajectory:
    h = plant_model.hysteresis
    at = inputs.ends[timeline.ticks[2]]  # the parts that end at a reading
    output, states = _outputs_and_states(timeline, h, plant_model.initial, inputs)
    context = EffectContext(plant_model.actuator, h, plant_model.initial)
    late = hook_chains(effects, context)
    if any(late[stage] for stage in AFTER_HYSTERESIS):
        requested = at if _late_effects_memoryless(effects, context) else np.arange(inputs["t_s"].size)
        counts = _sensor_counts(plant_model, late, inputs, requested)[at]
    else:
        counts = output / (plant_model.per_count or 1.0)
    others = [inputs[name][at] for name in ("resistance", "command_A", "current_A", "ambient_K")]
    austenite = _austenite(plant_model, inputs, at, output)
    return Trajectory(
        np.stack([counts, output, austenite, *others]),
        states,
        np.clip(inputs["hysteresis_input_K"][inputs.ends], h.lower, h.upper),
    )


def _austenite(
    plant_model: PlantModel, inputs: InputTrajectory, at: NDArray[np.int64], output: Array
) -> Array:
    """Austenite (n,) of the wire that carries the current at parts (n,) with these outputs."""
    h = plant_model.hysteresis
    if not plant_model.actuator.two_wire:
        per_stroke = 1.0 / plant_model.stroke if plant_model.stroke else 0.0
        return (output - h.y_lower) * per_stroke
    wires_K = [inputs[name] + inputs["ambient_K"] for name in ("wire_1_K", "wire_2_K")]
    first, second = austenite_along(h, wires_K, at)
    return np.where(inputs["command_A"][at] < 0, second, first)


@lru_cache(maxsize=4)  # effects after the hysteresis share it
def _outputs(hysteresis: Everett, initial: Initial, inputs: InputTrajectory) -> tuple[float, Array]:
    """The initial output, and the outputs (m,) at the ends of all parts."""
    operator = Preisach(hysteresis, initial)
    return operator.y, operator.follow(inputs["hysteresis_input_K"])


@lru_cache(maxsize=4)  # effects after the hysteresis share it
def _outputs_and_states(
    timeline: Timeline, hysteresis: Everett, initial: Initial, inputs: InputTrajectory
) -> tuple[Array, tuple[State, ...]]:
    """Outputs (n,) and memories at the parts that end at a reading; only the turning points of a path are simulated."""
    operator = Preisach(hysteresis, initial, compiled=False)
    kept, at = _turns_and_readings(timeline, inputs)
    return operator.follow_with_states(inputs["hysteresis_input_K"][kept], np.searchsorted(kept, at).tolist())


def _turns_and_readings(
    timeline: Timeline, inputs: InputTrajectory
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """(parts at which a path turns or a reading is taken, the latter of them)."""
    path, at = inputs["hysteresis_input_K"], inputs.ends[timeline.ticks[2]]
    move = np.diff(path, prepend=path[0], append=path[-1])
    turns = move[:-1] * move[1:] <= 0
    turns[at] = True
    return np.flatnonzero(turns), at


def _is_feedback_without_memory(effect: SupportsHooks, context: EffectContext) -> bool:
    """Whether an effect changes the hysteresis input by the present output alone."""
    return (
        isinstance(effect, Effect)
        and effect.kind.memoryless
        and set(effect.hooks(context)) == {Stage.FEEDBACK}
    )


def _with_feedback(
    timeline: Timeline, plant_model: PlantModel, feedback: Sequence[SupportsHooks], inputs: InputTrajectory
) -> InputTrajectory:
    """Inputs of the hysteresis with a feedback of its output: solved where a path turns or is read.

    In between both inputs move one way. There the input with feedback is interpolated, which changes no output.
    """
    h, now = plant_model.hysteresis, PlantState()
    hooks = hook_chains(feedback, EffectContext(plant_model.actuator, h, plant_model.initial))[Stage.FEEDBACK]
    operator, span = Preisach(h, plant_model.initial, compiled=False), h.everett(h.upper, h.lower)
    per_span, path = 1.0 / span if span else 0.0, inputs["hysteresis_input_K"]
    kept, _ = _turns_and_readings(timeline, inputs)
    solved = []
    for u in path[kept].tolist():
        now.hysteresis_input_K = u
        step_with_feedback(hooks, now, operator, h.y_lower, per_span)
        solved.append(now.hysteresis_input_K)
    way = np.cumsum(np.abs(np.diff(path, prepend=path[0])))
    columns = inputs.columns.copy()
    columns[INPUT_COLUMNS.index("hysteresis_input_K")] = np.interp(way, way[kept], solved)
    return InputTrajectory(columns, inputs.ends)


def _late_effects_memoryless(effects: Sequence[SupportsHooks], context: EffectContext) -> bool:
    """Whether no effect after the hysteresis has a memory."""
    remembering = [e for e in effects if not (isinstance(e, Effect) and e.kind.memoryless)]
    return not any(stage in AFTER_HYSTERESIS for e in remembering for stage in e.hooks(context))


def _sensor_counts(
    plant_model: PlantModel,
    late: Mapping[Stage, tuple[Hook, ...]],
    inputs: InputTrajectory,
    requested: NDArray[np.int64],
) -> Array:
    """Sensor counts at the ends of parts (m,), 0 if not requested or if the part ends within a tick."""
    per_count, maps, added, sensor = (
        plant_model.per_count or 1.0,
        *(late[stage] for stage in AFTER_HYSTERESIS),
    )
    counts = np.zeros(inputs["t_s"].size)
    for k, (now, whole_s) in zip(requested.tolist(), _plant_states(plant_model, inputs, maps, requested)):
        position = apply_hooks(added, apply_hooks(maps, now.output, now), now)
        if whole_s:
            now.dt_s = whole_s
            counts[k] = apply_hooks(sensor, position / per_count, now)
    return counts


def _plant_states(
    plant_model: PlantModel, inputs: InputTrajectory, maps: tuple[Hook, ...], requested: NDArray[np.int64]
) -> Iterator[tuple[PlantState, float]]:
    """(state at the end of each requested part, length of the tick that ends there or 0)."""
    h = plant_model.hysteresis
    began, y = _outputs(h, plant_model.initial, inputs)
    span = h.everett(h.upper, h.lower)
    per_span = 1.0 / span if span else 0.0
    now = PlantState(output=began, share=(began - h.y_lower) * per_span)
    apply_hooks(maps, began, now)  # initial state
    travel = np.cumsum(np.abs(np.diff(y, prepend=began)) * per_span)
    whole = np.zeros(y.size)
    whole[inputs.ends] = np.diff(inputs["t_s"][inputs.ends], prepend=0.0)
    columns = (*inputs.columns[: len(INPUT_COLUMNS)], y, (y - h.y_lower) * per_span, travel, whole)
    rows = zip(*(column[requested].tolist() for column in columns))
    for row in rows:
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
            now.output,
            now.share,
            now.travel,
            ends_s,
        ) = row
        yield now, ends_s


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
        early.append((effect.kind, tuple(effect.values.items())))
    return _cached_trajectory(timeline, plant_model.actuator, (h.lower, h.upper), initial, tuple(early))


@lru_cache(maxsize=CACHE_SIZE)
def _cached_trajectory(
    timeline: Timeline, actuator: Actuator, input_range: tuple[float, float], initial: Initial, early: Values
) -> InputTrajectory:
    context = EffectContext(actuator, _HysteresisRange(*input_range), initial)  # pyright: ignore[reportArgumentType]
    hooks = hook_chains([kind(**dict(values)) for kind, values in early], context)
    return _computed_trajectory(timeline, ThermalStages(actuator, hooks, ThermalState()))  # pyright: ignore[reportArgumentType]


def _computed_trajectory(timeline: Timeline, thermal_stages: ThermalStages) -> InputTrajectory:
    t, current, _ = timeline.ticks
    now, before, rows, ends = thermal_stages.now, 0.0, [], []
    for end, command_A in zip(t.tolist(), current.tolist()):
        dt_s, start_s = end - before, now.t_s
        parts = thermal_stages.parts(command_A, dt_s)
        now.dt_s = dt_s / parts
        for k in range(1, parts + 1):
            thermal_stages.hysteresis_input(command_A, 0.0, start_s + dt_s * k / parts)
            rows.append((*_row(now), *thermal_stages.heating.wire_K))
        ends.append(len(rows) - 1)
        before = end
    return InputTrajectory(np.array(rows).T.copy(), np.array(ends))
