"""The noise floor of a record: the standard deviation of outputs in the same state of the memory.

Points with the same remembered extrema and the same input are repeats. Their pure error needs no model.
Verification and reports use this figure.
"""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from smarig.identification.settled_points import settled_points
from smarig.record import Run
from smarig.replay import MemoryHistory, memory_histories

FEWEST_PAIRS = 3
FEWEST_ENDS = 8


@dataclass(frozen=True)
class NoiseFloor:
    """Standard deviation ``value`` of a settled output in ``unit``, None if nothing was repeated.

    ``n_pairs`` are the degrees of freedom. ``source`` is the kind of repeats: "repeats" inside the loop,
    "saturation" if only the ends of the range were visited again, "windows" if the scatter of samples within the
    settling windows is used instead, or "none".
    """

    value: float | None
    n_pairs: int
    unit: str
    source: str


def noise_floor(runs: Run | Iterable[Run]) -> NoiseFloor:
    """Pure-error standard deviation √(Σ(y − ȳ)²/Σ(n − 1)) over repeated memory states, within each run.

    Repeats in saturation are used only if there are fewer than three others and at least eight of them, because
    they are no repeats if the range was not fully exercised. Otherwise the windows of the points are used.
    """
    runs = [runs] if isinstance(runs, Run) else list(runs)
    unit = runs[0].unit if runs else ""
    inside, ends = _PooledVariance(), _PooledVariance()
    for run in runs:
        if not run.points()[0].size:
            continue
        lower, upper, (history,) = memory_histories([run])
        for at_end, outputs in _repeats(history, lower, upper):
            (ends if at_end else inside).add(outputs)
    if inside.freedom >= FEWEST_PAIRS:
        return NoiseFloor(inside.sd, inside.freedom, unit, "repeats")
    windows = _of_windows(runs)
    if windows is not None and ends.freedom < FEWEST_ENDS:  # one pair hardly determines a standard deviation
        return NoiseFloor(*windows, unit, "windows")
    if ends.freedom:
        return NoiseFloor(ends.sd, ends.freedom, unit, "saturation")
    return NoiseFloor(inside.sd, inside.freedom, unit, "repeats" if inside.freedom else "none")


def _of_windows(runs: list[Run]) -> tuple[float, int] | None:
    """Rms uncertainty of the settled points from their own windows, and their number; None without samples."""
    points = [settled_points(run) for run in runs if run.settled and len(run) >= 50 * len(run.settled)]
    if not points:
        return None
    every = np.concatenate([p.uncertainty for p in points])
    return float(np.sqrt(np.mean(every**2))), every.size


def _repeats(history: MemoryHistory, lower: float, upper: float) -> Iterable[tuple[bool, np.ndarray]]:
    """(in saturation?, outputs) of every memory state that was reached more than once."""
    visits: dict[tuple, list[float]] = defaultdict(list)
    before = None
    for state, y in zip(history.states, history.outputs.tolist()):
        # A hold that follows the same hold continues the same visit and is not a repeat.
        if state is not None and state != before:
            visits[(state.extrema, state.u, state.diagonal)].append(y)
        before = state
    for (extrema, u, _), outputs in visits.items():
        if len(outputs) > 1:
            yield len(extrema) == 1 and not lower < u < upper, np.array(outputs)


class _PooledVariance:
    def __init__(self) -> None:
        self.squares, self.freedom = 0.0, 0

    def add(self, outputs: np.ndarray) -> None:
        self.squares += float(np.sum((outputs - outputs.mean()) ** 2))
        self.freedom += outputs.size - 1

    @property
    def sd(self) -> float | None:
        return float(np.sqrt(self.squares / self.freedom)) if self.freedom else None
