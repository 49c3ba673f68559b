"""Runs that did not end as planned: a model of them describes less than their protocol would have shown."""

from collections.abc import Sequence

import numpy as np

from smarig.record import Run


def early_end_warnings(runs: Sequence[Run]) -> list[str]:
    """A sentence for each run that a trip, a fault or a request ended, with the time of its last row and the cause."""
    return [_warning(run) for run in runs if run.info.end is not None and run.early_end]


def _warning(run: Run) -> str:
    known = run["t_s"][np.isfinite(run["t_s"])]
    when = f" at {known[-1]:.1f} s" if known.size else ""
    return f"{run.name} ended early{when}: {run.early_end}. The model describes only the rows before."
