"""Goes on with a run that was interrupted: same file, same protocol, from the last state that can be had again.

Puts replay, plan, record and rig together. The wire is cooled, taken to what it remembered, and the interrupted step
is made as a new attempt; whatever was done on the way stands in the record, void.
"""

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from smarig.command import Elapsed, Hold, Protocol, StepResult, Waveform
from smarig.config import RigFile, load_rig
from smarig.errors import DataError, UsageError
from smarig.model.actuator import Actuator
from smarig.model.planted import from_pairs
from smarig.protocols._settings import build
from smarig.protocols.adaptive_fod import Chooser
from smarig.record import Recorder, Run, load_run
from smarig.record.going_on import GoingOn
from smarig.rig.twin import TwinSettings
from smarig.runner.control import Control
from smarig.runner.description import BEGUN_WITH, CLOSED_LOOP
from smarig.runner.listener import Listener
from smarig.runner.own_files import check_drivers, check_given
from smarig.runner.preview import Preview, preview
from smarig.runner.replay import replay, stretches
from smarig.runner.resumption import COLD_TAUS, RE_ESTABLISH, Now, Plan, planned
from smarig.runner.session import Session, check_free_space


def session_for(
    run: Run, *, rig: str = "", wire: str = "", speed: float | None = None, control: Control | None = None
) -> Session:
    """A sitting at the rig of a run, not yet opened; refuses runs that are done and rigs that are others."""
    begun = begun_with(run)
    name = rig or str(begun["rig"])
    file = load_rig(name)
    check_rig(run, file)
    if not rig:
        check_drivers(file, run.path.name, f"to have it executed, say so with --rig {name}")
    of_run = str(run.meta.get("wire"))
    given = of_run if of_run != begun["rig_wire"] else file.wire  # named when it began, or the rig file's
    if (wire or given) != of_run:
        raise UsageError(
            f"{run.path.name} is of wire '{of_run}', not of '{wire or given}': it cannot go on there."
        )
    with _understood(run):
        seed, noise = int(run.meta.get("seed") or 0), bool(begun["noise"])
        twin = TwinSettings(seed, noise, effects=from_pairs(begun["effects"]))
    return Session(name, twin=twin, speed=speed or begun["speed"], wire=of_run, control=control)


def resume(
    path: str | Path,
    *,
    rig: str = "",
    wire: str = "",
    control: Control | None = None,
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
) -> Plan:
    """Go on with a run in an open session; returns how. Raises what ended it, after closing it.

    Nothing is moved or written before it is known that the protocol agrees with the record.
    """
    run = load_run(run.path)  # now that the wire is ours: it may have ended by itself meanwhile
    begun = begun_with(run)
    protocol, settings = str(run.meta["protocol"]), begun["settings"]
    fresh = session.source == "twin" and session.rig.tick == 0
    now = Now(session.device, session.rig.tick, fresh, session.initial)
    with _understood(run):
        replayed = replay(build(protocol, session.setup, settings, chooser), run)
        plan = planned(run, replayed, session.setup, now)
        going = _Going(session, run, plan, listeners, _interrupted(run, plan))
    cost = expected or preview(protocol, session.file, settings, session.control, chooser)
    check_free_space(run.path, cost.bytes)
    anew = build(protocol, session.setup, settings, chooser) if plan.start_over else replayed.rest()
    going.on(anew)
    return plan


@contextmanager
def _understood(run: Run) -> Iterator[None]:
    """What cannot be made sense of in a record is that record's fault."""
    try:
        yield
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
        raise DataError(
            f"{run.path.name} cannot be gone on with: its record is damaged ({type(error).__name__}: {error})."
        ) from None


@dataclass(frozen=True)
class _Going:
    """One resumption being carried out."""

    session: Session
    run: Run
    plan: Plan
    listeners: Sequence[Listener]
    interrupted: list[tuple]

    def on(self, rest: Protocol) -> None:
        """Write the interruption down, clear trips, find the way back, and go on."""
        session, run, plan = self.session, self.run, self.plan
        session.guard.arm()
        session.count_unkept(run)
        first = 1 + max((*stretches(run), *(s.index for s in run.steps)), default=-1)
        change = GoingOn(tuple(self.interrupted), plan.start_over)
        recorder = Recorder(run.path, self._meta(), going_on=change, clock=session.clock())
        record = _Attempts(recorder, _attempts(run, plan, self.interrupted))
        runner = session.runner([record, *self.listeners], plan.shift)
        runner.steps_done = first
        self._tell(recorder, runner.t_s, first)
        began = session.rig.tick + plan.shift.ticks + 1

        def met(result: StepResult) -> None:
            """The wire is where the reference was: what the counts differ by is the zero that was lost."""
            if plan.reference is None or plan.reference.position is None:
                return
            per_count = session.rig.position_per_count
            lost = plan.reference.position / per_count - result.counts
            counts = round(lost)
            plan.shift.counts += counts
            recorder.shift((began, session.rig.tick + plan.shift.ticks), first, counts, per_count)
            recorder.describe("shift", asdict(plan.shift))
            recorder.describe("device", session.device)
            text = (
                f"The encoder's zero was met again in the state of step {plan.reference.index}: {counts:+d} counts are "
                "added from here on, and were to the way back until now."
            )
            recorder.event(result.t_end_s, "shift", text, counts=counts, found=lost)

        done = plan.replayed.pending is None and not plan.start_over
        whole = rest if done else _whole(plan, rest, session.setup.tau_s, met)
        session.carry_out(recorder, runner, whole, new_run="history_until_tick" not in run.meta)

    def _meta(self) -> dict[str, Any]:
        """Keys of the run table that are others from now on."""
        known = self.plan.reference is None  # until its zero is met again, a device is nobody's
        device = self.session.device if known else ""
        now: dict[str, Any] = {"device": device, "shift": asdict(self.plan.shift)}
        if self.plan.start_over:
            now["initial"] = self.session.initial
        return now

    def _tell(self, recorder: Recorder, t_s: float, first: int) -> None:
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


def _whole(plan: Plan, rest: Protocol, tau_s: float, met: Any) -> Protocol:
    """The way back, and on from there."""
    try:
        yield Hold(0.0, Elapsed(COLD_TAUS * tau_s), branch=RE_ESTABLISH)
        result = yield Hold(0.0, plan.settle, branch=RE_ESTABLISH)
        currents = plan.currents_A
        if plan.begins_cold:
            met(result)
            currents = currents[1:]
        for k, current_A in enumerate(currents):
            result = yield Hold(current_A, plan.settle, branch=RE_ESTABLISH)
            if k == 0 and not plan.begins_cold:
                met(result)
        yield from rest
    finally:
        rest.close()


# --- what was interrupted ------------------------------------------------------------------------------------


def _interrupted(run: Run, plan: Plan) -> list[tuple]:
    """Rows of steps that have samples but no row: nobody was left to write it. They have no settled position."""
    known = {s.index for s in run.steps}
    pending = plan.replayed.pending
    rows = []
    for index, where in stretches(run).items():
        if index in known:
            continue
        t_s = run["t_s"][where]
        begin_s, end_s = float(t_s[0]) - float(run.meta.get("period_s") or 0.0), float(t_s[-1])
        on_the_way = _on_the_way(run, index)
        branch = (
            RE_ESTABLISH if on_the_way else pending.branch if isinstance(pending, Hold | Waveform) else ""
        )
        target = pending.target if isinstance(pending, Hold) and not on_the_way else None
        attempt = 0 if on_the_way else _tried(run)
        rows.append((index, attempt, 1, branch, target, begin_s, end_s, "interrupted", None, t_s.size))
    return rows


def _on_the_way(run: Run, index: int) -> bool:
    """Whether a step belonged to an earlier way back."""
    backs = [(int(e.data["first_step"]), int(e.data["holds"])) for e in run.events if e.kind == "resumed"]
    return any(first <= index < first + holds for first, holds in backs)


def _tried(run: Run) -> int:
    """How often the step after the last valid one has been tried."""
    last = max((s.index for s in run.steps if not s.void), default=-1)
    after = [s for s in run.steps if s.index > last and s.branch != RE_ESTABLISH]
    return 1 + max((s.attempt for s in after), default=-1)


def _attempts(run: Run, plan: Plan, interrupted: list[tuple]) -> dict[int, int]:
    """By number of a step in its protocol: which attempt it will be, where not the first."""
    valid = [s for s in run.steps if not s.void]
    again = _tried(run) + any(row[3] != RE_ESTABLISH for row in interrupted)
    before = {k: s.attempt + 1 for k, s in enumerate(valid)} if plan.start_over else {}
    return {**before, len(valid): again} if plan.start_over else {0: again}


class _Attempts:
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


def begun_with(run: Run) -> dict[str, Any]:
    """What a run was begun with; a sentence where it is no run that can be gone on with."""
    name = run.path.name
    if run.cause == "done":
        raise UsageError(f"{name} is done: there is nothing to go on with.")
    if run.meta.get(CLOSED_LOOP):
        raise UsageError(
            f"{name} was a closed loop: it is not gone on with, but closed anew on a prepared wire."
        )
    begun = run.meta.get(BEGUN_WITH)
    wanted = {"rig", "rig_wire", "speed", "effects", "noise", "settings"}
    if run.meta.get("source") == "simulation" or not isinstance(begun, dict) or not wanted <= set(begun):
        raise DataError(
            f"{name} does not say what it was begun with: only runs that this smarig records on a rig or a "
            "twin can be gone on with."
        )
    if begun["effects"] is None:
        raise DataError(f"{name} was run with effects of its own making: they are not in its record.")
    check_given(run)
    return begun


def check_rig(run: Run, file: RigFile) -> None:
    """UsageError where a run was made on another rig."""
    for what, then, now in (
        ("rig", run.meta.get("rig"), file.name),
        ("actuator", run.meta.get("actuator"), Actuator.named(file.actuator).name),
        ("period_s", run.meta.get("period_s"), file.period_s),
    ):
        if then != now:
            raise UsageError(
                f"{run.path.name} was run on {what} '{then}', not on '{now}': it cannot go on there."
            )
