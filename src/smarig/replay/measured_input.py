"""Timelines of runs with a measured input: the samples are the input path, and a selection of them is used as readings.

This is for data of others without current and without settled steps, for example temperature → strain or field →
polarisation. Between reversals the input is made monotone (isotonic least squares), because a hysteresis takes sensor
noise for reversals. Reversals smaller than five times that noise count as noise. Runs without a clock count samples.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import final

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, DataError, root_mean_square
from smarig.measurement import has_measured_input, input_noise_sd, spread_rows
from smarig.plant import EffectType, is_testable
from smarig.preisach import Everett, turning_points
from smarig.record import Run
from smarig.replay.timeline import DriveProfile, ReadingSeries, Timeline

Integers = NDArray[np.int64]
MAX_READINGS = 240  # of a timeline
MIN_BRANCH_READINGS = 4  # of a branch
REVERSAL_THRESHOLD = 5.0  # times the noise of the input
CLOSURE_TOLERANCE = 0.05  # of the input range: a record whose end is this close to its start is a steady loop
PAUSE_SAMPLES = 1.0  # samples between two runs


@final
@dataclass(frozen=True, eq=False)
class MeasuredInput(DriveProfile):
    """Inputs (m,) in their unit, each reached at ``end_s`` (m,), with no change in between.

    At each reading (k,): ``speed`` is the |du/dt| of its branch, ``scatter`` the scatter of the input about the branch,
    ``last_reversal`` the input at the start of the branch. ``clock``: whether times are seconds or samples.
    """

    clock: bool = True
    speed: Array = field(default_factory=lambda: np.empty(0))
    scatter: Array = field(default_factory=lambda: np.empty(0))
    last_reversal: Array = field(default_factory=lambda: np.empty(0))

    @property
    def has_clock(self) -> bool:
        """Whether every run has a clock."""
        return self.clock

    def ticks(self, at_s: Array) -> tuple[Array, Array]:  # noqa: ARG002
        """The points of the path, which include all readings."""
        return self.end_s, self.value

    def unrecorded_gap_s(self, sessions: Sequence[Sequence[Run]]) -> float:  # noqa: ARG002
        """Always 0: runs are joined in the given order, and time between them has no effect."""
        return 0.0

    def can_show(self, effect_type: EffectType, hysteresis: Everett) -> bool:
        """Whether an effect acts after the measured input; without a clock, effects of time cannot show."""
        return is_testable(effect_type, hysteresis, clock=self.clock)


def driven_by_input(runs: Sequence[Run]) -> bool:
    """Whether these runs have an input but neither a heating current nor settled steps."""
    return all(has_measured_input(run) and not run.settled for run in runs)


def build_measured_input_timeline(runs: Sequence[Run], max_readings: int | None = MAX_READINGS) -> Timeline:
    """Runs in the given order on one clock.

    A run that ends where it started, half way on a branch, is a steady loop of its own: it is simulated once before,
    without readings, and its output has its own zero. Any other run with an unknown start is read from its first
    reversal on. ``max_readings``: number of readings, None for every sample. Raises DataError if no readings remain.
    """
    parts = [_MeasuredInputRun(run) for run in runs]
    branches = sum(len(p.turns) - 1 for p in parts)
    per_branch = max(max_readings // max(branches, 1), MIN_BRANCH_READINGS) if max_readings else None
    read = [p.read(per_branch) for p in parts]
    if not any(rows.size for rows in read):
        raise DataError(
            "The runs have no branch with a known start. A diagnosis needs a reversal of the input."
        )
    clock = all(p.run.has("t_s") for p in parts)
    placed_runs, at, block = [], 0.0, 0
    for number, (part, rows) in enumerate(zip(parts, read)):
        t, placed_run = part.place_on_clock(rows, at, clock, number, block)
        placed_runs.append(placed_run)
        at, block = t, int(placed_run.block.max(initial=block)) + 1
    return _assembled_timeline(placed_runs, runs, clock)


@dataclass(frozen=True, eq=False)
class _PlacedRun:
    """One run on the clock of the timeline: its path, and the rows used as readings."""

    end_s: Array
    input: Array
    t_s: Array
    value: Array
    target: Array
    speed: Array
    input_scatter: Array
    last_reversal: Array
    zero: Integers
    block: Integers
    run: Integers


class _MeasuredInputRun:
    """One run: its known samples, with the input made monotone between reversals."""

    def __init__(self, run: Run) -> None:
        known = np.isfinite(run["input"]) & np.isfinite(run["position"])
        self.run, self.raw, self.y = run, run["input"][known], run["position"][known]
        t = run["t_s"][known]
        self.t = t if run.has("t_s") else np.arange(float(t.size))
        self.turns = (
            turning_points(self.raw, REVERSAL_THRESHOLD * input_noise_sd(self.raw)) if t.size > 2 else [0]
        )
        self.u = self._monotone_branches()
        back = abs(self.u[-1] - self.u[0]) <= CLOSURE_TOLERANCE * np.ptp(self.u) if t.size else False
        self.steady = bool(back and len(self.turns) == 4)

    def _monotone_branches(self) -> Array:
        """The input, isotonic between its reversals."""
        from scipy.optimize import isotonic_regression  # imported here: takes half a second

        u = self.raw.copy()
        for a, b in pairwise(self.turns):
            rising = bool(self.raw[b] > self.raw[a])
            u[a : b + 1] = isotonic_regression(self.raw[a : b + 1], increasing=rising).x
        for k in self.turns:
            u[k] = self.raw[k]
        return u

    def read(self, per_branch: int | None) -> Integers:
        """Rows used as readings: ``per_branch`` of each branch (None: all), half spaced by time and half by output."""
        first = 0 if self.steady or self.run.info.initial else 1
        rows = [
            spread_rows(self.y, a, b, per_branch) if per_branch else np.arange(a + 1, b + 1)
            for a, b in pairwise(self.turns[first:])
        ]
        return np.unique(np.concatenate(rows)) if rows else np.empty(0, dtype=np.int64)

    def _branch_scatter(self) -> Array:
        """Scatter of the input about each branch, (branches,)."""
        scatter = self.raw - self.u
        return np.array([root_mean_square(scatter[a : b + 1]) for a, b in pairwise(self.turns)])

    def place_on_clock(
        self, rows: Integers, at: float, clock: bool, number: int, block: int
    ) -> tuple[float, _PlacedRun]:
        """(end, this run placed on the clock), started at time ``at``."""
        own = self.t - self.t[0] if clock else np.arange(float(self.t.size))
        pause = PAUSE_SAMPLES * float(np.median(np.diff(own)))
        path = np.unique(np.concatenate([rows, self.turns]))
        times, inputs = [own[path]], [self.u[path]]
        if self.steady:
            times, inputs = [own[path], own[path] + own[-1] + pause], [self.u[path]] * 2
        begin = at + pause + (own[-1] + pause if self.steady else 0.0)
        t = begin + own[rows]
        branch = np.clip(np.searchsorted(self.turns, rows, side="left") - 1, 0, len(self.turns) - 2)
        ends = np.array(self.turns)
        speed = np.abs(np.diff(self.u[ends])) / np.maximum(np.diff(own[ends]), 1e-12)
        placed_run = _PlacedRun(
            end_s=at + pause + np.concatenate(times),
            input=np.concatenate(inputs),
            t_s=t,
            value=self.y[rows],
            target=self.u[rows],
            speed=speed[branch],
            input_scatter=self._branch_scatter()[branch],
            last_reversal=self.u[ends[:-1]][branch],
            zero=np.full(rows.size, number if self.steady else 0, dtype=np.int64),
            block=block + branch // 2,
            run=np.full(rows.size, number, dtype=np.int64),
        )
        return begin + float(own[-1]), placed_run


def _assembled_timeline(placed_runs: Sequence[_PlacedRun], runs: Sequence[Run], clock: bool) -> Timeline:
    def joined(name: str) -> Array:
        return np.concatenate([getattr(p, name) for p in placed_runs])

    value = joined("value")
    t = np.round(joined("t_s"), 6)
    readings = ReadingSeries("settled", value, t, np.arange(value.size), runs[0].unit)
    return Timeline(
        drive=MeasuredInput(
            np.round(joined("end_s"), 6),
            joined("input"),
            clock,
            speed=joined("speed"),
            scatter=joined("input_scatter"),
            last_reversal=joined("last_reversal"),
        ),
        settled=readings,
        other_readings=(),
        target_K=joined("target"),
        hold_s=np.zeros(value.size),
        run=joined("run").astype(np.int64),
        block=joined("block").astype(np.int64),
        runs=tuple(runs),
        zero=joined("zero").astype(np.int64),
    )
