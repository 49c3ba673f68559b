"""The timeline: drive and readings of one wire, with all runs on one clock and the time between them."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import final

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, DataError
from smarig.plant import EffectType
from smarig.preisach import Everett
from smarig.record import CONTINUED, Run

Integers = NDArray[np.int64]
FIRST_STEP_S, STEP_GROWTH, LONGEST_STEP_S = 0.1, 1.3, 8.0  # time steps after a change of the current
FINE_STEPS = (
    (4.0, 0.15),
    (9.0, 0.4),
)  # time constants: end of each phase of motion, and the longest step within it
OTHER_KINDS = ("moving", "resistance", "current", "room")  # other kinds of readings, in order
SESSION_SPACING_S = 36000.0  # between sessions on the common clock: longer than any ambient fluctuation


@dataclass(frozen=True, eq=False)
class ReadingSeries:
    """Readings of one kind: values (n,), the time of each on the timeline's clock, and its settled step.

    ``step`` (n,) is the number of the settled point; ``noise`` the standard deviation of one reading, None if unknown.
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
        """The readings selected by a mask."""
        return ReadingSeries(
            self.kind, self.value[keep], self.t_s[keep], self.step[keep], self.unit, self.noise
        )


@dataclass(frozen=True, eq=False)
class DriveProfile(ABC):
    """The drive of the wire: ``value`` (m,), a current in A or an input in its unit, up to ``end_s`` (m,), from 0 s.

    The kind of drive decides what the times and inputs of a timeline mean.
    """

    end_s: Array
    value: Array

    @property
    @abstractmethod
    def has_clock(self) -> bool:
        """Whether times are in seconds; otherwise they count samples."""

    @abstractmethod
    def ticks(self, at_s: Array) -> tuple[Array, Array]:
        """Times (k,) that include every ``at_s``, and the value (k,) up to each."""

    @abstractmethod
    def unrecorded_gap_s(self, sessions: Sequence[Sequence[Run]]) -> float:
        """Seconds between runs of one session that no run records."""

    @abstractmethod
    def can_show(self, effect_type: EffectType, hysteresis: Everett) -> bool:
        """Whether an effect can appear in readings under this drive."""


@final
@dataclass(frozen=True, eq=False)
class CurrentProfile(DriveProfile):
    """Constant currents, in A; ``tau_s`` is the time constant of the wire."""

    tau_s: float = 5.0

    @property
    def has_clock(self) -> bool:
        """Always true: heating needs a clock."""
        return True

    def ticks(self, at_s: Array) -> tuple[Array, Array]:
        """Times (k,) and currents (k,): fine after each change, coarse later, including every ``at_s``."""
        begin = np.concatenate([[0.0], self.end_s[:-1]])
        grid = [np.concatenate([_growing_steps(a, b, self.tau_s), [b]]) for a, b in zip(begin, self.end_s)]
        wanted = at_s[(at_s > 0) & (at_s <= self.end_s[-1])]
        t = np.unique(np.concatenate([*grid, wanted]).round(6))
        which = np.clip(np.searchsorted(self.end_s, t - 1e-7), 0, self.end_s.size - 1)
        return t, self.value[which]

    def unrecorded_gap_s(self, sessions: Sequence[Sequence[Run]]) -> float:
        """Seconds between the end of each run and the first tick of the next one in its session."""
        gaps = [
            float(after["t_s"][0] - before["t_s"][-1]) - period_s(after)
            for runs in sessions
            for before, after in pairwise(runs)
        ]
        return sum(gaps, 0.0)

    def can_show(self, effect_type: EffectType, hysteresis: Everett) -> bool:  # noqa: ARG002
        """Always true: current, heating and position are all part of the record."""
        return True


def period_s(run: Run) -> float:
    """Length of a run's ticks; 0.1 s if not recorded."""
    return float(run.info.period_s or 0.1)


def _growing_steps(begin: float, end: float, tau_s: float) -> Array:
    """Times between ``begin`` and ``end`` at growing distances."""
    t, step = [0.0], FIRST_STEP_S
    while t[-1] < end - begin - 0.5 * FIRST_STEP_S:
        longest = next((part * tau_s for until, part in FINE_STEPS if t[-1] < until * tau_s), LONGEST_STEP_S)
        t.append(t[-1] + min(step, longest, LONGEST_STEP_S))
        step *= STEP_GROWTH
    return begin + np.array(t[1:-1])


@dataclass(frozen=True, eq=False)
class Timeline:
    """Drive and readings of a wire, in time order.

    ``settled`` are positions of finished steps; ``target_K`` (k,), ``hold_s`` (k,), ``run`` (k,) describe those
    steps; ``block`` (k,) numbers the excursions that are held out together. ``zero`` (k,) numbers groups of outputs
    with a common zero, if there are several. ``sessions``: the timeline of each session, if there are several.
    ``resistance_from_command``: no current was measured, so a resistance is the voltage over the commanded current.
    """

    drive: DriveProfile
    settled: ReadingSeries
    other_readings: tuple[ReadingSeries, ...]
    target_K: Array
    hold_s: Array
    run: Integers
    block: Integers
    runs: tuple[Run, ...]
    zero: Integers = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    sessions: tuple["Timeline", ...] = ()
    resistance_from_command: bool = False

    @property
    def duration_h(self) -> float:
        """Length of the longest session."""
        return max(float(s.drive.end_s[-1]) for s in self.sessions or (self,)) / 3600

    @property
    def session(self) -> Integers:
        """The number (k,) of the session of each step."""
        return self.zero if self.sessions else np.zeros(len(self.settled), dtype=np.int64)

    @property
    def unrecorded_gap_s(self) -> float:
        """Seconds between runs of one session that no run records; 0 for a measured input."""
        return self.drive.unrecorded_gap_s([session.runs for session in self.sessions or (self,)])

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
        """The same with position readings only; always the same object, which is a key of the input cache."""
        other_readings = tuple(r for r in self.other_readings if r.kind == "moving")
        if other_readings == self.other_readings:
            return self
        return replace(
            self, other_readings=other_readings, sessions=tuple(s.positions_only for s in self.sessions)
        )

    @cached_property
    def ticks(self) -> tuple[Array, Array, NDArray[np.bool_]]:
        """Times (m,) of the simulation, the drive up to each, and whether there is a reading at each."""
        read = np.unique(np.round(np.concatenate([r.t_s for r in self.all_readings]), 6))
        t, current = self.drive.ticks(read)
        return t, current, np.isin(t, read, assume_unique=True)


def join_sessions(timelines: Sequence[Timeline], tau_s: float) -> Timeline:
    """Timelines of several sessions as one: each starts at rest, with its own clock and its own zero.

    A session whose first run is missing (it is ``continued``) is assumed to start like the others. Raises DataError if
    they start in different states.
    """
    starts = {str(timeline.runs[0].info.initial) for timeline in timelines} - {CONTINUED}
    if len(starts) > 1:
        raise DataError(
            f"The sessions start in different states ({', '.join(sorted(starts))}). Diagnose sessions with the "
            "same initial state."
        )
    first, second = timelines[0], timelines[1:]
    clock = session_offsets_s(timelines)
    steps = _cumulative_before([len(s.settled) for s in timelines])
    units = {r.kind: r.unit for timeline in timelines for r in timeline.other_readings}
    kinds = {kind: units[kind] for kind in OTHER_KINDS if kind in units}
    return replace(
        first,
        drive=_joined_drive(timelines, clock, tau_s),
        settled=_joined_readings(first.settled.kind, first.unit, timelines, clock, steps),
        other_readings=tuple(
            _joined_readings(kind, unit, timelines, clock, steps) for kind, unit in kinds.items()
        ),
        target_K=np.concatenate([s.target_K for s in timelines]),
        hold_s=np.concatenate([s.hold_s for s in timelines]),
        run=_renumbered([s.run for s in timelines], [len(s.runs) for s in timelines]),
        block=_renumbered([s.block for s in timelines], [int(s.block.max()) + 1 for s in timelines]),
        runs=(*first.runs, *(run for timeline in second for run in timeline.runs)),
        zero=np.concatenate([np.full(len(s.settled), k) for k, s in enumerate(timelines)]).astype(np.int64),
        sessions=tuple(timelines),
    )


def session_offsets_s(timelines: Sequence[Timeline]) -> Array:
    """Start of each session on the common clock, s."""
    return _cumulative_before([float(s.drive.end_s[-1]) + SESSION_SPACING_S for s in timelines])


def _cumulative_before(sizes: Sequence[float]) -> Array:
    """The sum of all earlier sizes, for each."""
    return np.concatenate([[0.0], np.cumsum(sizes)[:-1]])


def _renumbered(numbers: Sequence[Integers], sizes: Sequence[int]) -> Integers:
    return np.concatenate([n + int(b) for n, b in zip(numbers, _cumulative_before(sizes))]).astype(np.int64)


def _joined_drive(timelines: Sequence[Timeline], clock: Array, tau_s: float) -> CurrentProfile:
    """All currents, with zero between the sessions."""
    ends, currents = [], []
    for timeline, begin in zip(timelines, clock.tolist()):
        ends += [[begin], timeline.drive.end_s + begin] if begin else [timeline.drive.end_s]
        currents += [[0.0], timeline.drive.value] if begin else [timeline.drive.value]
    return CurrentProfile(np.concatenate(ends), np.concatenate(currents), tau_s)


def _joined_readings(
    kind: str, unit: str, timelines: Sequence[Timeline], clock: Array, steps: Array
) -> ReadingSeries:
    own = [
        (r, begin, int(step))
        for timeline, begin, step in zip(timelines, clock.tolist(), steps.tolist())
        for r in timeline.all_readings
        if r.kind == kind
    ]
    return ReadingSeries(
        kind,
        np.concatenate([r.value for r, _, _ in own]),
        np.concatenate([r.t_s + begin for r, begin, _ in own]),
        np.concatenate([r.step + step for r, _, step in own]).astype(np.int64),
        unit,
    )
