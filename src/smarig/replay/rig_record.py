"""Runs of a rig as records with an input, an output and a stress: what a model of several loads is made from.

Under one load, the settled points count, with the turning points of the input between them. Under a load that changes,
every sample counts: the load moves the wire between settled points too.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from smarig.core import Array
from smarig.measurement import InputRecord, input_records, recorded_means
from smarig.plant import Load
from smarig.record import Run, continues_run
from smarig.replay.measured_input import driven_by_input
from smarig.replay.memory_history import input_path

STRESS = "stress"
SAMPLES_PER_STEP = 20  # with fewer, the steps from sample to sample are no noise


def load_of_run(run: Run) -> Load | None:
    """The load that a run of a rig states; None if it states none."""
    return Load.from_json(run.info.load) if run.info.load else None


def stress_of_samples(run: Run) -> Array | None:
    """Stress in MPa at every sample (n,) of a run whose load changes; None for a constant or unknown load."""
    load = load_of_run(run)
    if load is None or not load.changes:
        return None
    t = np.where(np.isfinite(run["t_s"]), run["t_s"], 0.0)
    return load.stress_MPa(t)


def stress_at_points(run: Run) -> Array | None:
    """Mean stress in MPa over the window of each settled point (k,); None for a constant or unknown load."""
    stress_MPa = stress_of_samples(run)
    return None if stress_MPa is None else means_over_windows(run, stress_MPa)


def means_over_windows(run: Run, values: Array) -> Array:
    """Mean of sampled values (n,) over the window of each settled point (k,), NaN where one is not known."""
    return np.array(
        [values[run.window(s)].mean() if run.window(s) != slice(0, 0) else np.nan for s in run.settled]
    )


def load_records(runs: Sequence[Run], *, samples: bool = False) -> list[InputRecord]:
    """The records of runs; of runs with a heating current their settled points, or all ``samples``.

    Runs with too few rows are left out.
    """
    if driven_by_input(runs):
        return input_records(runs)
    found: list[InputRecord] = []
    before: Run | None = None
    for run in runs:
        history = stress_of_samples(run)
        record = _settled(run) if history is None and run.settled and not samples else _samples(run, history)
        if record is None:
            continue
        follows = before is not None and continues_run(before, run)
        found.append(replace(record, continues=follows))
        before = run
    return found


def _settled(run: Run) -> InputRecord | None:
    """The settled points of a run, and the turning points between them with the output before."""
    u, where = input_path(run)
    y = run.points()[1]
    known = np.searchsorted(where, np.arange(u.size), side="right") - 1
    if y.size < 3:
        return None
    return InputRecord(
        name=run.name,
        u=u,
        y=y[np.maximum(known, 0)],
        t=np.arange(float(u.size)),
        clock=False,
        cycle=np.zeros(u.size),
        conditions=recorded_means(run),
        row=np.arange(u.size),
        initial=run.info.initial,
        input_unit=run.input_unit,
        noise=0.0,
        readings=where.astype(np.int64),
    )


def _samples(run: Run, stress_MPa: Array | None) -> InputRecord | None:
    """Every sample of a run in which input and output are known."""
    found = input_records([run])
    if not found:
        return None
    sparse = bool(run.settled) and len(run) < SAMPLES_PER_STEP * len(run.settled)
    record = replace(found[0], noise=0.0) if sparse else found[0]
    if stress_MPa is None:
        return record
    return replace(record, histories={STRESS: stress_MPa[record.row]})
