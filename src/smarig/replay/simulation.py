"""Outputs of a model along measured runs, at their settled points or at every sample.

The whole history counts, including reversals between settled points. The simulation starts in the recorded state of a
run, or continues from the run before it; if neither is known, it starts when the run reaches saturation. A model with
effects is simulated as a plant along the commands, in the order of the clocks.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, DataError, UsageError, in_unit
from smarig.measurement import (
    SATURATION_TOLERANCE,
    StartingState,
    may_assume_start,
    noise_at_start,
    starting_state,
)
from smarig.preisach import Everett
from smarig.record import FORC_PROTOCOL, Run, continues_run
from smarig.replay.extended_model import Operator
from smarig.replay.measured_input import build_measured_input_timeline, driven_by_input
from smarig.replay.measured_prediction import simulate_measured, simulate_rig_samples
from smarig.replay.memory_history import (
    INPUT_TOLERANCE,
    input_path,
)
from smarig.replay.model_file import Model
from smarig.replay.plant_model import actuator_of, plant_model_of
from smarig.replay.prediction import predict, predict_positions
from smarig.replay.provenance import earlier_runs
from smarig.replay.timeline_from_runs import build_timeline


def simulate(model: Model, run: Run) -> Array:
    """Outputs of the model at a run's settled points, (k,), in the model's zero; see ``simulate_runs``."""
    return simulate_runs(model, [run])[0]


def simulate_runs(model: Model, runs: Sequence[Run]) -> list[Array]:
    """Outputs of the model at the settled points of consecutive runs, (k,) each.

    NaN while the memory is unknown. Raises UsageError if the inputs have another unit. A model with effects is
    simulated along the runs in the order of their clocks.
    """
    if model.measurement or model.effects:
        for run in runs:
            check_input(model, run)
        return (
            simulate_measured(model, runs) if model.measurement else _simulate_runs_with_effects(model, runs)
        )
    outputs: list[Array] = []
    operator, known, h = model.operator(), False, model.hysteresis
    for k, run in enumerate(runs):
        check_input(model, run)
        if run.info.protocol == FORC_PROTOCOL:
            outputs.append(_reversal_curves(operator, run))
            known = False
            continue
        is_continued = known and continues_run(runs[k - 1], run)
        inputs, settled = input_path(run)
        inputs = _snapped_to_saturation(h, inputs)
        start = StartingState(None) if is_continued else _start(h, run)
        if not is_continued:
            operator.reset(start.state or "negative")
        y, known = _simulate_inputs(operator, h, inputs, is_continued or start.state is not None)
        y = y[settled]
        y[: start.first] = np.nan
        outputs.append(y)
        end = run["input"][-1:]  # the memory continues from the last input, not from the last settled one
        if end.size and np.isfinite(end[0]):
            operator.step(float(end[0]))
    return outputs


def simulate_samples(model: Model, run: Run) -> Array:
    """Outputs (n,) at every sample along the run's ``input`` column, in the model's zero.

    NaN while the memory is unknown; an unknown input holds the last one. With effects: along the currents.
    """
    check_input(model, run)
    if model.measurement and model.temperature is not None and not driven_by_input([run]):
        return simulate_rig_samples(model, run)
    if model.measurement:
        known = np.isfinite(run["input"]) & np.isfinite(run["position"])
        y = np.full(len(run), np.nan)
        y[known] = simulate_measured(model, [run])[0]
        return y
    if model.effects:
        return _simulate_samples_with_effects(model, run)
    operator, h = model.operator(), model.hysteresis
    start = _start(h, run)
    operator.reset(start.state or "negative")
    inputs = run["input"]
    last = np.maximum.accumulate(np.where(np.isfinite(inputs), np.arange(inputs.size), -1))
    first = int(np.argmax(last >= 0)) if last.size else 0
    y = np.full(inputs.size, np.nan)
    if last.size and last[-1] >= 0:
        y[first:], _ = _simulate_inputs(operator, h, inputs[last[first:]], start.state is not None)
    if start.first:
        y[: _row_of_point(run, start.first)] = np.nan
    return y


def out_of_range(model: Model, inputs: Array) -> NDArray[np.bool_]:
    """Whether inputs (k,) are beyond the model's saturation."""
    h = model.hysteresis
    tolerance = SATURATION_TOLERANCE * (h.upper - h.lower)
    return (inputs < h.lower - tolerance) | (inputs > h.upper + tolerance)


def check_output(model: Model, run: Run) -> None:
    """Raise DataError if the output unit of a run differs from that of the model."""
    if run.unit != model.unit:
        raise DataError(
            f"{run.path} measures {in_unit(run.unit)}, the model {in_unit(model.unit)}. They cannot be compared."
        )


def check_input(model: Model, run: Run) -> None:
    """Raise UsageError if the input unit of a run differs from that of the model."""
    if model.input.unit and run.input_unit and model.input.unit != run.input_unit:
        raise UsageError(
            f"{run.path} has its input {in_unit(run.input_unit)}, the model {in_unit(model.input.unit)}. "
            "Import the run with the model's input."
        )


def _start(h: Everett, run: Run) -> StartingState:
    """The state at the start of a run that continues no other."""
    inputs, outputs = run.points()
    return starting_state(
        run.info.initial,
        inputs,
        (h.lower, h.upper),
        first_input=float(run["input"][0]) if len(run) else None,
        may_assume=may_assume_start(run),
        outputs=outputs,
        noise=noise_at_start(run),
    )


def _row_of_point(run: Run, point: int) -> int:
    """The row of a settled point, or of a sample in which input and output are known."""
    if run.settled:
        end = run.settled[point].t_end_s
        return int(np.searchsorted(run["t_s"], end)) if end is not None else point
    return int(np.flatnonzero(np.isfinite(run["input"]) & np.isfinite(run["position"]))[point])


def _simulate_inputs(operator: Operator, h: Everett, inputs: Array, known: bool) -> tuple[Array, bool]:
    """Outputs along inputs, NaN until the memory is known, and whether it is known at the end."""
    step = operator.step
    y = np.fromiter((step(u) for u in inputs.tolist()), dtype=float, count=inputs.size)
    if not known:
        saturated = (inputs <= h.lower) | (inputs >= h.upper)
        known = bool(saturated.any())
        y[: int(np.argmax(saturated)) if known else inputs.size] = np.nan
    return y, known


def _snapped_to_saturation(h: Everett, inputs: Array) -> Array:
    """Inputs within rounding of saturation, set to saturation."""
    near = INPUT_TOLERANCE * (h.upper - h.lower)
    inputs = np.where(np.abs(inputs - h.upper) <= near, h.upper, inputs)
    return np.where(np.abs(inputs - h.lower) <= near, h.lower, inputs)


def _reversal_curves(operator: Operator, run: Run) -> Array:
    """Each curve separately, from positive saturation down to its lowest input; without calibration points."""
    u, y, step = run["input"], run["position"], run["step"]
    predicted = np.full(u.size, np.nan)
    known = np.isfinite(u) & np.isfinite(y)
    for label in np.unique(step[known & (step >= 0)]):
        members = np.flatnonzero(known & (step == label))
        operator.reset("positive")
        operator.step(float(u[members].min()))
        for k in members[np.argsort(u[members], kind="stable")]:
            predicted[k] = operator.step(float(u[k]))
    return predicted[known]


def _simulate_runs_with_effects(model: Model, runs: Sequence[Run]) -> list[Array]:
    """Outputs at the settled points of runs of one session, (k,) each, in the model's zero.

    Earlier runs of that session that the model was made from are simulated first, if their files still exist. NaN at
    the readings of a run without settled points, such as an initialisation.
    """
    if driven_by_input(runs):
        return _simulate_measured_input(model, runs)
    timeline = build_timeline([*earlier_runs(model, runs), *runs], actuator_of(model).tau_s)
    plant_model = plant_model_of(model, timeline.runs[0])
    values = predict(timeline, plant_model).values["settled"]
    by_run = {id(run): values[timeline.run == k] for k, run in enumerate(timeline.runs)}
    return [by_run[id(run)] if run.settled else np.full(run.points()[1].size, np.nan) for run in runs]


def _simulate_measured_input(model: Model, runs: Sequence[Run]) -> list[Array]:
    """Outputs at every sample of runs with a measured input, NaN while the memory is unknown."""
    timeline = build_measured_input_timeline([*earlier_runs(model, runs), *runs], None)
    values = predict(timeline, plant_model_of(model, timeline.runs[0])).values["settled"]
    outputs = []
    for run in runs:
        k = next(k for k, r in enumerate(timeline.runs) if r is run)
        own, whole = values[timeline.run == k], run.points()[1].size
        outputs.append(np.concatenate([np.full(whole - own.size, np.nan), own]))
    return outputs


def _simulate_samples_with_effects(model: Model, run: Run) -> Array:
    """Outputs (n,) at every sample of a run, in the model's zero; the run is simulated alone."""
    if driven_by_input([run]):
        known = np.isfinite(run["input"]) & np.isfinite(run["position"])
        y = np.full(len(run), np.nan)
        y[known] = _simulate_measured_input(model, [run])[0]
        return y
    timeline = build_timeline([run], actuator_of(model).tau_s)
    t = run["t_s"] - float(run["t_s"][0]) + float(run.info.period_s or 0.1)
    return predict_positions(timeline.drive, plant_model_of(model, run), t)
