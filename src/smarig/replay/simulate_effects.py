"""A model with effects along measured runs: clock, cycles and currents count, so the whole sitting is lived through.

The plant itself is driven along the commands (``story.retelling``); runs are taken in the order of their clocks.
Knows no measured output.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from smarig.config import ActuatorFile
from smarig.core.errors import DataError
from smarig.core.toml_file import check
from smarig.plant.actuator import Actuator
from smarig.plant.effect_catalogue import from_json
from smarig.plant.measured_input import MeasuredInput
from smarig.record import CONTINUED, Run, load_run
from smarig.replay.measured_input_timeline import build_measured_input_timeline, driven_by_input
from smarig.replay.memory_history import recorded_start
from smarig.replay.model_file import Model, Provenance
from smarig.replay.plant_model import PlantModel
from smarig.replay.prediction import predict, predict_positions
from smarig.replay.provenance import file_hash, provenance
from smarig.replay.timeline import build_timeline

Array = NDArray[np.float64]


def plant_model_of(model: Model, first: Run) -> PlantModel:
    """The wire as a model believes it to be, in the state the first run says it begins in."""
    model.check_classical("A simulation in time, by effects and heating,")
    actuator = actuator_for_run(model, first)
    start = recorded_start(first) or ("anhysteretic" if actuator.two_wire else "negative")
    return PlantModel(
        actuator, model.hysteresis, start, from_json(model.effects), first.info.output.resolution
    )


def actuator_of(model: Model) -> Actuator:
    """The wire's constants as the model file holds them; DataError when it holds none."""
    record = model.actuator
    if not record.parameters:
        raise DataError(
            f"Model '{model.name}' does not know its wire's constants: effects act through heating, so identify "
            "from runs that name their actuator."
        )
    return Actuator(
        check(
            ActuatorFile,
            {
                "name": record.name,
                "arrangement": model.arrangement,
                "source": "model file",
                "hysteresis": {"surface": "one_e", "initial": "negative"},  # not used: the model has its own
                **record.parameters,
            },
            f"model '{model.name}'",
        )
    )


def actuator_for_run(model: Model, run: Run) -> Actuator:
    """What a model's hysteresis hangs on along a run: the wire's constants, or the input as it was measured."""
    return MeasuredInput() if driven_by_input([run]) else actuator_of(model)


def simulate_runs_with_effects(model: Model, runs: Sequence[Run]) -> list[Array]:
    """Outputs at the settled points of runs of one sitting, (k,) each, in the model's zero.

    The runs the model was made from are lived through first, where they are of the same sitting and still there.
    """
    if driven_by_input(runs):
        return _simulate_measured_input(model, runs)
    timeline = build_timeline([*earlier_runs(model, runs), *runs], actuator_of(model).tau_s)
    plant_model = plant_model_of(model, timeline.runs[0])
    values = predict(timeline, plant_model).values["settled"]
    by_run = {id(run): values[timeline.run == k] for k, run in enumerate(timeline.runs)}
    return [by_run[id(run)] for run in runs]


def _simulate_measured_input(model: Model, runs: Sequence[Run]) -> list[Array]:
    """Outputs at every sample of runs whose input was measured, NaN before the memory is known."""
    timeline = build_measured_input_timeline([*earlier_runs(model, runs), *runs], None)
    values = predict(timeline, plant_model_of(model, timeline.runs[0])).values["settled"]
    outputs = []
    for run in runs:
        k = next(k for k, r in enumerate(timeline.runs) if r is run)
        own, whole = values[timeline.run == k], run.points()[1].size
        outputs.append(np.concatenate([np.full(whole - own.size, np.nan), own]))
    return outputs


def earlier_runs(model: Model, runs: Sequence[Run]) -> list[Run]:
    """Runs of the same sitting that the model was made from, not given and found where they were."""
    found = [(p, load_run(p.run)) for p in _same_session_provenance(model, runs) if Path(p.run).is_file()]
    return [run for p, run in found if file_hash(run) == p.sha256]


def missing_earlier_runs(model: Model, runs: Sequence[Run]) -> list[str]:
    """What came earlier in the sittings of runs, but is neither among them nor found where it was."""
    known = [*runs, *earlier_runs(model, runs)]
    missing = [p.run for p in _same_session_provenance(model, known)]
    first = min(known, key=lambda run: float(run["t_s"][0]) if run.has("t_s") else 0.0)
    if not missing and first.info.initial == CONTINUED:
        missing = [f"what was run before {first.path.name}"]
    return missing


def _same_session_provenance(model: Model, runs: Sequence[Run]) -> list[Provenance]:
    """What the model was made from in the sittings of runs, beside those runs."""
    sittings = {(p.start_epoch, p.encoder_zero) for p in map(provenance, runs)}
    given_hashes = {file_hash(run) for run in runs}
    return [
        p
        for p in model.provenance
        if p.start_epoch is not None
        and (p.start_epoch, p.encoder_zero) in sittings
        and p.sha256 not in given_hashes
    ]


def simulate_samples_with_effects(model: Model, run: Run) -> Array:
    """Outputs (n,) at every sample of a run, in the model's zero; the run is lived through by itself."""
    if driven_by_input([run]):
        known = np.isfinite(run["input"]) & np.isfinite(run["position"])
        y = np.full(len(run), np.nan)
        y[known] = _simulate_measured_input(model, [run])[0]
        return y
    timeline = build_timeline([run], actuator_of(model).tau_s)
    t = run["t_s"] - float(run["t_s"][0]) + float(run.info.period_s or 0.1)
    return predict_positions(timeline.drive, plant_model_of(model, run), t)
