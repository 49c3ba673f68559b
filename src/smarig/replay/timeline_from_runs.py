"""Makes timelines from the runs of one wire: commands become constant currents, samples become readings."""

from collections.abc import Iterator, Sequence

import numpy as np

from smarig.core import DataError
from smarig.record import Run, Step
from smarig.replay.measured_input import build_measured_input_timeline, driven_by_input
from smarig.replay.timeline import (
    OTHER_KINDS,
    Array,
    CurrentProfile,
    Integers,
    ReadingSeries,
    Timeline,
    join_sessions,
    period_s,
)

MOVING_DELAYS = (0.4, 1.2, 3.0)  # time constants after a step at which a moving position is read
MAX_OTHER_READINGS = 220  # of each other kind
MIN_HOLD_SAMPLES = 12  # in a hold from which moving positions are read
MIN_CURRENT_A = 0.15  # a smaller current does not determine a resistance


def build_timeline(runs: Sequence[Run], tau_s: float) -> Timeline:
    """Runs of one wire on one clock, in time order. Raises DataError if they contain no settled steps.

    ``tau_s``: the wire's time constant, which determines when a moving position is read. Each session (one clock, one
    encoder zero) starts at rest. Runs with only a measured input are driven by it, in the given order
    (``MeasuredInput``).
    """
    if driven_by_input(runs):
        return build_measured_input_timeline(runs)
    if not any(run.settled for run in runs):
        names = ", ".join(map(_with_protocol, runs))
        raise DataError(
            f"The runs contain no settled steps: {names}. A diagnosis needs some. Make a run whose protocol waits at "
            "each input, such as validation or first_order_descending."
        )
    for run in runs:
        if not (run.has("t_s") and (run.has("current_command_A") or run.has("current_A"))):
            raise DataError(
                f"{run.path} has no clock or no current. A diagnosis without them needs runs with a measured input."
            )
    timelines = [_session_timeline(some, tau_s) for some in _runs_by_session(runs)]
    timelines = [timeline for timeline in timelines if len(timeline.settled)]
    return timelines[0] if len(timelines) == 1 else join_sessions(timelines, tau_s)


def _with_protocol(run: Run) -> str:
    """The name of a run's file, and what the run was."""
    protocol = run.info.protocol
    return f"{run.path.name} ({protocol})" if protocol else run.path.name


def _runs_by_session(runs: Sequence[Run]) -> list[list[Run]]:
    """Runs of each session, in the order of their clocks; sessions in the order of their start."""
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
    start = float(ordered_runs[0]["t_s"][0]) - period_s(ordered_runs[0])
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
    """Raise DataError if runs of one session overlap."""
    for before, run in zip(runs, runs[1:]):
        if run["t_s"][0] <= before["t_s"][-1]:
            raise DataError(
                f"According to their records, {before.path.name} and {run.path.name} belong to one session, but "
                "their clocks overlap. Imported runs share one clock. Give the start of each run on it with "
                "'smarig import --t0 SECONDS'."
            )


def _blocks(target: Array, run: Integers) -> Integers:
    """Excursions out and back, numbered over all runs: a block ends where the direction turns upwards."""
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
    """One run on the timeline's clock."""

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
    def drive(self) -> CurrentProfile:
        changes = np.flatnonzero(np.diff(self.command)) if self.t.size else np.empty(0, dtype=np.int64)
        last = np.append(changes, self.t.size - 1)
        begin = self.t[:1] - period_s(self.run)  # the current is off until then
        return CurrentProfile(
            np.append(begin, self.t[last]), np.append(np.zeros(begin.size), self.command[last])
        )

    def _window(self, step: Step, rows: slice) -> slice:
        """The rows over which a settled position is averaged."""
        dense = rows.stop - rows.start >= step.n > 1
        return (
            slice(rows.stop - step.n, rows.stop)
            if dense
            else slice(max(rows.stop - 1, rows.start), rows.stop)
        )

    def _reading_times_s(self) -> Array:
        """The middle of each settled window."""
        period = period_s(self.run)
        end = np.array([s.end_s for s in self.steps], dtype=float)
        begin = np.array([s.t_start_s for s in self.steps], dtype=float)
        half = 0.5 * period * np.array([max(s.n - 1, 0) for s in self.steps])
        return np.maximum(end - half, begin + period) - self.start_s

    def settled(self, first: int) -> ReadingSeries:
        """Settled positions of the steps."""
        value = np.array([s.position for s in self.steps], dtype=float)
        return ReadingSeries("settled", value, self.reading_s, np.arange(value.size) + first, self.run.unit)

    def moving(self, first: int) -> Iterator[tuple[float, float, int]]:
        """(position, time, step) a few time constants after each step, if samples are dense."""
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
        """V/I of each sample, NaN if the current is too small."""
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


def _joined_drive(parts: Sequence[CurrentProfile], tau_s: float) -> CurrentProfile:
    end = np.concatenate([p.end_s for p in parts])
    keep = np.diff(end, prepend=0.0) > 1e-9
    return CurrentProfile(end[keep], np.concatenate([p.value for p in parts])[keep], tau_s)
