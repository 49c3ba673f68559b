"""The noise floor of a record: the standard deviation of outputs in the same state of the memory.

Points with the same remembered extrema and the same input are repeats. Their pure error needs no model.
Verification and reports use this figure.

A state in which the output changed by far more than in the others (slip, a load that fell off) is not noise. Among ten
states or more, one is left out if its variance exceeds that of noise with the median of all states, by a χ² test with a
margin. Noise alone never leaves one out.
"""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri

from smarig.identification.settled_points import settled_points
from smarig.record import Run
from smarig.replay import MemoryHistory, memory_histories

FEWEST_PAIRS = 3
FEWEST_ENDS = 8
_FEWEST_STATES = 10  # repeated states with a typical spread
_P_CHANGED, _MARGIN = 1e-9, 4.0  # of the test for a changed state, and on its variance
_MOST_CHANGED = 0.25  # of the states: if more differ, the spread is not that of noise


@dataclass(frozen=True)
class NoiseFloor:
    """Standard deviation ``value`` of a settled output in ``unit``, None if nothing was repeated.

    ``n_pairs`` are the degrees of freedom. ``source`` is the kind of repeats: "repeats" inside the loop,
    "saturation" if only the ends of the range were visited again, "windows" if the scatter of samples within the
    settling windows is used instead, or "none". ``changed`` is the number of repeated states that were left out because
    the output changed there by far more than in the others.
    """

    value: float | None
    n_pairs: int
    unit: str
    source: str
    changed: int = 0


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
    inside, changed = inside.without_changed()
    if inside.freedom >= FEWEST_PAIRS:
        return NoiseFloor(inside.sd, inside.freedom, unit, "repeats", changed)
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
    """Sums of squares about the mean and degrees of freedom, a pair for each repeated state."""

    def __init__(self, states: list[tuple[float, int]] | None = None) -> None:
        self._states = states or []

    def add(self, outputs: np.ndarray) -> None:
        self._states.append((float(np.sum((outputs - outputs.mean()) ** 2)), outputs.size - 1))

    def without_changed(self) -> tuple["_PooledVariance", int]:
        """The states whose outputs differ as those of the others do, and the number of those left out."""
        if len(self._states) < _FEWEST_STATES:
            return self, 0
        squares, freedom = np.array(self._states).T
        usual = float(np.median(squares / chdtri(freedom, 0.5)))  # the variance, from the median of χ²
        if usual == 0:  # readings in steps coarser than the noise
            return self, 0
        changed = squares > _MARGIN * usual * chdtri(freedom, _P_CHANGED / len(self._states))
        if not changed.any() or changed.mean() > _MOST_CHANGED:
            return self, 0
        return _PooledVariance([s for s, out in zip(self._states, changed) if not out]), int(changed.sum())

    @property
    def freedom(self) -> int:
        return sum(f for _, f in self._states)

    @property
    def sd(self) -> float | None:
        squares = sum(s for s, _ in self._states)
        return float(np.sqrt(squares / self.freedom)) if self.freedom else None
