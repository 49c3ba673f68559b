"""Simulation of a model as a run: along a measured run, or of a protocol on the model's twin.

A simulated run is labelled ``simulation``.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from smarig.core import UsageError
from smarig.plant import effects_from_json
from smarig.record import Run, Step, write_run
from smarig.replay import Model, simulate, simulate_samples, with_heating_of
from smarig.rig import TwinSettings
from smarig.runner import Session


def simulate_run(model: Model, along: Run, out: Path, *, force: bool = False) -> Path:
    """Simulate the model along the inputs of a run: positions of all samples and settled steps, in the
    model's zero."""
    along = with_heating_of(model, along)
    predicted = dict(zip((s.index for s in along.settled), simulate(model, along).tolist()))
    kept = ("tick", "t_s", "step", "current_command_A", "current_A", "input", "ambient_degC")
    columns = {name: [None if v != v else v for v in along[name].tolist()] for name in kept}
    columns |= {name: [None if v is None else int(v) for v in columns[name]] for name in ("tick", "step")}
    columns["position"] = [None if v != v else v for v in simulate_samples(model, along).tolist()]
    meta = {k: v for k, v in along.meta.items() if k not in ("schema_version", "end", "seed", "source")}
    meta |= {"source": "simulation", "model": model.name, "along": along.path.name}
    write_run(out, meta, columns, [_row(s, predicted.get(s.index)) for s in along.steps], force=force)
    return out


def simulate_protocol(
    model: Model, protocol: str, settings: Mapping[str, Any], out: Path, *, rig: str = "", force: bool = False
) -> Path:
    """Run a protocol on the noise-free twin of the model's rig, with the model as its hysteresis."""
    model.check_classical("Driving a twin")
    name = rig or model.rig
    if not name:
        raise UsageError("The model names no rig. Give one with --rig to simulate a protocol.")
    twin = TwinSettings(noise=False, hysteresis=model.hysteresis, effects=effects_from_json(model.effects))
    with Session(name, twin=twin, wire=f"simulation of {model.name}") as session:
        return session.run(protocol, settings, out, force=force, notes=f"simulation with model {model.name}")


def _row(step: Step, position: float | None) -> tuple:
    value = None if position is None or np.isnan(position) else position
    return (
        step.index,
        step.attempt,
        int(step.void),
        step.branch,
        step.target,
        step.t_start_s,
        step.t_end_s,
        step.verdict,
        value,
        step.n,
    )
