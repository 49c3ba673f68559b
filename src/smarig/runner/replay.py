"""A protocol is taken, without a rig, to where its record ends: its finished steps are answered from the record.

What was done must be what the protocol asks for now, or nothing is gone on with. Knows commands and records; refuses
to know rigs, and what becomes of the wire.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from smarig.command import Command, Drive, Hold, Mark, Protocol, StepResult, Verdict, Waveform, Zero
from smarig.errors import DataError
from smarig.record import Run, Step

_SAME = 1e-9  # A, K: currents and targets that differ by rounding only


@dataclass(frozen=True)
class Done:
    """A finished step: what was asked, how the record has it, where the heating model stood at its end."""

    command: Hold | Waveform
    step: Step
    input_K: float


@dataclass(frozen=True)
class Replayed:
    """Where a record ends. ``pending`` is what the protocol asks for next, None at its end; ``exact`` is False when
    the protocol closes a loop: its samples cannot be answered from the record."""

    protocol: Protocol
    done: tuple[Done, ...]
    pending: Command | None
    exact: bool = True

    def rest(self) -> Protocol:
        """The protocol from here on."""
        command = self.pending
        while command is not None:
            answer = yield command
            command = _next(self.protocol, answer)


def replay(protocol: Protocol, run: Run) -> Replayed:
    """Answer a protocol's commands with a run's valid steps; DataError where the two do not agree."""
    steps = [s for s in run.steps if not s.void]
    remarks = {Mark: _told(run, "mark"), Zero: _told(run, "zero")}
    rows = stretches(run)
    done: list[Done] = []
    command = _next(protocol, None)
    while command is not None:
        answer: StepResult | None = None
        if isinstance(command, Drive):
            return Replayed(protocol, tuple(done), command, exact=False)
        if isinstance(command, Hold | Waveform):
            if len(done) == len(steps):
                break
            found = _agreed(run, command, steps[len(done)], rows)
            done.append(found)
            answer = _result(run, found.step, rows)
        elif len(done) == len(steps) and remarks[type(command)] <= 0:
            break
        else:
            remarks[type(command)] -= 1
        command = _next(protocol, answer)
    if len(done) < len(steps):
        raise DataError(
            f"{run.path.name} holds {len(steps)} finished steps, but its protocol ends after {len(done)} now: "
            "it cannot be gone on with."
        )
    return Replayed(protocol, tuple(done), command)


def _next(protocol: Protocol, answer: Any) -> Command | None:
    try:
        return protocol.send(answer)
    except StopIteration:
        return None


def _told(run: Run, kind: str) -> int:
    """How many remarks of a kind were made since the run began, or began anew."""
    anew = max((k for k, e in enumerate(run.events) if e.data.get("start_over")), default=0)
    return sum(e.kind == kind for e in run.events[anew:])


def stretches(run: Run) -> dict[int, slice]:
    """The rows of each step's samples; a number stands for one stretch."""
    number = np.nan_to_num(run["step"], nan=-1.0).astype(np.int64)
    if not number.size:
        return {}
    edges = np.flatnonzero(np.diff(number)) + 1
    begins, ends = np.concatenate([[0], edges]), np.concatenate([edges, [number.size]])
    return {int(number[a]): slice(int(a), int(b)) for a, b in zip(begins, ends) if number[a] >= 0}


def _agreed(run: Run, command: Hold | Waveform, step: Step, rows: dict[int, slice]) -> Done:
    if step.index not in rows:
        raise DataError(f"{run.path.name}: step {step.index} has no samples; the record is damaged.")
    asked = run["current_command_A"][rows[step.index]]
    wanted = command.current_A if isinstance(command, Hold) else command.currents_A[-1]
    target = command.target if isinstance(command, Hold) else None
    same_target = (
        step.target is None
        if target is None
        else step.target is not None and abs(step.target - target) <= _SAME * max(1.0, abs(target))
    )
    same_current = abs(asked[-1] - wanted) <= _SAME and (isinstance(command, Waveform) or np.ptp(asked) == 0)
    if step.branch != command.branch or not same_target or not same_current:
        raise DataError(
            f"{run.path.name}: step {step.index} was '{step.branch}' at {asked[-1]:g} A, but its protocol asks for "
            f"'{command.branch}' at {wanted:g} A there now: rig file, settings or smarig have changed since."
        )
    return Done(command, step, float(run["input"][rows[step.index]][-1]))


def _result(run: Run, step: Step, rows: dict[int, slice]) -> StepResult:
    """What the protocol was answered then, from the samples of the step's window."""
    counts = run["counts"][rows[step.index]][-step.n :] if step.n else np.empty(0)
    if counts.size < max(step.n, 1):
        raise DataError(
            f"{run.path.name}: step {step.index} has {counts.size} samples of {step.n}; the record is damaged."
        )
    sd = float(counts.std(ddof=1)) if counts.size > 1 else 0.0
    position = np.nan if step.position is None else step.position
    end_s = step.t_start_s if step.t_end_s is None else step.t_end_s
    return StepResult(
        step.index, Verdict(step.verdict), position, float(counts.mean()), sd, step.n, step.t_start_s, end_s
    )
