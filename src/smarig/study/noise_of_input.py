"""How far the noise of the input moves the predictions of a model: on a steep branch it decides the error."""

from dataclasses import replace

import numpy as np

from smarig.core import Array, root_mean_square
from smarig.identification import verify
from smarig.record import Run, load_run
from smarig.study.candidate_models import CandidateModel

_ORDER = (
    4  # of the divided difference: a sine of a hundred readings a period leaves a thousandth of a per cent
)
_MOST_WINDOWS = 20_000  # the median of as many is known to a hundredth
_NORMAL_MEDIAN = 0.6745  # of |x| for x ~ N(0, 1)


def reading_noise(t_s: Array, u: Array) -> float:
    """Standard deviation of the noise of readings u (n,) at times t_s (n,); 0 for too few.

    The median of divided differences, each over the root of its squared weights: what is smooth in time has none,
    whatever the steps of the clock, and the few at turns do not count.
    """
    if u.size <= 2 * _ORDER:
        return 0.0
    every = max(u.size // _MOST_WINDOWS, 1)
    t, values = (np.lib.stride_tricks.sliding_window_view(x, _ORDER + 1)[::every] for x in (t_s, u))
    steps = t[:, :, None] - t[:, None, :] + np.eye(_ORDER + 1)
    with np.errstate(divide="ignore", invalid="ignore"):
        weights = 1.0 / steps.prod(axis=2)
        weights /= np.sqrt(np.square(weights).sum(axis=1, keepdims=True))
        differences = (weights * values).sum(axis=1)
    found = np.abs(differences[np.isfinite(differences)])
    return float(np.median(found)) / _NORMAL_MEDIAN if found.size else 0.0


def noise_by_input(candidate: CandidateModel) -> float:
    """What the noise of the input adds to the predictions of held-out readings, rms, in the unit of the output.

    Half the difference of two predictions: with the whole input a standard deviation higher, and lower. 0 without a
    clock, as then nothing distinguishes noise from steps of the input.
    """
    moved = [_moved(candidate, load_run(r.run)) for r in candidate.held_out]
    found = np.concatenate([m[np.isfinite(m)] for m in moved]) if moved else np.empty(0)
    return root_mean_square(found) if found.size else 0.0


def _moved(candidate: CandidateModel, run: Run) -> Array:
    if not (run.has("t_s") and run.has("input")):
        return np.zeros(1)
    known = np.isfinite(run["t_s"]) & np.isfinite(run["input"])
    noise = reading_noise(run["t_s"][known], run["input"][known])
    if noise == 0.0:
        return np.zeros(1)
    shifted = [replace(run, columns={**run.columns, "input": run["input"] + d}) for d in (noise, -noise)]
    high, low = (verify(candidate.model, [s]).runs[0] for s in shifted)
    return np.where(high.counted & low.counted, (high.predicted - low.predicted) / 2, np.nan)
