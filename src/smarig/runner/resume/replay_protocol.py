"""Replays a protocol, without a rig, to the end of its record: finished steps are answered from the record.

If the recorded steps differ from the protocol's present commands, the run is not resumed.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from smarig.core import (
    Array,
    Command,
    DataError,
    Drive,
    Hold,
    Mark,
    Protocol,
    StepResult,
    StepVerdict,
    Waveform,
    Zero,
)
from smarig.record import Run, Step

MAX_MAGNITUDE = 2.0**52  # of numbers that are exact integers
_TOLERANCE = 1e-9  # A, K: currents and targets that differ only by rounding


@dataclass(frozen=True)
class FinishedStep:
    """A finished step: its command, its row in the record, and the input of the heating model at its end."""

    command: Hold | Waveform
    step: Step
    input_K: float


@dataclass(frozen=True)
class ReplayedProtocol:
    """A protocol at the end of its record. ``pending`` is its next command, None at its end. ``exact`` is False if the
    protocol closes a loop, whose samples cannot be answered from the record.
    """

    protocol: Protocol
    done: tuple[FinishedStep, ...]
    pending: Command | None
    exact: bool = True

    def rest(self) -> Protocol:
        """The protocol from here on."""
        command = self.pending
        while command is not None:
            answer = yield command
            command = _next(self.protocol, answer)


def replay_protocol(protocol: Protocol, run: Run) -> ReplayedProtocol:
    """Answer a protocol's commands with a run's valid steps. Raises DataError if they differ."""
    _check_samples(run)
    steps = [s for s in run.steps if not s.void]
    marks_left = {Mark: _event_count(run, "mark"), Zero: _event_count(run, "zero")}
    done: list[FinishedStep] = []
    command = _next(protocol, None)
    while command is not None:
        answer: StepResult | None = None
        if isinstance(command, Drive):
            return ReplayedProtocol(protocol, tuple(done), command, exact=False)
        if isinstance(command, Hold | Waveform):
            if len(done) == len(steps):
                break
            found = _matched_step(run, command, steps[len(done)])
            done.append(found)
            answer = _result(run, found.step)
        elif len(done) == len(steps) and marks_left[type(command)] <= 0:
            break
        else:
            marks_left[type(command)] -= 1
        command = _next(protocol, answer)
    if len(done) < len(steps):
        raise DataError(
            f"{run.path.name} contains {len(steps)} finished steps, but its protocol now ends after {len(done)}. "
            "It cannot be resumed."
        )
    return ReplayedProtocol(protocol, tuple(done), command)


def _check_samples(run: Run) -> None:
    """Raise DataError if the samples of a record are not valid."""
    for name in ("tick", "t_s", "counts", "current_command_A", "input"):
        wrong = np.flatnonzero(~(np.abs(run[name]) < MAX_MAGNITUDE))
        if wrong.size:
            raise DataError(
                f"{run.path.name}: sample {wrong[0]} has {name} {run[name][wrong[0]]:g}. The record is damaged."
            )
    if np.any(np.diff(run["t_s"]) <= 0):
        raise DataError(f"{run.path.name}: its time decreases. The record is damaged.")


def _next(protocol: Protocol, answer: Any) -> Command | None:
    try:
        return protocol.send(answer)
    except StopIteration:
        return None


def _event_count(run: Run, kind: str) -> int:
    """Number of events of a kind since the run was started or restarted."""
    restart_index = max((k for k, e in enumerate(run.events) if e.data.get("start_over")), default=0)
    return sum(e.kind == kind for e in run.events[restart_index:])


def _matched_step(run: Run, command: Hold | Waveform, step: Step) -> FinishedStep:
    rows = run.rows(step)
    if rows.start == rows.stop:
        raise DataError(f"{run.path.name}: step {step.index} has no samples. The record is damaged.")
    commanded_A = run["current_command_A"][rows]
    expected_A = command.current_A if isinstance(command, Hold) else command.currents_A[-1]
    target = command.target if isinstance(command, Hold) else None
    same_target = (
        step.target is None
        if target is None
        else step.target is not None and abs(step.target - target) <= _TOLERANCE * max(1.0, abs(target))
    )
    if step.branch != command.branch or not same_target or not _same_currents(command, commanded_A):
        raise DataError(
            f"{run.path.name}: step {step.index} was '{step.branch}' at {_current_list(commanded_A)} A, but its "
            "protocol now commands "
            f"'{command.branch}' at {expected_A:g} A there. The rig file, the settings or smarig have changed."
        )
    return FinishedStep(command, step, float(run["input"][rows][-1]))


def _same_currents(command: Hold | Waveform, commanded_A: Array) -> bool:
    """Whether only these currents were commanded; a late host first reads samples of the previous current."""
    expected = np.sort(command.currents_A if isinstance(command, Waveform) else [command.current_A])
    near = expected[np.searchsorted(expected, commanded_A - _TOLERANCE).clip(max=expected.size - 1)]
    wrong = np.abs(near - commanded_A) > _TOLERANCE
    late_rows = int(np.argmin(wrong))  # rows before the first match
    return not wrong[late_rows:].any() and np.ptp(commanded_A[: max(late_rows, 1)]) == 0


def _current_list(commanded_A: Array) -> str:
    """The first few currents in order."""
    changes = commanded_A[np.concatenate([[True], np.diff(commanded_A) != 0])]
    return ", ".join(f"{a:g}" for a in changes[:3]) + (", …" if changes.size > 3 else "")


def _result(run: Run, step: Step) -> StepResult:
    """The answer that the protocol received, from the samples of the step's window."""
    counts = run["counts"][run.window(step)]
    if step.n < 0 or counts.size < max(step.n, 1):
        raise DataError(
            f"{run.path.name}: step {step.index} has {counts.size} samples of {step.n}. The record is damaged."
        )
    sd = float(counts.std(ddof=1)) if counts.size > 1 else 0.0
    position = np.nan if step.position is None else step.position
    return StepResult(
        index=step.index,
        verdict=StepVerdict(step.verdict),
        position=position,
        counts=float(counts.mean()),
        counts_sd=sd,
        n=step.n,
        t_start_s=step.t_start_s,
        t_end_s=step.end_s,
    )
