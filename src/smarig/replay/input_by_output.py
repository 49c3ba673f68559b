"""The input of the hysteresis where it depends on the output, from the temperatures, which do not."""

from collections.abc import Sequence

import numpy as np

from smarig.plant import (
    Effect,
    EffectContext,
    PlantState,
    Stage,
    SupportsHooks,
    apply_hooks,
    hook_chains,
    step_with_feedback,
)
from smarig.preisach import Preisach
from smarig.replay.input_trajectory import (
    INPUT_COLUMNS,
    InputTrajectory,
    set_inputs,
    turns_and_readings,
)
from smarig.replay.plant_model import PlantModel
from smarig.replay.timeline import Timeline


def is_feedback_without_memory(effect: SupportsHooks, context: EffectContext) -> bool:
    """Whether an effect changes the hysteresis input by the present output alone."""
    return (
        isinstance(effect, Effect)
        and effect.kind.memoryless
        and set(effect.hooks(context)) == {Stage.FEEDBACK}
    )


def with_feedback(
    timeline: Timeline, plant_model: PlantModel, feedback: Sequence[SupportsHooks], inputs: InputTrajectory
) -> InputTrajectory:
    """Inputs of the hysteresis with a feedback of its output: solved where a path turns or is read.

    In between both inputs move one way. There the input with feedback is interpolated, which changes no output.
    """
    h, now = plant_model.hysteresis, PlantState()
    hooks = hook_chains(feedback, EffectContext(plant_model.actuator, h, plant_model.initial))[Stage.FEEDBACK]
    operator, span = Preisach(h, plant_model.initial, compiled=False), h.everett(h.upper, h.lower)
    per_span, path = 1.0 / span if span else 0.0, inputs["hysteresis_input_K"]
    kept, _ = turns_and_readings(timeline, inputs)
    solved = []
    for u in path[kept].tolist():
        now.hysteresis_input_K = u
        step_with_feedback(hooks, now, operator, h.y_lower, per_span)
        solved.append(now.hysteresis_input_K)
    way = np.cumsum(np.abs(np.diff(path, prepend=path[0])))
    columns = inputs.columns.copy()
    columns[INPUT_COLUMNS.index("hysteresis_input_K")] = np.interp(way, way[kept], solved)
    return InputTrajectory(columns, inputs.ends)


def shifts_by_output(effects: Sequence[SupportsHooks], context: EffectContext) -> list[SupportsHooks]:
    """All effects that shift the hysteresis input, if one of them does so by the output; else none."""
    stages = {id(e): set(e.hooks(context)) for e in effects}
    shifts = [e for e in effects if stages[id(e)] == {Stage.INPUT}]
    elsewhere = any(Stage.INPUT in stages[id(e)] for e in effects if e not in shifts)
    return [] if elsewhere or all(_is_output_independent(e) for e in shifts) else shifts


def _is_output_independent(effect: SupportsHooks) -> bool:
    return isinstance(effect, Effect) and effect.kind.output_independent


def with_shifts(
    plant_model: PlantModel, shifts: Sequence[SupportsHooks], inputs: InputTrajectory
) -> InputTrajectory:
    """Inputs of the hysteresis after effects that shift them, some by the outputs so far."""
    h = plant_model.hysteresis
    hooks = hook_chains(shifts, EffectContext(plant_model.actuator, h, plant_model.initial))[Stage.INPUT]
    operator, span = Preisach(h, plant_model.initial), h.everett(h.upper, h.lower)
    per_span, y_lower = 1.0 / span if span else 0.0, h.y_lower
    now = PlantState(output=operator.y, share=(operator.y - y_lower) * per_span)
    shifted = []
    for row in inputs.columns[: len(INPUT_COLUMNS)].T.tolist():
        set_inputs(now, row)
        now.hysteresis_input_K = u = apply_hooks(hooks, now.hysteresis_input_K, now)
        shifted.append(u)
        before, now.output = now.output, operator.step(u)
        now.share = (now.output - y_lower) * per_span
        now.travel += abs(now.output - before) * per_span
    columns = inputs.columns.copy()
    columns[INPUT_COLUMNS.index("hysteresis_input_K")] = shifted
    return InputTrajectory(columns, inputs.ends)
