"""Goes on with a run that was interrupted: same file, same protocol, from the last state that can be had again.

Puts replay, plan, record and rig together. The wire is cooled, taken to what it remembered, and the interrupted step
is made as a new attempt; whatever was done on the way stands in the record, void.
"""

import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from smarig.config import RigFile, load_rig
from smarig.core import DataError, Elapsed, Hold, Protocol, StepResult, UsageError, Waveform
from smarig.plant import Actuator, effects_from_pairs
from smarig.protocols import Chooser, build_protocol
from smarig.record import Continuation, Recorder, Run, load_run
from smarig.rig import TwinSettings
from smarig.runner.listener import Listener
from smarig.runner.own_files import check_drivers, check_own_files
from smarig.runner.preview import Preview, preview
from smarig.runner.resume.replay_protocol import replay_protocol
from smarig.runner.resume.resume_plan import COLD_TAUS, RE_ESTABLISH, ResumePlan, RigState, plan_resume
from smarig.runner.run_control import RunControl
from smarig.runner.session import Session, check_free_space


def session_for(
    run: Run, *, rig: str = "", wire: str = "", speed: float | None = None, control: RunControl | None = None
) -> Session:
    """A sitting at the rig of a run, not yet opened; refuses runs that are done and rigs that are others."""
    launch = read_launch_args(run)
    name = rig or str(launch["rig"])
    file = load_rig(name)
    check_rig(run, file)
    if not rig:
        check_drivers(file, run.path.name, f"to have it executed, say so with --rig {name}")
    run_wire = str(run.info.wire)
    expected_wire = (
        run_wire if run_wire != launch["rig_wire"] else file.wire
    )  # named when it began, or the rig file's
    if (wire or expected_wire) != run_wire:
        raise UsageError(
            f"{run.path.name} is of wire '{run_wire}', not of '{wire or expected_wire}': it cannot go on there."
        )
    with _damaged_record_as_data_error(run):
        seed, noise = int(run.info.seed or 0), bool(launch["noise"])
        twin = TwinSettings(seed, noise, effects=effects_from_pairs(launch["effects"]))
    return Session(name, twin=twin, speed=speed or launch["speed"], wire=run_wire, control=control)


def resume(
    path: str | Path,
    *,
    rig: str = "",
    wire: str = "",
    control: RunControl | None = None,
    chooser: Chooser | None = None,
) -> Run:
    """Go on with a run that was interrupted, and return it: a notebook's way in."""
    run = load_run(path)
    with session_for(run, rig=rig, wire=wire, control=control) as session:
        resume_in(session, run, chooser=chooser)
    return load_run(path)


def resume_in(
    session: Session,
    run: Run,
    *,
    listeners: Sequence[Listener] = (),
    expected: Preview | None = None,
    chooser: Chooser | None = None,
) -> ResumePlan:
    """Go on with a run in an open session; returns how. Raises what ended it, after closing it.

    Nothing is moved or written before it is known that the protocol agrees with the record.
    """
    run = load_run(run.path)  # now that the wire is ours: it may have ended by itself meanwhile
    launch = read_launch_args(run)
    protocol, settings = str(run.info.protocol), launch["settings"]
    fresh_twin = session.source == "twin" and session.rig.tick == 0
    now = RigState(session.device, session.rig.tick, fresh_twin, session.initial)
    with _damaged_record_as_data_error(run):
        replayed = replay_protocol(build_protocol(protocol, session.setup, settings, chooser), run)
        plan = plan_resume(run, replayed, session.setup, now)
        execution = _ResumeExecution(session, run, plan, listeners, _interrupted_rows(run, plan))
    cost = expected or preview(protocol, session.file, settings, session.control, chooser)
    check_free_space(run.path, cost.bytes)
    remaining_protocol = (
        build_protocol(protocol, session.setup, settings, chooser) if plan.start_over else replayed.rest()
    )
    execution.execute(remaining_protocol)
    return plan


@contextmanager
def _damaged_record_as_data_error(run: Run) -> Iterator[None]:
    """What cannot be made sense of in a record is that record's fault."""
    try:
        yield
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
        raise DataError(
            f"{run.path.name} cannot be resumed: its record is damaged ({type(error).__name__}: {error})."
        ) from None


@dataclass(frozen=True)
class _ResumeExecution:
    """One resumption being carried out."""

    session: Session
    run: Run
    plan: ResumePlan
    listeners: Sequence[Listener]
    interrupted: list[tuple]

    def execute(self, rest: Protocol) -> None:
        """Write the interruption down, clear trips, find the way back, and go on."""
        session, run, plan = self.session, self.run, self.plan
        session.guard.arm()
        session.count_unsaved_wear(run)
        first = 1 + max((*run.step_rows, *(s.index for s in run.steps)), default=-1)
        change = Continuation(tuple(self.interrupted), plan.start_over)
        recorder = Recorder(run.path, self._meta(), continuation=change, clock=session.clock())
        record = _AttemptRecorder(recorder, _attempts(run, plan, self.interrupted))
        runner = session.runner([record, *self.listeners], plan.shift)
        runner.steps_done = first
        self._record_resumption(recorder, runner.t_s, first)
        first_tick = session.rig.tick + plan.shift.ticks + 1

        def on_reference(result: StepResult) -> None:
            """The wire is where the reference was: what the counts differ by is the zero that was lost."""
            if plan.reference is None or plan.reference.position is None:
                return
            per_count = session.rig.position_per_count
            zero_shift_counts = plan.reference.position / per_count - result.counts
            counts = round(zero_shift_counts)
            plan.shift.counts += counts
            recorder.shift((first_tick, session.rig.tick + plan.shift.ticks), first, counts, per_count)
            recorder.describe("shift", asdict(plan.shift))
            recorder.describe("device", session.device)
            text = (
                f"The encoder's zero was met again in the state of step {plan.reference.index}: {counts:+d} counts are "
                "added from here on, and were to the way back until now."
            )
            recorder.event(result.t_end_s, "shift", text, counts=counts, found=zero_shift_counts)

        done = plan.replayed.pending is None and not plan.start_over
        full_protocol = rest if done else _restore_then(plan, rest, session.setup.tau_s, on_reference)
        session.carry_out(recorder, runner, full_protocol, new_run=not run.info.has("history_until_tick"))

    def _meta(self) -> dict[str, Any]:
        """Keys of the run table that are others from now on."""
        recorded_indices = self.plan.reference is None  # until its zero is met again, a device is nobody's
        device = self.session.device if recorded_indices else ""
        now: dict[str, Any] = {"device": device, "shift": asdict(self.plan.shift)}
        if self.plan.start_over:
            now["initial"] = self.session.initial
        return now

    def _record_resumption(self, recorder: Recorder, t_s: float, first: int) -> None:
        run, plan = self.run, self.plan
        ended_s = float(run["t_s"][-1]) if len(run) else 0.0
        recorder.event(ended_s, "interrupted", f"Interrupted: {run.cause}.", level="warning", cause=run.cause)
        recorder.event(
            t_s,
            "resumed",
            plan.sentence(),
            epoch=time.time(),
            start_over=plan.start_over,
            first_step=first,
            holds=plan.holds,
            inputs_K=list(plan.inputs_K),
            ticks=plan.shift.ticks,
        )


def _restore_then(plan: ResumePlan, rest: Protocol, tau_s: float, on_reference: Any) -> Protocol:
    """The way back, and on from there."""
    try:
        yield Hold(0.0, Elapsed(COLD_TAUS * tau_s), branch=RE_ESTABLISH)
        result = yield Hold(0.0, plan.settle, branch=RE_ESTABLISH)
        currents = plan.currents_A
        if plan.begins_cold:
            on_reference(result)
            currents = currents[1:]
        for k, current_A in enumerate(currents):
            result = yield Hold(current_A, plan.settle, branch=RE_ESTABLISH)
            if k == 0 and not plan.begins_cold:
                on_reference(result)
        yield from rest
    finally:
        rest.close()


# --- what was interrupted ------------------------------------------------------------------------------------


def _interrupted_rows(run: Run, plan: ResumePlan) -> list[tuple]:
    """Rows of steps that have samples but no row: nobody was left to write it. They have no settled position."""
    recorded_indices = {s.index for s in run.steps}
    pending = plan.replayed.pending
    rows = []
    for index, where in run.step_rows.items():
        if index < 0 or index in recorded_indices:
            continue
        t_s = run["t_s"][where]
        begin_s, end_s = float(t_s[0]) - float(run.info.period_s or 0.0), float(t_s[-1])
        in_restore_path = _in_restore_path(run, index)
        branch = (
            RE_ESTABLISH
            if in_restore_path
            else pending.branch
            if isinstance(pending, Hold | Waveform)
            else ""
        )
        target = pending.target if isinstance(pending, Hold) and not in_restore_path else None
        attempt = 0 if in_restore_path else _next_attempt(run)
        rows.append((index, attempt, 1, branch, target, begin_s, end_s, "interrupted", None, t_s.size))
    return rows


def _in_restore_path(run: Run, index: int) -> bool:
    """Whether a step belonged to an earlier way back."""
    restores = [(int(e.data["first_step"]), int(e.data["holds"])) for e in run.events if e.kind == "resumed"]
    return any(first <= index < first + holds for first, holds in restores)


def _next_attempt(run: Run) -> int:
    """How often the step after the last valid one has been tried."""
    last = max((s.index for s in run.steps if not s.void), default=-1)
    after = [s for s in run.steps if s.index > last and s.branch != RE_ESTABLISH]
    return 1 + max((s.attempt for s in after), default=-1)


def _attempts(run: Run, plan: ResumePlan, interrupted: list[tuple]) -> dict[int, int]:
    """By number of a step in its protocol: which attempt it will be, where not the first."""
    valid = [s for s in run.steps if not s.void]
    attempt_number = _next_attempt(run) + any(row[3] != RE_ESTABLISH for row in interrupted)
    before = {k: s.attempt + 1 for k, s in enumerate(valid)} if plan.start_over else {}
    return {**before, len(valid): attempt_number} if plan.start_over else {0: attempt_number}


class _AttemptRecorder:
    """The recorder of a run that goes on: numbers attempts, and marks the way back as void."""

    def __init__(self, recorder: Recorder, attempts: dict[int, int]) -> None:
        self.sample, self.event = recorder.sample, recorder.event
        self._recorder, self._attempts, self._done = recorder, attempts, 0

    def step(self, result: StepResult, *, branch: str, target: float | None) -> None:
        """A finished step."""
        if branch == RE_ESTABLISH:
            self._recorder.step(result, branch=branch, target=None, void=True)
            return
        attempt = self._attempts.get(self._done, 0)
        self._done += 1
        self._recorder.step(result, branch=branch, target=target, attempt=attempt)


# --- refusals ---------------------------------------------------------------------------------------------------


def read_launch_args(run: Run) -> Mapping[str, Any]:
    """What a run was begun with; a sentence where it is no run that can be gone on with."""
    name = run.path.name
    if run.cause == "done":
        raise UsageError(f"{name} is done: there is nothing to go on with.")
    if run.info.closed_loop:
        raise UsageError(f"{name} was a closed loop: it is not resumed, but closed anew on a prepared wire.")
    launch = run.info.launch_args
    wanted = {"rig", "rig_wire", "speed", "effects", "noise", "settings"}
    if run.info.source == "simulation" or launch is None or not wanted <= set(launch):
        raise DataError(
            f"{name} does not state what it was started with: only runs that this smarig records on a rig or a "
            "twin can be resumed."
        )
    if launch["effects"] is None:
        raise DataError(f"{name} was run with effects of its own making: they are not in its record.")
    check_own_files(run)
    return launch


def check_rig(run: Run, file: RigFile) -> None:
    """UsageError where a run was made on another rig."""
    for what, then, now in (
        ("rig", run.info.rig, file.name),
        ("actuator", run.info.actuator, Actuator.named(file.actuator).name),
        ("period_s", run.info.period_s, file.period_s),
    ):
        if then != now:
            raise UsageError(
                f"{run.path.name} was run on {what} '{then}', not on '{now}': it cannot go on there."
            )
