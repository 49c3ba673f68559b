"""What was done and what was measured: runs of one wire as one story on one clock.

Commands become stretches of constant current; readings become observations of a few kinds (settled and moving
positions, resistance, current, room). Knows no model: nothing here depends on what is believed of the wire.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from smarig.core.errors import DataError
from smarig.record import Run, Step

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
FIRST_STEP_S, STEP_GROWTH, LONGEST_STEP_S = 0.1, 1.3, 8.0  # time steps after a change of the current
FINE_STEPS = (
    (4.0, 0.15),
    (9.0, 0.4),
)  # time constants: until when the wire moves, and the longest step until then
MOVING_DELAYS = (0.4, 1.2, 3.0)  # time constants after a step, where a moving position is read
MAX_OTHER_READINGS = 220  # readings of one other kind
MIN_HOLD_SAMPLES = 12  # samples in a hold that make it a transient
OTHER_KINDS = ("moving", "resistance", "current", "room")  # kinds of other readings, in their order
MIN_CURRENT_A = 0.15  # a smaller current tells no resistance


@dataclass(frozen=True, eq=False)
class ReadingSeries:
    """Observations of one kind: values (n,), the time of each on the story's clock, and its settled step.

    ``step`` (n,) counts the settled points of the story; ``noise`` is the sd of one reading, None if unknown.
    """

    kind: str
    value: Array
    t_s: Array
    step: Integers
    unit: str
    noise: float | None = None

    def __len__(self) -> int:
        return self.value.size

    def where(self, keep: NDArray[np.bool_]) -> "ReadingSeries":
        """Some of them."""
        return ReadingSeries(
            self.kind, self.value[keep], self.t_s[keep], self.step[keep], self.unit, self.noise
        )


@dataclass(frozen=True, eq=False)
class DriveProfile:
    """Constant currents: ``current_A`` (m,) each until ``end_s`` (m,), from 0 s."""

    end_s: Array
    current_A: Array
    tau_s: float = 5.0

    def ticks(self, at_s: Array) -> tuple[Array, Array]:
        """Times (k,) and currents (k,): fine after each change, coarse later, every ``at_s`` among them."""
        begin = np.concatenate([[0.0], self.end_s[:-1]])
        grid = [np.concatenate([_growing_steps(a, b, self.tau_s), [b]]) for a, b in zip(begin, self.end_s)]
        wanted = at_s[(at_s > 0) & (at_s <= self.end_s[-1])]
        t = np.unique(np.round(np.concatenate([*grid, wanted]), 6))
        which = np.clip(np.searchsorted(self.end_s, t - 1e-7), 0, self.end_s.size - 1)
        return t, self.current_A[which]


@dataclass(frozen=True, eq=False)
class Timeline:
    """Everything that was done to the wire and read from it, in time order.

    ``settled`` are positions of finished steps; ``target_K`` (k,), ``hold_s`` (k,), ``run`` (k,) describe those
    steps; ``block`` (k,) numbers the excursions that are held out together. ``other_readings`` are readings of other kinds.
    ``given`` says where the input itself is the drive (``story.measured_input``), and by which clock; ``speed`` (k,) is then
    the branch's |du/dt|, ``input_scatter`` (k,) the input's scatter there, ``last_reversal`` (k,) the last one. ``zero`` (k,)
    numbers outputs that share a zero, where not all do. ``sessions``: the stories of each, where there were several;
    ``resistance_from_command``: no current was measured, so a resistance is the voltage over the current asked for.
    """

    drive: DriveProfile
    settled: ReadingSeries
    other_readings: tuple[ReadingSeries, ...]
    target_K: Array
    hold_s: Array
    run: Integers
    block: Integers
    runs: tuple[Run, ...]
    measured_input: Literal["", "clock", "samples"] = ""
    speed: Array = field(default_factory=lambda: np.empty(0))
    input_scatter: Array = field(default_factory=lambda: np.empty(0))
    last_reversal: Array = field(default_factory=lambda: np.empty(0))
    zero: Integers = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    sessions: tuple["Timeline", ...] = ()
    resistance_from_command: bool = False

    @property
    def duration_h(self) -> float:
        """Length of the longest sitting."""
        return max(float(s.drive.end_s[-1]) for s in self.sessions or (self,)) / 3600

    @property
    def session(self) -> Integers:
        """The number (k,) of the sitting of each step."""
        return self.zero if self.sessions else np.zeros(len(self.settled), dtype=np.int64)

    @property
    def unrecorded_gap_s(self) -> float:
        """Seconds between runs of one sitting of which no run tells; 0 where the input itself is the drive."""
        if self.measured_input:
            return 0.0
        gaps = [
            float(after["t_s"][0] - before["t_s"][-1]) - _period_s(after)
            for session in self.sessions or (self,)
            for before, after in pairwise(session.runs)
        ]
        return sum(gaps, 0.0)

    @property
    def unit(self) -> str:
        """Unit of position."""
        return self.settled.unit

    @property
    def all_readings(self) -> tuple[ReadingSeries, ...]:
        """All readings, settled positions first."""
        return (self.settled, *self.other_readings)

    @cached_property
    def positions_only(self) -> "Timeline":
        """The same with nothing but positions read; always the same one, for paths felt are kept by story."""
        other_readings = tuple(r for r in self.other_readings if r.kind == "moving")
        if other_readings == self.other_readings:
            return self
        return replace(
            self, other_readings=other_readings, sessions=tuple(s.positions_only for s in self.sessions)
        )

    @cached_property
    def ticks(self) -> tuple[Array, Array, NDArray[np.bool_]]:
        """Times (m,) at which the story is retold, the current up to each, and whether something was read then."""
        read = np.unique(np.round(np.concatenate([r.t_s for r in self.all_readings]), 6))
        t, current = self.drive.ticks(read)
        return t, current, np.isin(t, read, assume_unique=True)


def build_timeline(runs: Sequence[Run], tau_s: float) -> Timeline:
    """Runs of one wire, in time order, as one story. DataError when they hold no settled steps.

    ``tau_s``: the wire's time constant, which says when a position is moving and worth reading. Each sitting (one
    clock, one zero of the encoder) begins anew. Runs of which only the input was measured become a story of it, in
    the order given (``story.measured_input``).
    """
    from smarig.replay.measured_input_timeline import build_measured_input_timeline, driven_by_input
    from smarig.replay.sessions import join_sessions

    if driven_by_input(runs):
        return build_measured_input_timeline(runs)
    if not any(run.settled for run in runs):
        raise DataError("The runs hold no settled steps; a diagnosis needs some.")
    for run in runs:
        if not (run.has("t_s") and (run.has("current_command_A") or run.has("current_A"))):
            raise DataError(
                f"{run.path} has no clock or no current: a diagnosis of such runs needs its input as the drive."
            )
    timelines = [_session_timeline(some, tau_s) for some in _runs_by_session(runs)]
    timelines = [timeline for timeline in timelines if len(timeline.settled)]
    return timelines[0] if len(timelines) == 1 else join_sessions(timelines)


def _runs_by_session(runs: Sequence[Run]) -> list[list[Run]]:
    """Runs of each sitting, in the order of their clocks; sittings in the order in which they began."""
    found: dict[tuple[float, str], list[Run]] = {}
    for run in runs:
        epoch, zero = run.info.start_epoch, run.info.encoder_zero
        found.setdefault((float(epoch or 0.0), str(zero)), []).append(run)
    return [
        sorted(found[key], key=lambda r: float(r["t_s"][0]) if len(r) else 0.0)
        for key in sorted(found, key=lambda key: key[0])
    ]


def _session_timeline(ordered_runs: Sequence[Run], tau_s: float) -> Timeline:
    _check_clock(ordered_runs)
    start = float(ordered_runs[0]["t_s"][0]) - _period_s(ordered_runs[0])
    parts = [_TimelineRun(run, k, start, tau_s) for k, run in enumerate(ordered_runs)]
    steps = np.concatenate([np.full(len(p.steps), p.number) for p in parts]).astype(np.int64)
    first = np.cumsum([0, *[len(p.steps) for p in parts]])[:-1]
    settled = _joined_readings([p.settled(int(n)) for p, n in zip(parts, first)])
    target = np.array([s.target for p in parts for s in p.steps], dtype=float)
    return Timeline(
        drive=_joined_drive([p.drive for p in parts], tau_s),
        settled=settled,
        other_readings=tuple(_other_readings(parts, first)),
        target_K=target,
        hold_s=np.array([s.duration_s for p in parts for s in p.steps]),
        run=steps,
        block=_blocks(target, steps),
        runs=tuple(ordered_runs),
        resistance_from_command=not all(run.has("current_A") for run in ordered_runs),
    )


def _check_clock(runs: Sequence[Run]) -> None:
    """DataError where runs of one sitting overlap."""
    for before, run in zip(runs, runs[1:]):
        if run["t_s"][0] <= before["t_s"][-1]:
            raise DataError(
                f"{before.path.name} and {run.path.name} say that they are of one sitting, but their clocks overlap. "
                "Imported runs share one clock: say where on it each begins, 'smarig import --t0 SECONDS'."
            )


def _period_s(run: Run) -> float:
    """Length of its ticks; a tenth of a second where it does not say."""
    return float(run.info.period_s or 0.1)


def _growing_steps(begin: float, end: float, tau_s: float) -> Array:
    """Times after ``begin`` at growing distances, up to ``end``."""
    t, step = [0.0], FIRST_STEP_S
    while t[-1] < end - begin - 0.5 * FIRST_STEP_S:
        longest = next((part * tau_s for until, part in FINE_STEPS if t[-1] < until * tau_s), LONGEST_STEP_S)
        t.append(t[-1] + min(step, longest, LONGEST_STEP_S))
        step *= STEP_GROWTH
    return begin + np.array(t[1:-1])


def _blocks(target: Array, run: Integers) -> Integers:
    """Excursions out and back, numbered through all runs: a block ends where the direction turns upwards."""
    number = np.zeros(target.size, dtype=np.int64)
    count, falling = 0, False
    for k in range(1, target.size):
        change = target[k] - target[k - 1]
        if run[k] != run[k - 1] or (falling and change > 0):
            count, falling = count + 1, False
        falling = falling or change < 0
        number[k] = count
    return number


class _TimelineRun:
    """One run on the story's clock."""

    def __init__(self, run: Run, number: int, start_s: float, tau_s: float) -> None:
        self.run, self.number, self.tau_s = run, number, tau_s
        self.t = run["t_s"] - start_s
        self.start_s = start_s
        name = "current_command_A" if run.has("current_command_A") else "current_A"
        self.command = np.nan_to_num(run[name])
        self.steps: tuple[Step, ...] = run.settled
        self.rows = run.rows_by_clock(self.steps)
        self.reading_s = self._reading_times_s()

    @property
    def drive(self) -> DriveProfile:
        changes = np.flatnonzero(np.diff(self.command)) if self.t.size else np.empty(0, dtype=np.int64)
        last = np.append(changes, self.t.size - 1)
        begin = self.t[:1] - _period_s(self.run)  # until then the current was off
        return DriveProfile(
            np.append(begin, self.t[last]), np.append(np.zeros(begin.size), self.command[last])
        )

    def _window(self, step: Step, rows: slice) -> slice:
        """The rows over which a settled position is the mean."""
        dense = rows.stop - rows.start >= step.n > 1
        return (
            slice(rows.stop - step.n, rows.stop)
            if dense
            else slice(max(rows.stop - 1, rows.start), rows.stop)
        )

    def _reading_times_s(self) -> Array:
        """The middle of each settled window."""
        period = _period_s(self.run)
        end = np.array([s.end_s for s in self.steps], dtype=float)
        begin = np.array([s.t_start_s for s in self.steps], dtype=float)
        half = 0.5 * period * np.array([max(s.n - 1, 0) for s in self.steps])
        return np.maximum(end - half, begin + period) - self.start_s

    def settled(self, first: int) -> ReadingSeries:
        """Positions of the steps."""
        value = np.array([s.position for s in self.steps], dtype=float)
        return ReadingSeries("settled", value, self.reading_s, np.arange(value.size) + first, self.run.unit)

    def moving(self, first: int) -> Iterator[tuple[float, float, int]]:
        """(position, time, step) a few time constants after each step, where samples are dense."""
        y = self.run["position"]
        for k, rows in enumerate(self.rows):
            if rows.stop - rows.start < MIN_HOLD_SAMPLES:
                continue
            t = self.t[rows]
            for wait in MOVING_DELAYS:
                at = int(np.searchsorted(t, t[0] + wait * self.tau_s))
                if at < t.size and np.isfinite(y[rows][at]):
                    yield float(y[rows][at]), float(t[at]), first + k

    def means(self, values: Array, first: int) -> Iterator[tuple[float, float, int]]:
        """(mean over the settled window, time, step) of another channel."""
        for k, (step, rows) in enumerate(zip(self.steps, self.rows)):
            window = values[self._window(step, rows)]
            window = window[np.isfinite(window)]
            if window.size:
                yield float(window.mean()), float(self.reading_s[k]), first + k

    @property
    def resistance(self) -> Array:
        """V/I of each sample, NaN where the current is too small to tell."""
        run = self.run
        current = run["current_A"] if run.has("current_A") else self.command
        enough = np.abs(current) > MIN_CURRENT_A
        return np.where(enough, run["voltage_V"] / np.where(enough, current, 1.0), np.nan)


def _other_readings(parts: Sequence[_TimelineRun], first: Integers) -> Iterator[ReadingSeries]:
    units = (parts[0].run.unit, "ohm", "A", "K")
    channels = (
        lambda p, n: p.moving(n),
        lambda p, n: p.means(p.resistance, n),
        lambda p, n: p.means(p.run["current_A"] - p.command, n),
        lambda p, n: p.means(p.run["ambient_degC"], n),
    )
    for kind, unit, read in zip(OTHER_KINDS, units, channels):
        rows = [row for part, n in zip(parts, first) for row in read(part, int(n))]
        rows = rows[:: 1 + len(rows) // MAX_OTHER_READINGS]
        if len(rows) >= MIN_HOLD_SAMPLES:
            value, t, step = (np.array(c) for c in zip(*rows))
            yield ReadingSeries(kind, value, t, step.astype(np.int64), unit)


def _joined_readings(parts: Sequence[ReadingSeries]) -> ReadingSeries:
    first = parts[0]
    arrays = [np.concatenate([getattr(p, name) for p in parts]) for name in ("value", "t_s", "step")]
    return ReadingSeries(first.kind, arrays[0], arrays[1], arrays[2].astype(np.int64), first.unit)


def _joined_drive(parts: Sequence[DriveProfile], tau_s: float) -> DriveProfile:
    end = np.concatenate([p.end_s for p in parts])
    keep = np.diff(end, prepend=0.0) > 1e-9
    return DriveProfile(end[keep], np.concatenate([p.current_A for p in parts])[keep], tau_s)
