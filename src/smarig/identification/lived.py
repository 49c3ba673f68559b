"""A model with effects along measured runs: clock, cycles and currents count, so the whole sitting is lived through.

The plant itself is driven along the commands (``story.retelling``); runs are taken in the order of their clocks.
Knows no measured output.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from smarig.config import ActuatorFile, check
from smarig.errors import DataError
from smarig.identification.history import named_start
from smarig.identification.model_file import Model
from smarig.identification.origin import file_hash, provenance
from smarig.model.actuator import Actuator
from smarig.model.planted import from_json
from smarig.record import Run, load_run
from smarig.story.retelling import Subject, positions, retold
from smarig.story.told import told

Array = NDArray[np.float64]


def subject_of(model: Model, first: Run) -> Subject:
    """The wire as a model believes it to be, in the state the first run says it begins in."""
    actuator = actuator_of(model)
    output = first.meta.get("output")
    per_count = output.get("per_count") if isinstance(output, dict) else None
    start = named_start(first) or ("anhysteretic" if actuator.two_wire else "negative")
    return Subject(actuator, model.hysteresis, start, from_json(model.effects), float(per_count or 0.0))


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


def settled_in_turn(model: Model, runs: Sequence[Run]) -> list[Array]:
    """Outputs at the settled points of runs of one sitting, (k,) each, in the model's zero.

    The runs the model was made from are lived through first, where they are of the same sitting and still there.
    """
    story = told([*earlier(model, runs), *runs], actuator_of(model).tau_s)
    subject = subject_of(model, story.runs[0])
    values = retold(story, subject).values["settled"]
    by_run = {id(run): values[story.run == k] for k, run in enumerate(story.runs)}
    return [by_run[id(run)] for run in runs]


def earlier(model: Model, runs: Sequence[Run]) -> list[Run]:
    """Runs of the same sitting that the model was made from, not given and found where they were."""
    sittings = {(p.start_epoch, p.encoder_zero) for p in map(provenance, runs)}
    given = {file_hash(run) for run in runs}
    found = []
    for p in model.provenance:
        same = p.start_epoch is not None and (p.start_epoch, p.encoder_zero) in sittings
        if same and p.sha256 not in given and Path(p.run).is_file():
            run = load_run(p.run)
            found += [run] if file_hash(run) == p.sha256 else []
    return found


def along(model: Model, run: Run) -> Array:
    """Outputs (n,) at every sample of a run, in the model's zero; the run is lived through by itself."""
    story = told([run], actuator_of(model).tau_s)
    t = run["t_s"] - float(run["t_s"][0]) + float(run.meta.get("period_s") or 0.1)
    return positions(story.drive, subject_of(model, run), t)
