"""Runs with a measured input for a diagnosis: their records, selected rows, and the errors of the given model."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, DataError
from smarig.identification import Comparison, selected_points
from smarig.measurement import InputRecord, input_records
from smarig.record import Run
from smarig.replay import Model, simulate_runs


def records_of(train: Sequence[Run], held_out: Sequence[Run]) -> tuple[list[InputRecord], int]:
    """The records of all runs, and the number of training records."""
    count = len(input_records(train))
    records = input_records([*train, *held_out])
    if not count:
        raise DataError("The training runs contain no reading in which input and output are known.")
    return records, count


def selected_rows(
    runs: Sequence[Run], records: Sequence[InputRecord], select: str
) -> list[NDArray[np.bool_]]:
    """The rows of each record on the first-order curves of the runs for which an expression holds."""
    usable = [run for run in runs if input_records([run])]
    found = []
    for run, record, points in zip(usable, records, selected_points(usable, select)):
        rows = np.zeros(len(run), dtype=bool)
        rows[np.flatnonzero(np.isfinite(run["input"]) & np.isfinite(run["position"]))] = points
        found.append(rows[record.row])
    return found


def replayed_error(
    model: Model, runs: Sequence[Run], comparison: Comparison, *, about_mean: bool = True
) -> Array:
    """Errors (m,) of a model, as it is replayed, at the readings; NaN where it predicts nothing.

    ``about_mean``: the zero of each run is free.
    """
    plan, found = comparison.plan, []
    predicted = dict(zip((id(r) for r in runs), simulate_runs(model, list(runs))))
    usable = [run for run in runs if input_records([run])]
    for run, record, rows in zip(usable, plan.records, plan.rows):
        finite = np.flatnonzero(np.isfinite(run["input"]) & np.isfinite(run["position"]))
        error = record.y[rows] - predicted[id(run)][np.searchsorted(finite, record.row[rows])]
        found.append(error - np.nanmean(error) if about_mean and np.isfinite(error).any() else error)
    return np.concatenate(found)
