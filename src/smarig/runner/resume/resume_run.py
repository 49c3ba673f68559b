"""Resumes an interrupted run: same file, same protocol, from the last state that can be restored.

The wire is cooled and its memory restored, then the interrupted step is made as a new attempt. The steps of the path
back are recorded as void.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from smarig.config import load_actuator, load_rig
from smarig.core import Elapsed, Hold, Protocol, StepResult, UsageError
from smarig.plant import effects_from_pairs
from smarig.protocols import Chooser, build_protocol
from smarig.record import Continuation, Recorder, Run, load_run, recording
from smarig.rig import TwinSettings
from smarig.runner.listener import Listener
from smarig.runner.preview import Preview, preview
from smarig.runner.resume.attempts import AttemptRecorder, attempts, interrupted_rows
from smarig.runner.resume.damaged_record import damaged_record_as_data_error
from smarig.runner.resume.launch_args import read_launch_args
from smarig.runner.resume.replay_protocol import replay_protocol
from smarig.runner.resume.resume_plan import COLD_TAUS, RE_ESTABLISH, ResumePlan, RigState, plan_resume
from smarig.runner.resume.same_rig import Reach, RigChange, check_names, check_same_rig
from smarig.runner.run_control import RunControl
from smarig.runner.run_metadata import LOAD
from smarig.runner.session import Session
from smarig.runner.start_checks import check_free_space
from smarig.runner.wire_heat import recorded_heat


def session_for(
    run: Run,
    *,
    rig: str = "",
    wire: str = "",
    speed: float | None = None,
    control: RunControl | None = None,
    settings: Mapping[str, Any] | None = None,
) -> Session:
    """A session at the rig of a run, not yet opened. Refuses finished runs and other rigs."""
    launch = read_launch_args(run, settings)
    name = rig or launch["rig"]
    file = load_rig(name)
    actuator = load_actuator(file.actuator)
    check_names(run, file, actuator)
    run_wire = str(run.info.wire)
    expected_wire = (
        run_wire if run_wire != launch["rig_wire"] else file.wire
    )  # the wire that was given at the start, or the rig file's
    if (wire or expected_wire) != run_wire:
        raise UsageError(
            f"{run.path.name} belongs to wire '{run_wire}', not to '{wire or expected_wire}'. It cannot continue there."
        )
    with damaged_record_as_data_error(run):
        seed, noise = int(run.info.seed or 0), bool(launch["noise"])
        twin = TwinSettings(seed, noise, effects=effects_from_pairs(launch["effects"]))
        session = Session(
            name,
            twin=twin,
            speed=speed or launch["speed"],
            wire=run_wire,
            control=control,
            load=launch.get(LOAD, ""),
        )
        if session.load and session.load.changes:
            raise UsageError(
                f"The load of {run.path.name} changes over time, which cannot be taken up again. Start the run again."
            )
    check_same_rig(run, session)
    return session


def resume(
    path: str | Path,
    *,
    rig: str = "",
    wire: str = "",
    control: RunControl | None = None,
    chooser: Chooser | None = None,
    settings: Mapping[str, Any] | None = None,
) -> Run:
    """Resume an interrupted run and return it; the entry point for notebooks.

    ``settings``: those that name files, for example {"file": "profile.csv"}, given again.
    """
    run = load_run(path)
    with session_for(run, rig=rig, wire=wire, control=control, settings=settings) as session:
        resume_in(session, run, chooser=chooser, settings=settings)
    return load_run(path)


def resume_in(
    session: Session,
    run: Run,
    *,
    listeners: Sequence[Listener] = (),
    expected: Preview | None = None,
    chooser: Chooser | None = None,
    settings: Mapping[str, Any] | None = None,
) -> ResumePlan:
    """Resume a run in an open session and return its plan. Closes the run before it raises the error that ended it.
    Raises InUse if another process records it.

    Nothing is moved or written before the protocol is known to agree with the record. ``settings``: those that name
    files, given again.
    """
    with recording(run.path):
        return _resume_recording(session, run.path, listeners, expected, chooser, settings)


def _resume_recording(
    session: Session,
    path: Path,
    listeners: Sequence[Listener],
    expected: Preview | None,
    chooser: Chooser | None,
    given: Mapping[str, Any] | None,
) -> ResumePlan:
    run = load_run(path)  # again, under the lock of the run: it may have ended meanwhile
    launch = read_launch_args(run, given)
    protocol, settings = str(run.info.protocol), launch["settings"]
    same = check_same_rig(run, session)
    fresh_twin = session.source == "twin" and session.rig.tick == 0
    zero = session.guard.absolute_zero
    now = RigState(session.device, session.rig.tick, fresh_twin, session.initial, zero)
    with damaged_record_as_data_error(run):
        replayed = replay_protocol(build_protocol(protocol, session.setup, settings, chooser), run)
        plan = replace(plan_resume(run, replayed, session.setup, now), remarks=same.remarks)
        heat = recorded_heat(run, session.actuator, session.file.lease_s)
        execution = _ResumeExecution(session, run, plan, listeners, same.changes, interrupted_rows(run, plan))
    session.start_hot(heat)
    cost = expected or preview(protocol, session.file, settings, session.control, chooser)
    check_free_space(run.path, cost.bytes)
    remaining_protocol = (
        build_protocol(protocol, session.setup, settings, chooser) if plan.start_over else replayed.rest()
    )
    execution.execute(remaining_protocol)
    return plan


@dataclass(frozen=True)
class _ResumeExecution:
    """One resumption in execution."""

    session: Session
    run: Run
    plan: ResumePlan
    listeners: Sequence[Listener]
    changes: Sequence[RigChange]
    interrupted: list[tuple]

    def execute(self, rest: Protocol) -> None:
        """Record the interruption, clear trips, restore the state, and continue."""
        session, run, plan = self.session, self.run, self.plan
        session.guard.arm()
        session.count_unsaved_wear(run)
        first = 1 + max((*run.step_rows, *(s.index for s in run.steps)), default=-1)
        change = Continuation(tuple(self.interrupted), plan.start_over)
        recorder = Recorder(run.path, self._meta(), continuation=change, clock=session.clock())
        record = AttemptRecorder(recorder, attempts(run, plan, self.interrupted))
        runner = session.runner([record, *self.listeners], plan.shift)
        runner.steps_done = first
        self._record_resumption(recorder, runner.t_s, first)
        kept = [] if plan.start_over else [s for s in run.steps if not s.void]
        before = {"done_steps": len(kept), "done_s": sum(s.duration_s for s in kept)}
        for listener in self.listeners:
            listener.event(runner.t_s, "resumed", plan.sentence(), **before)
        first_tick = session.rig.tick + plan.shift.ticks + 1

        def on_reference(result: StepResult) -> None:
            """The wire is in the reference state: the difference of counts is the lost zero."""
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
                f"The encoder's zero was restored in the state of step {plan.reference.index}: {counts:+d} counts are "
                "added from here on, and were added to the path back."
            )
            recorder.event(result.t_end_s, "shift", text, counts=counts, found=zero_shift_counts)

        done = plan.replayed.pending is None and not plan.start_over
        full_protocol = rest if done else _restore_then(plan, rest, session.setup.tau_s, on_reference)
        session.carry_out(recorder, runner, full_protocol, new_run=not run.info.has("history_until_tick"))

    def _meta(self) -> dict[str, Any]:
        """Keys of the run table that change."""
        recorded_indices = self.plan.reference is None  # without its zero, the device is not recorded
        device = self.session.device if recorded_indices else ""
        now: dict[str, Any] = {"device": device, "shift": asdict(self.plan.shift)}
        if self.plan.start_over:
            now["initial"] = self.session.initial
        return now

    def _record_resumption(self, recorder: Recorder, t_s: float, first: int) -> None:
        run, plan = self.run, self.plan
        ended_s = float(run["t_s"][-1]) if len(run) else 0.0
        recorder.event(
            ended_s,
            "interrupted",
            f"Interrupted: {run.past_cause.rstrip('.')}.",
            level="warning",
            cause=run.past_cause,
        )
        recorder.event(
            t_s,
            "resumed",
            plan.sentence(),
            **self.session.moment(),
            start_over=plan.start_over,
            first_step=first,
            holds=plan.holds,
            inputs_K=list(plan.inputs_K),
            ticks=plan.shift.ticks,
        )
        for change in self.changes:
            level = "warning" if change.reach is Reach.SAFETY else "info"
            data = {"key": change.key, "was": change.was, "now": change.now}
            for listener in (recorder, *self.listeners):
                listener.event(
                    t_s, "rig", f"Since the interruption: {change.sentence()}.", level=level, **data
                )


def _restore_then(plan: ResumePlan, rest: Protocol, tau_s: float, on_reference: Any) -> Protocol:
    """The path back, followed by the rest of the protocol."""
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
