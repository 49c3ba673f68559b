"""The samples of a run that count: not those of void steps, nor readings that contradict each other.

A run of holds is read at its settled steps, which say themselves whether they count. Of a run of motions each sample
is a point, so what a fault or an interruption has spoiled has to be left out sample by sample. All of it stays in the
record.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from smarig.core import Quality
from smarig.record.run import Run

Mask = NDArray[np.bool_]


def void_rows(run: Run) -> Mask:
    """The samples (n,) of steps that do not count: a resumed run has repeated them."""
    void = [s.index for s in run.steps if s.void]
    return np.isin(run["step"], void) if void else np.zeros(len(run), dtype=bool)


def suspect_rows(run: Run) -> Mask:
    """The samples (n,) that are marked suspect, and those since an event's ``since_s`` until the event."""
    found = (np.nan_to_num(run["quality"]).astype(int) & int(Quality.SUSPECT)) != 0
    for event in run.events:
        since_s = event.data.get("since_s") if event.kind == "suspect" else None
        if isinstance(since_s, float):  # a file may hold anything
            found |= (run["t_s"] >= since_s) & (run["t_s"] <= event.t_s)
    return found


def counted(run: Run) -> Run:
    """A run of motions with only the samples that count; a run with settled steps as it is."""
    if run.settled:
        return run
    keep = ~(void_rows(run) | suspect_rows(run))
    if keep.all():
        return run
    return replace(run, columns={name: values[keep] for name, values in run.columns.items()})
