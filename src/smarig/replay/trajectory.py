"""How a subject lives through a story: what there was to read at each time of a reading.

By parts of ticks where what is felt is known beforehand (``hysteresis_input``), else tick by tick with the whole plant; either
gives the same numbers. Knows no kinds of readings.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.plant.effect import Effect, EffectContext, Hook, PlantState, Stage, SupportsHooks, chains
from smarig.plant.plant import Plant
from smarig.plant.thermal_stages import apply_hooks
from smarig.preisach.operator import Preisach, State
from smarig.replay.input_trajectory import InputTrajectory, hysteresis_input
from smarig.replay.plant_model import PlantModel
from smarig.replay.timeline import Timeline

Array = NDArray[np.float64]
TRAJECTORY_COLUMNS = ("counts", "output", "resistance", "command_A", "current_A", "ambient_K")
AFTER_HYSTERESIS = (Stage.OUTPUT, Stage.ADDITIVE, Stage.SENSOR)


@dataclass(frozen=True, eq=False)
class Trajectory:
    """At each time of a reading (n,): columns as in ``TRAJECTORY_COLUMNS`` (6, n) and the memory; ``hysteresis_input_K`` (ticks,) in between.

    ``resistance`` is a factor of the wire's own at its austenite.
    """

    columns: Array
    states: tuple[State, ...]
    hysteresis_input_K: Array

    def __getitem__(self, name: str) -> Array:
        return self.columns[TRAJECTORY_COLUMNS.index(name)]


def simulate_timeline(
    timeline: Timeline, plant_model: PlantModel, effects: Sequence[SupportsHooks]
) -> Trajectory:
    """The life of a subject with these effects, in one sitting."""
    inputs = hysteresis_input(timeline, plant_model, effects)
    return (
        _by_ticks(timeline, plant_model, effects)
        if inputs is None
        else _by_parts(timeline, plant_model, effects, inputs)
    )


def _by_ticks(timeline: Timeline, plant_model: PlantModel, effects: Sequence[SupportsHooks]) -> Trajectory:
    plant = Plant(plant_model.actuator, plant_model.hysteresis, plant_model.initial, 0.1, effects)
    per_count, before = plant_model.per_count or 1.0, 0.0
    t, current, is_read = timeline.ticks
    hysteresis_input_K, rows, states = np.empty(t.size), [], []
    for k, (now, i, mark) in enumerate(zip(t.tolist(), current.tolist(), is_read.tolist())):
        plant.advance(i, now - before)
        before = now
        hysteresis_input_K[k] = plant.hysteresis_input_K
        counts = plant.sensed(plant.position / per_count)  # at every tick: a sensor may have a memory
        if mark:
            at = plant.now
            rows.append((counts, plant.operator.y, at.resistance, i, plant.current(i), at.ambient_K))
            states.append(plant.operator.state)
    return Trajectory(np.array(rows).T, tuple(states), hysteresis_input_K)


def _by_parts(
    timeline: Timeline, plant_model: PlantModel, effects: Sequence[SupportsHooks], inputs: InputTrajectory
) -> Trajectory:
    h = plant_model.hysteresis
    at = inputs.ends[timeline.ticks[2]]  # the parts at whose ends something was read
    output, states = _outputs_and_states(plant_model, inputs["hysteresis_input_K"], at)
    context = EffectContext(plant_model.actuator, h, plant_model.initial)
    late = chains(effects, context)
    if any(late[stage] for stage in AFTER_HYSTERESIS):
        requested = at if _late_effects_memoryless(effects, context) else np.arange(inputs["t_s"].size)
        counts = _sensor_counts(plant_model, late, inputs, requested)[at]
    else:
        counts = output / (plant_model.per_count or 1.0)
    others = [inputs[name][at] for name in ("resistance", "command_A", "current_A", "ambient_K")]
    return Trajectory(
        np.stack([counts, output, *others]),
        states,
        np.clip(inputs["hysteresis_input_K"][inputs.ends], h.lower, h.upper),
    )


def _outputs_and_states(
    plant_model: PlantModel, hysteresis_input_K: Array, at: NDArray[np.int64]
) -> tuple[Array, tuple[State, ...]]:
    """Outputs (n,) and memories at parts ``at`` (n,): only where a path turns is it remembered."""
    operator = Preisach(plant_model.hysteresis, plant_model.initial, compiled=False)
    move = np.diff(hysteresis_input_K, prepend=hysteresis_input_K[0], append=hysteresis_input_K[-1])
    turns = move[:-1] * move[1:] <= 0
    turns[at] = True
    kept = np.flatnonzero(turns)
    output, states = [], []
    begin, path = 0, hysteresis_input_K[kept].tolist()
    for end in (np.searchsorted(kept, at) + 1).tolist():
        for u in path[begin:end]:
            operator.step(u)
        begin = end
        output.append(operator.y)
        states.append(operator.state)
    return np.array(output), tuple(states)


def _late_effects_memoryless(effects: Sequence[SupportsHooks], context: EffectContext) -> bool:
    """Whether nothing that acts after the hysteresis remembers."""
    remembering = [e for e in effects if not (isinstance(e, Effect) and e.kind.memoryless)]
    return not any(stage in AFTER_HYSTERESIS for e in remembering for stage in e.hooks(context))


def _sensor_counts(
    plant_model: PlantModel,
    late: Mapping[Stage, tuple[Hook, ...]],
    inputs: InputTrajectory,
    requested: NDArray[np.int64],
) -> Array:
    """What the sensor shows at the ends of parts (m,), 0 where it is not asked; between whole ticks it never is."""
    per_count, maps, added, sensor = (
        plant_model.per_count or 1.0,
        *(late[stage] for stage in AFTER_HYSTERESIS),
    )
    counts = np.zeros(inputs["t_s"].size)
    for k, (now, whole_s) in zip(requested.tolist(), _moments(plant_model, inputs, maps, requested)):
        position = apply_hooks(added, apply_hooks(maps, now.output, now), now)
        if whole_s:
            now.dt_s = whole_s
            counts[k] = apply_hooks(sensor, position / per_count, now)
    return counts


def _moments(
    plant_model: PlantModel, inputs: InputTrajectory, maps: tuple[Hook, ...], requested: NDArray[np.int64]
) -> Iterator[tuple[PlantState, float]]:
    """(the moment at the end of each part that is asked, the length of the tick that ends there or 0)."""
    h = plant_model.hysteresis
    operator = Preisach(h, plant_model.initial)
    span, began, y = h.everett(h.upper, h.lower), operator.y, operator.follow(inputs["hysteresis_input_K"])
    per_span = 1.0 / span if span else 0.0
    now = PlantState(output=began, austenite=(began - h.y_lower) * per_span)
    apply_hooks(maps, began, now)  # where it rests
    travel = np.cumsum(np.abs(np.diff(y, prepend=began)) * per_span)
    whole = np.zeros(y.size)
    whole[inputs.ends] = np.diff(inputs["t_s"][inputs.ends], prepend=0.0)
    columns = (*inputs.columns, y, (y - h.y_lower) * per_span, travel, whole)
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
            now.austenite,
            now.travel,
            ends_s,
        ) = row
        yield now, ends_s
