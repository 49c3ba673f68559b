"""Inputs of a run by the heating that was identified with a model, in place of the actuator's of the record."""

from dataclasses import replace

import numpy as np

from smarig.plant import JouleHeating
from smarig.record import Run
from smarig.replay.measured_input import driven_by_input
from smarig.replay.model_file import Model
from smarig.replay.plant_model import actuator_of


def with_heating_of(model: Model, run: Run) -> Run:
    """The run with inputs by the model's τ, if the model was identified together with it on the same actuator.

    Settled points stay as they are: the steady input of a current does not depend on τ. Other runs are returned
    unchanged.
    """
    known = run.has("current_A") and run.has("t_s") and run.has("input") and not driven_by_input([run])
    if "heating" not in model.fit or not known or run.info.actuator != model.actuator.name:
        return run
    actuator = actuator_of(model)
    heating = JouleHeating(actuator, run.info.period_s or 0.1)
    current, t, recorded = run["current_A"], run["t_s"], run["input"]
    first = int(np.argmax(np.isfinite(recorded)))
    hot = float(recorded[first])
    heating.wire_K = [max(hot, 0.0), max(-hot, 0.0)] if actuator.two_wire else [hot, 0.0]
    inputs = recorded.copy()
    last_A, before = 0.0, t[first]
    for k in range(first + 1, len(run)):
        last_A = current[k] if np.isfinite(current[k]) else last_A
        if np.isfinite(t[k]):
            heating.tick(max(t[k] - before, 0.0))
            before = t[k]
            inputs[k] = heating.step(last_A)
    return replace(run, columns={**run.columns, "input": inputs})
