"""A model simulated along a timeline: its state at each time of a reading.

If the input of the hysteresis does not depend on its output, it is computed once for all densities
(``hysteresis_input``), and the outputs are computed along it. A feedback without memory then changes the input at
turning points and readings (``with_feedback``). Effects that shift the input by past outputs leave the temperatures
alone, so those are computed once, too (``with_shifts``). Otherwise the whole plant is simulated tick by tick. All
give the same numbers.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.plant import (
    Effect,
    EffectContext,
    Hook,
    Plant,
    PlantState,
    Stage,
    SupportsHooks,
    apply_hooks,
    austenite_along,
    hook_chains,
)
from smarig.preisach import Everett, Initial, Preisach, State
from smarig.replay.input_by_output import (
    is_feedback_without_memory,
    shifts_by_output,
    with_feedback,
    with_shifts,
)
from smarig.replay.input_trajectory import (
    INPUT_COLUMNS,
    InputTrajectory,
    hysteresis_input,
    set_inputs,
    turns_and_readings,
)
from smarig.replay.plant_model import PlantModel
from smarig.replay.timeline import Timeline

TRAJECTORY_COLUMNS = ("counts", "output", "austenite", "resistance", "command_A", "current_A", "ambient_K")
AFTER_HYSTERESIS = (Stage.OUTPUT, Stage.ADDITIVE, Stage.SENSOR)


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


def simulate_timeline(
    timeline: Timeline, plant_model: PlantModel, effects: Sequence[SupportsHooks]
) -> Trajectory:
    """A plant with these effects along one session."""
    context = EffectContext(plant_model.actuator, plant_model.hysteresis, plant_model.initial)
    feedback = [e for e in effects if is_feedback_without_memory(e, context)]
    others = [e for e in effects if e not in feedback]
    shifts = [] if feedback else shifts_by_output(others, context)
    if shifts:
        rest = [e for e in others if e not in shifts]
        inputs = hysteresis_input(timeline, plant_model, rest)
        if inputs is None:
            return _by_ticks(timeline, plant_model, effects)
        return _by_parts(timeline, plant_model, rest, with_shifts(plant_model, shifts, inputs))
    inputs = hysteresis_input(timeline, plant_model, others)
    if inputs is None or (feedback and not _late_effects_memoryless(others, context)):
        return _by_ticks(timeline, plant_model, effects)
    if feedback:
        inputs = with_feedback(timeline, plant_model, feedback, inputs)
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
    kept, at = turns_and_readings(timeline, inputs)
    return operator.follow_with_states(inputs["hysteresis_input_K"][kept], np.searchsorted(kept, at).tolist())


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
    early = inputs.columns[: len(INPUT_COLUMNS), requested].T.tolist()
    late = zip(*(column[requested].tolist() for column in (y, (y - h.y_lower) * per_span, travel, whole)))
    for row, (now.output, now.share, now.travel, ends_s) in zip(early, late):
        set_inputs(now, row)
        yield now, ends_s
