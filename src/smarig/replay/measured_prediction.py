"""Predictions of a model with measurement effects along runs with a measured input.

y = z(c) + g(c) · P[v] + Σ_k b_k φ_k,    c: a condition of the run, if an effect depends on one

The measure P is one for all values of c, or one for each measured value.
Learned terms change v after all effects, and add to y what they make of z + g P[v].
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from smarig.core import Array, DataError
from smarig.measurement import (
    ConditionTable,
    InputRecord,
    MeasurementPart,
    changed,
    input_records,
    learned_input,
    learned_output,
    monotone_branches,
    reversals,
    starting_state,
)
from smarig.preisach import Everett, Initial, Preisach, State
from smarig.record import Run, continues_run
from smarig.replay.measured_input import driven_by_input
from smarig.replay.model_file import Model
from smarig.replay.rig_record import load_records, means_over_windows
from smarig.replay.wire_temperature import with_wire_temperature

SATURATION_GRID = 101
SATURATION_SHARE = (
    0.01  # of the stroke: what is left of the major loop beyond an input that counts as saturated
)


def simulate_measured(model: Model, runs: Sequence[Run]) -> list[Array]:
    """Outputs at the rows of runs in which input and output are known, (k,) each; NaN where the memory is unknown.

    Of runs of a rig: at their settled points, (k,). Raises DataError for such runs unless the model is one of loads of
    a rig.
    """
    for run in runs:
        if run.settled and model.temperature is None:
            raise DataError(
                f"Model '{model.name}' describes runs that have only a measured input, but {run.name} has settled "
                "steps. Identify a model from such runs."
            )
    part = MeasurementPart.from_json(model.measurement)
    if model.temperature is not None and not driven_by_input(runs):
        return _simulate_rig_runs(model, part, runs)
    by_run: dict[int, Array] = {}
    memories: list[State] = []
    for run, record in _with_records(runs):
        by_run[id(run)], memories = _simulated(model, part, run, record, memories)
    return [by_run.get(id(run), np.full(run.points()[0].size, np.nan)) for run in runs]


def _simulate_rig_runs(model: Model, part: MeasurementPart, runs: Sequence[Run]) -> list[Array]:
    """Outputs at the settled points of runs of a rig, (k,) each."""
    found: list[Array] = []
    memories: list[State] = []
    for k, run in enumerate(runs):
        warm = with_wire_temperature(run, str(model.temperature))
        record = _record_of(warm, samples=False)
        if k and memories and continues_run(runs[k - 1], run):
            record = replace(record, continues=True)
        y, memories = _outputs(model, part, record, memories)
        if record.readings is not None:
            found.append(y[record.readings])
        else:
            every = np.full(len(run), np.nan)
            every[record.row] = y
            found.append(means_over_windows(run, every) if run.settled else y)
    return found


def simulate_rig_samples(model: Model, run: Run) -> Array:
    """Outputs (n,) of a model of loads at every sample of a run of a rig; NaN where input or output is unknown."""
    part = MeasurementPart.from_json(model.measurement)
    record = _record_of(with_wire_temperature(run, str(model.temperature)), samples=True)
    found = np.full(len(run), np.nan)
    found[record.row] = _outputs(model, part, record, ())[0]
    return found


def applied_inputs(model: Model, run: Run) -> Array:
    """Inputs of the hysteresis at the points of a run, (k,): of a model of loads of a rig, shifted by the stress."""
    inputs = run.points()[0]
    if model.temperature is None or driven_by_input([run]):
        return inputs
    part, record = MeasurementPart.from_json(model.measurement), _record_of(run, samples=False)
    u = changed(record, part.effects).input
    if record.readings is not None:
        return u[record.readings]
    every = np.full(len(run), np.nan)
    every[record.row] = u
    return means_over_windows(run, every) if run.settled else u


def _record_of(run: Run, *, samples: bool) -> InputRecord:
    records = load_records([run], samples=samples)
    if not records:
        raise DataError(
            f"{run.name} has fewer than three points. A model of several loads cannot be simulated along it."
        )
    return records[0]


def _with_records(runs: Sequence[Run]) -> list[tuple[Run, InputRecord]]:
    """Each run with its record; cycles go on from run to run."""
    usable = [run for run in runs if input_records([run])]
    return list(zip(usable, input_records(usable)))


def _simulated(
    model: Model, part: MeasurementPart, run: Run, record: InputRecord, before: Sequence[State]
) -> tuple[Array, list[State]]:
    """The outputs along a record, and the final state under each measure; ``before`` are those of the record before."""
    y, memories = _outputs(model, part, record, before)
    finite = np.flatnonzero(np.isfinite(run["input"]) & np.isfinite(run["position"]))
    found = np.full(finite.size, np.nan)
    found[np.searchsorted(finite, record.row)] = y
    return found, memories


def _outputs(
    model: Model, part: MeasurementPart, record: InputRecord, before: Sequence[State]
) -> tuple[Array, list[State]]:
    """Outputs (n,) at the rows of a record, and the final states."""
    if part.table is not None:
        _check_condition(record, part.table)
    change = changed(record, part.effects)
    applied = learned_input(record, change.input, part.learned)
    turns = reversals(applied, change.noise)
    u, h = monotone_branches(applied, turns), model.hysteresis
    seen = starting_state(record.initial, u, _saturation(h), turns=turns, outputs=record.y)
    known = seen.first
    measures = part.measures or (h,)
    starts: Sequence[Initial] = [seen.state or "negative" for _ in measures]
    if record.continues and before:
        starts, known = before, 0
    inputs = np.clip(u, h.lower, h.upper)
    operators = [Preisach(p, s, samples=u.size) for p, s in zip(measures, starts)]
    shapes = [operator.simulate(inputs, s) for operator, s in zip(operators, starts)]
    y = shapes[0]
    if part.table is not None:
        y = part.table.outputs_along(np.array(shapes), record.condition(part.table.condition))
    y = y + learned_output(record, y, part.learned)
    if change.terms.shape[1]:
        y = y + change.terms @ np.array(part.amplitudes)
    y[:known] = np.nan
    return y, [operator.state for operator in operators]


def _saturation(h: Everett) -> tuple[float, float]:
    """The inputs below and above which next to nothing of the major loop remains."""
    grid = np.linspace(h.lower, h.upper, SATURATION_GRID)
    stroke = h.everett(h.upper, h.lower)
    to_fall = stroke - np.array([h.everett(h.upper, u) for u in grid.tolist()])
    to_rise = stroke - np.array([h.everett(u, h.lower) for u in grid.tolist()])
    low, high = (np.abs(left) <= SATURATION_SHARE * abs(stroke) for left in (to_fall, to_rise))
    return float(grid[low].max(initial=h.lower)), float(grid[high].min(initial=h.upper))


def _check_condition(record: InputRecord, table: ConditionTable) -> None:
    if table.condition not in record.conditions:
        raise DataError(
            f"The model depends on the {table.condition}, but run {record.name} does not state it. Run the rig with "
            f"its load stated (smarig run --load), or import data with a mapping that has '{table.condition}' under "
            "[conditions]."
        )
