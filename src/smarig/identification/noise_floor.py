"""The noise floor of a record: the standard deviation of outputs in the same state of the memory.

Points with the same remembered extrema and the same input, reached at the same rate, are repeats. Their pure error
needs no model. A drift of the repeats from cycle to cycle is no noise: it is left out, and stated (``repeatability``).
Verification and reports use this figure.
"""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, chi2_tail, root_mean_square
from smarig.identification.changed_states import unchanged
from smarig.identification.repeatability import (
    P_EXCESS,
    STEADY,
    PooledRepeats,
    Repeatability,
    Repeats,
    excess_over_readings,
    pooled_repeats,
)
from smarig.identification.settled_points import settled_points
from smarig.measurement import ONE_RATE, reversals, rounding_sd
from smarig.record import Run
from smarig.replay import MemoryHistory, NoiseRecord, memory_histories

FEWEST_PAIRS = 3
FEWEST_ENDS = 8


@dataclass(frozen=True)
class NoiseFloor:
    """Standard deviation ``value`` of a settled output in ``unit``, None if nothing was repeated.

    ``n_pairs`` are the degrees of freedom. ``source`` is the kind of repeats: "repeats" inside the loop,
    "saturation" if only the ends of the range were visited again, "windows" if the scatter of samples within the
    settling windows is used instead, or "none". ``repeatability`` is what the repeats show besides noise; ``changed``
    is the number of repeated states that were left out because the output changed there by far more than in the others.
    """

    value: float | None
    n_pairs: int
    unit: str
    source: str
    repeatability: Repeatability = STEADY
    changed: int = 0

    @property
    def known(self) -> float | None:
        """The value where three repeats or more determine it, else None: no error is judged by less."""
        return self.value if self.n_pairs >= FEWEST_PAIRS else None

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about the repeats, one or two sentences each."""
        return (self.repeatability.warning,) if self.repeatability.text else ()

    def explains(self, outputs: Array) -> bool:
        """Whether outputs (n,) differ by no more than this noise makes them differ; False if the noise is unknown.

        A χ² test with the noise as it was estimated: an F test of few repeats would call any range noise.
        """
        freedom = outputs.size - 1
        if not self.value or freedom < 1:
            return freedom < 1
        ratio = float(np.var(outputs, ddof=1)) / self.value**2
        return chi2_tail(ratio * freedom, freedom) >= P_EXCESS


def noise_record(floor: NoiseFloor) -> NoiseRecord:
    """The floor as a model file stores it."""
    return NoiseRecord(
        value=floor.value,
        unit=floor.unit,
        source=floor.source,
        drift_per_cycle=floor.repeatability.drift,
        over_readings=floor.repeatability.over_readings,
    )


def noise_floor(runs: Run | Iterable[Run]) -> NoiseFloor:
    """Pure-error standard deviation √(Σ(y − ȳ)²/Σ(n − 1)) over repeated memory states, within each run.

    Repeats in saturation are used only if there are fewer than three others and at least eight of them, because
    they are no repeats if the range was not fully exercised. Otherwise the windows of the points are used. A trend of
    the repeats over the cycles of a run is left out of the value. Repeats that are rounded alike agree by more than
    their readings are worth, so the value is at least the rounding.
    """
    runs = [runs] if isinstance(runs, Run) else list(runs)
    found = _of_repeats(runs)
    rounding = float(np.sqrt(np.mean([rounding_sd(run) ** 2 for run in runs]))) if runs else 0.0
    return found if found.value is None else replace(found, value=max(found.value, rounding))


def _of_repeats(runs: list[Run]) -> NoiseFloor:
    """The floor without regard to the resolution."""
    unit = runs[0].unit if runs else ""
    of_runs, ends = [], _RepeatsOfRuns()
    for run in runs:
        if not run.points()[0].size:
            continue
        lower, upper, (history,) = memory_histories([run])
        found = list(_repeats(history, _cycles(run, history), _log_rates(run, history), lower, upper))
        travel = float(np.ptp(history.outputs))
        of_runs.append((travel, [repeats for at_end, repeats in found if not at_end]))
        ends.add([repeats for at_end, repeats in found if at_end], travel)
    kept, changed = unchanged([repeats for _, repeats in of_runs])
    inside = _RepeatsOfRuns(changed)
    for (travel, _), repeats in zip(of_runs, kept):
        inside.add(repeats, travel)
    windows = _of_windows(runs)
    readings = windows[0] if windows else None
    if inside.visited_again >= FEWEST_PAIRS:
        return inside.floor(unit, "repeats", readings)
    if windows is not None and ends.visited_again < FEWEST_ENDS:  # one pair hardly determines a deviation
        return NoiseFloor(*windows, unit, "windows")
    if ends.visited_again:
        return ends.floor(unit, "saturation", readings)
    return inside.floor(unit, "repeats" if inside.visited_again else "none", readings)


def _of_windows(runs: list[Run]) -> tuple[float, int] | None:
    """Rms uncertainty of the settled points from their own windows, and their number; None without samples."""
    points = [settled_points(run) for run in runs if run.settled and len(run) >= 50 * len(run.settled)]
    if not points:
        return None
    every = np.concatenate([p.uncertainty for p in points])
    return root_mean_square(every), every.size


def _cycles(run: Run, history: MemoryHistory) -> Array:
    """Cycles before each point (k,): the way of the output in strokes, over two.

    Without settled steps, the noise of single readings would add up: the way then grows at reversals only.
    """
    y = history.outputs
    turns = np.arange(y.size) if run.settled else np.array(reversals(history.inputs))
    way = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(y[turns])))])
    branch = np.searchsorted(turns, np.arange(y.size), side="right") - 1
    return way[branch] / (2 * float(np.ptp(y)) or 1.0)


def _log_rates(run: Run, history: MemoryHistory) -> Array:
    """ln of the mean rate of the input on the branch of each point (k,); 0 for settled points and without a clock."""
    u = history.inputs
    t = (
        run["t_s"][np.isfinite(run["input"]) & np.isfinite(run["position"])]
        if run.has("t_s")
        else np.empty(0)
    )
    if run.settled or t.size != u.size or u.size < 2:
        return np.zeros(u.size)
    turns = np.array(reversals(u))
    branch = np.clip(np.searchsorted(turns, np.arange(u.size), side="right") - 1, 0, turns.size - 2)
    travel, took = np.abs(np.diff(u[turns])), np.diff(t[turns])
    known = (travel > 0) & (took > 0)
    return np.log(np.where(known, travel, 1.0) / np.where(known, took, 1.0))[branch]


def _repeats(
    history: MemoryHistory,
    cycles: Array,
    log_rates: Array,
    lower: float,
    upper: float,
) -> Iterable[tuple[bool, Repeats]]:
    """(in saturation?, repeats) of every memory state that was reached more than once at one rate."""
    visits: dict[tuple, list[int]] = defaultdict(list)
    before = None
    for k, state in enumerate(history.states):
        # A hold that follows the same hold continues the same visit and is not a repeat.
        if state is not None and state != before:
            visits[(state.extrema, state.u, state.diagonal)].append(k)
        before = state
    for (extrema, u, _), rows in visits.items():
        for same in _at_one_rate(np.array(rows), log_rates):
            if same.size > 1:
                yield (
                    len(extrema) == 1 and not lower < u < upper,
                    Repeats(cycles[same], history.outputs[same]),
                )


def _at_one_rate(rows: NDArray[np.intp], log_rates: Array) -> list[NDArray[np.intp]]:
    """The rows in groups of about the same rate, each in the order of the record."""
    by_rate = rows[np.argsort(log_rates[rows], kind="stable")]
    apart = np.flatnonzero(np.diff(log_rates[by_rate]) > np.log(ONE_RATE)) + 1
    return [np.sort(group) for group in np.split(by_rate, apart)]


class _RepeatsOfRuns:
    """Repeats of several runs, each with a trend of its own."""

    def __init__(self, changed: int = 0) -> None:
        self._changed = changed  # states that were left out
        self._of_runs: list[tuple[PooledRepeats, float]] = []
        self.visited_again = 0

    def add(self, repeats: Sequence[Repeats], travel: float) -> None:
        """The repeats of one run, with the range of its outputs."""
        if repeats:
            self._of_runs.append((pooled_repeats(repeats), travel))
            self.visited_again += sum(r.y.size - 1 for r in repeats)

    def floor(self, unit: str, source: str, readings: float | None) -> NoiseFloor:
        """The floor of all; ``readings`` is the noise within readings, None if it is not known."""
        freedom = sum(found.freedom for found, _ in self._of_runs)
        if not freedom:
            return NoiseFloor(None, 0, unit, source)
        sd = float(np.sqrt(sum(found.squares for found, _ in self._of_runs) / freedom))
        drifts = [
            found.drift / travel for found, travel in self._of_runs if found.drift is not None and travel
        ]
        largest = max(drifts, key=abs, default=None)
        over = excess_over_readings(sd, freedom, readings)
        return NoiseFloor(sd, freedom, unit, source, Repeatability(largest, over), self._changed)
