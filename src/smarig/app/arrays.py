"""Models and plain arrays: a model fitted to two rows of numbers, and its output along arrays, runs and files."""

from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from smarig.app.loop_model import AnyModel, model_of
from smarig.core import Array, DataError, UsageError
from smarig.identification import identify
from smarig.preisach import Initial, vector
from smarig.record import Run, load_run, run_of_arrays
from smarig.replay import Model, simulate_samples, with_heating_of

FEWEST = 3  # readings: with fewer, nothing tells noise from motion


def simulate(model: AnyModel, along: Run | str | Path | ArrayLike, initial: Initial = "negative") -> Array:
    """The output of a model, in its unit and its zero.

    ``model``: a model, the result of ``identify``, or the path of a model file. ``along``: inputs of the hysteresis
    (n,), or a batch of them (n_inputs, n_samples), each from the state ``initial``; or a run or its path, which gives
    the output at each of its samples (n,), NaN where the memory or the input is unknown. A run states how it began.
    Raises UsageError for other shapes, or for a run with an input in another unit.
    """
    known = model_of(model)
    if isinstance(along, str | Path):
        along = load_run(along)
    if isinstance(along, Run):
        return simulate_samples(known, with_heating_of(known, along))
    return known.predict(along, initial)


def fit(
    u: ArrayLike, y: ArrayLike, t: ArrayLike | None = None, *, surface: str = "positive", unit: str = ""
) -> Model:
    """The Preisach model of two measured rows: inputs u (n,) and outputs y (n,), in the order of measurement.

    ``t`` (n,): times in s, if known. ``unit``: that of the output. Missing readings are NaN. ``surface`` as in
    ``identify``; a non-negative measure by default. Raises UsageError for other shapes, and DataError for too few
    readings.

    >>> u = np.concatenate([np.linspace(0, 10, 50), np.linspace(10, 0, 50)])
    >>> y = np.where(np.arange(100) < 50, np.tanh(u - 6), np.tanh(u - 4))
    >>> bool(np.abs(fit(u, y).predict(u) - y).max() < 0.1)
    True
    """
    given = {"input": u, "output": y, **({} if t is None else {"time": t})}
    rows = [vector(values, "fit", name) for name, values in given.items()]
    if any(row.size != rows[0].size for row in rows):
        shapes = ", ".join(str(row.shape) for row in rows)
        raise UsageError(f"fit needs rows of equal length, got the shapes {shapes}.")
    known = int(np.isfinite(rows[0] + rows[1]).sum())
    if known < FEWEST:
        raise DataError(f"fit needs {FEWEST} readings or more of input and output, got {known}.")
    return identify(run_of_arrays(*rows, unit=unit), surface).model
