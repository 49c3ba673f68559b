"""A session at one rig: opened and locked once, with protocols run and recorded in order.

The wire's memory, the device's ticks and the encoder's zero continue from run to run. Every run file is closed with
its cause.
"""

import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import asdict
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from smarig.config import RigFile, actuator_text, load_rig, rig_text, shipped_names, with_load
from smarig.core import (
    Interrupted,
    Protocol,
    Requester,
    Sample,
    SmarigError,
    UsageError,
    at_forced_end,
    in_time,
    passed,
    resolve_name,
)
from smarig.plant import Actuator, load_of
from smarig.protocols import PROTOCOLS, Chooser, Setup, build_protocol
from smarig.record import (
    CONTINUED,
    ClockWatch,
    LastHeat,
    Recorder,
    Run,
    StoppedBy,
    Wear,
    WireHistory,
    load_wire_history,
    recording,
)
from smarig.rig import (
    Bench,
    Guard,
    Plausibility,
    Rig,
    RigReadings,
    RoomTemperature,
    TwinSettings,
    limits_in_force,
    open_rig,
    stress_limit,
    without_lease_text,
)
from smarig.runner.absolute_zero import zero_data, zero_of_session
from smarig.runner.end_severity import end_severity
from smarig.runner.listener import CallbackListener, Listener
from smarig.runner.lock import rig_locks
from smarig.runner.own_files import OWN_FILES, resume_command, used_own_files
from smarig.runner.preview import Preview, ProtocolFactory, preview
from smarig.runner.restart_shift import Shift
from smarig.runner.rig_description import rig_description
from smarig.runner.run_control import RunControl
from smarig.runner.run_metadata import (
    CLOSED_LOOP,
    LAUNCH_ARGS,
    cause_of,
    experiment_metadata,
    launch_args,
    load_metadata,
    measured_load,
    outlives_session,
    twin_source,
)
from smarig.runner.runner import Runner
from smarig.runner.signal_handling import stop_on_signals
from smarig.runner.start_checks import check_cycle_limit, check_free_space
from smarig.runner.wire_heat import elapsed_s, heat_at_the_end, heat_left, not_written, wear_from


class Session:
    """``with Session("one_wire_twin", seed=1) as s: s.run("validation", {}, Path("v.run.sqlite"))``."""

    def __init__(
        self,
        rig: str,
        *,
        seed: int = 0,
        twin: TwinSettings | None = None,
        speed: float | None = None,
        wire: str = "",
        control: RunControl | None = None,
        load: str = "",
    ) -> None:
        """``load``: force in N, formula of t or CSV file, in place of the rig file's."""
        rig = passed(rig, shipped_names("rigs"))
        file = load_rig(rig)
        self.file: RigFile = with_load(file, load) if load else file
        self._given_load = self.file.load.text if load and self.file.load else ""
        self._name = rig
        self.actuator = Actuator.named(self.file.actuator)
        self.load = load_of(self.file, self.actuator)
        self.description = rig_description(
            rig_text(rig), actuator_text(self.file.actuator), self.file, self.actuator.file
        )
        self.wire = wire or self.file.wire
        self.settings = twin or TwinSettings(seed=seed)
        self._speed = speed
        self.control = control or RunControl()
        self._zero = "power-up"
        self._stopped_run: Path | None = None
        self._last: Sample | None = None
        self._epoch = time.time()
        self.wear = self.new_wear()
        self.no_lease = ""  # what it means that the source has no lease; "" if it has one
        self._open = ExitStack()

    def __enter__(self) -> Self:
        try:
            if self.settings.hysteresis is None:  # a model replaces the hardware
                self._open.enter_context(rig_locks(self.file, self.wire))
            self._open.enter_context(stop_on_signals(self.control))
            self.rig: Rig = self._open.enter_context(
                open_rig(
                    self._name,
                    self.file,
                    self.actuator,
                    self.settings,
                    speed=self._speed,
                    while_waiting=self.control.raise_if_stopped,
                )
            )
        except BaseException:
            self._open.close()
            raise
        if not self.has_lease:
            self._lower_limits()
        self.guard = Guard(
            self.rig,
            self.file.limits,
            self.actuator,
            Plausibility(self.file, self.actuator, self._readings()),
            stress_limit(self.file, self.actuator),
            RoomTemperature(self.file),
        )
        self._zero = zero_of_session(self.guard.absolute_zero)
        with suppress(SmarigError):  # a damaged history: a run reports it
            history = self.history()
            self.start_hot(history.heat if history else None)
        return self

    def start_hot(self, last: LastHeat | None) -> None:
        """Start the heating model where the wires may be, from what is last known of them. A new twin's are cold."""
        if last is None or not outlives_session(self.file):
            return
        since_s = elapsed_s(last, self.device, self.rig.tick, self.file.period_s, twin=self.source == "twin")
        self.guard.start_hot(heat_left(last, self.actuator, since_s, has_lease=self.has_lease))
        self.wear = self.new_wear(self.guard.input_K)

    def _readings(self) -> RigReadings:
        counter = not getattr(self.rig, "timed_by_host", False)
        absolute = getattr(self.rig, "absolute_zero", None) is not None
        return RigReadings(self.settings.hysteresis is None, self.settings.noise, counter, absolute)

    @property
    def on_own_rig_file(self) -> bool:
        """Whether the rig is a file of the user's, which must be named again to resume a run."""
        return self._name not in shipped_names("rigs")

    def resume_command(self, run: Path) -> str:
        """The command that resumes a run of this session; it names a rig file, because no record may."""
        return resume_command(run, self._name if self.on_own_rig_file else "")

    @property
    def setup(self) -> Setup:
        """Actuator, limits in force and tick, for a protocol."""
        return Setup(self.actuator, self.file.limits, self.file.period_s)

    @property
    def has_lease(self) -> bool:
        """Whether the current source switches itself off when the host stops communicating; a twin does."""
        return bool(getattr(self.rig, "has_lease", True))

    def _lower_limits(self) -> None:
        """Take the limits of a rig without a lease, for everything that follows."""
        self.no_lease = without_lease_text(self.file, self.actuator)
        limits = limits_in_force(self.file.limits, self.actuator, has_lease=False)
        self.file = self.file.model_copy(update={"limits": limits})

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self._open.__exit__(kind, error, trace)
        except Interrupted as stopped:  # in place of a KeyboardInterrupt
            self._add_remedy(stopped)
            raise
        self._add_remedy(error)

    def _add_remedy(self, error: BaseException | None) -> None:
        """Say how to continue the run that was stopped."""
        if isinstance(error, Interrupted) and self._stopped_run is not None:
            error.remedy = f"{self.resume_command(self._stopped_run)} continues it."

    def run(
        self,
        protocol: str,
        settings: Mapping[str, Any],
        out: str | Path,
        *,
        listeners: Sequence[Listener] = (),
        force: bool = False,
        notes: str = "",
        expected: Preview | None = None,
        chooser: Chooser | None = None,
        protocol_factory: ProtocolFactory | None = None,
    ) -> Path:
        """Run one protocol, by name or by the path of an own file, into one run file. Returns its path.

        Closes the run before it raises the error that ended it. ``expected``: its preview, if already made.
        ``chooser``: for protocols that take one. ``protocol_factory`` makes a closed loop, whose protocol is not in
        the catalogue; ``protocol`` is its name in the record.
        """
        out, protocol = Path(out), protocol if protocol_factory else resolve_name(PROTOCOLS, protocol)
        with self._lower_limits_explained():
            generator = (
                protocol_factory(self.setup)
                if protocol_factory
                else build_protocol(protocol, self.setup, settings, chooser)
            )
            cost = expected
            if self.no_lease and cost and cost.peak_current_A > 0:  # it was made for the limits of the file
                cost = None
            cost = cost or preview(protocol, self.file, settings, self.control, chooser, protocol_factory)
        check_free_space(out, cost.bytes)
        before = self.history()
        check_cycle_limit(before, self.file.limits)
        start_s = self.rig.tick * self.file.period_s
        meta = self._describe(protocol, settings, notes)
        meta |= load_metadata(self.load, (start_s, start_s + cost.duration_s))
        meta |= {CLOSED_LOOP: True} if protocol_factory else {}
        if before is not None:
            meta["wire_history"] = before.sentence()
        with ExitStack() as held:
            with self.control.undisturbed():
                held.enter_context(recording(out))
                recorder = Recorder(out, meta, force=force, clock=self.clock())
            runner = self.runner([recorder, *listeners])
            data = self.moment() | zero_data(self.guard.absolute_zero)
            recorder.event(runner.t_s, "start", f"Run of {protocol} started.", **data)
            if self.no_lease:
                for listener in runner.listeners:
                    listener.event(runner.t_s, "no_lease", self.no_lease, level="warning")
            self.carry_out(recorder, runner, generator, new_run=True)
        return out

    @contextmanager
    def _lower_limits_explained(self) -> Iterator[None]:
        """A refusal that names a limit says why it is not that of the rig file."""
        try:
            yield
        except UsageError as refused:
            if not self.no_lease or type(refused) is not UsageError:
                raise
            raise UsageError(f"{refused} {self.no_lease}") from None

    def runner(self, listeners: Sequence[Listener], shift: Shift | None = None) -> Runner:
        """A runner that continues after the device's last tick, shifted by ``shift``."""
        watch = CallbackListener(on_event=self._note_zero, on_sample=self._count_wear)
        runner = Runner(self.guard, self.rig.position_per_count, [*listeners, watch], self.control)
        runner.shift = shift or Shift()
        runner.t_s = (self.rig.tick + runner.shift.ticks) * self.file.period_s
        return runner

    def carry_out(self, recorder: Recorder, runner: Runner, protocol: Protocol, *, new_run: bool) -> None:
        """Run to the end, however it ends, and close the record with its cause."""
        with at_forced_end(recorder.on_disk, f"What run {recorder.path} holds is not known."):
            self._carry_out(recorder, runner, protocol, new_run)
            recorder.check_in_place()

    def _carry_out(self, recorder: Recorder, runner: Runner, protocol: Protocol, new_run: bool) -> None:
        cause, severity, stopped_by, start_s = "done", end_severity(None), None, runner.t_s
        if (force := getattr(self.rig, "force", None)) is not None:
            force.reset()
        try:
            runner.run(protocol)
        except BaseException as error:
            cause, severity, stopped_by = cause_of(error), end_severity(error), self._requester(error)
            if isinstance(error, Interrupted | KeyboardInterrupt):
                self._stopped_run = recorder.path
            raise
        finally:
            with self.control.undisturbed():
                recorder.describe("encoder_zero", self._zero)
                recorder.describe("shift", asdict(runner.shift))
                if self.load and self.load.changes and new_run:
                    self._describe_load(recorder, runner, start_s)
                self._describe_force(recorder)
                self._save_history(recorder, runner, new_run)
                recorder.close(cause, t_s=runner.t_s, severity=severity, stopped_by=stopped_by)

    def _requester(self, error: BaseException) -> StoppedBy | None:
        """Who asked for this end; None for a run that ended by itself, though somebody may have asked as well."""
        if not isinstance(error, Interrupted | KeyboardInterrupt):
            return None
        return StoppedBy.this_account(self.control.stopped_by or Requester.USER)

    def _describe_load(self, recorder: Recorder, runner: Runner, start_s: float) -> None:
        """The load between the first and the last sample. One that is not plausible has ended the run itself."""
        with suppress(SmarigError):
            found = load_metadata(self.load, (start_s, max(runner.t_s, start_s)))
            recorder.describe("conditions", found["conditions"])

    def _describe_force(self, recorder: Recorder) -> None:
        """The load that a load cell has measured replaces the one that the files state."""
        force = getattr(self.rig, "force", None)
        if force is not None and force.n:
            recorder.describe("conditions", measured_load(force, self.actuator))

    def moment(self) -> dict[str, Any]:
        """Data of the event at which a recording begins: the time of day, and the predicted heat of both wires."""
        return {"epoch": time.time(), "wire_K": list(self.guard.heating.wire_K)}

    def clock(self) -> ClockWatch:
        """The clock comparison for recorders; the seconds of hardware are host seconds."""
        return ClockWatch(real_time=self.source == "bench")

    def history(self) -> WireHistory | None:
        """The history of the wire; None if it does not outlive the session: twins and simulations."""
        if self.source == "simulation" or not outlives_session(self.file):
            return None
        twin = self.source == "twin"
        with self.control.undisturbed():
            return in_time(
                lambda: load_wire_history(self.wire, twin=twin), f"The history of wire '{self.wire}'"
            )

    def _count_wear(self, s: Sample, _step: int | None, input_K: float) -> None:
        self.wear.add(s.tick, input_K)
        self._last = s

    def _save_history(self, recorder: Recorder, runner: Runner, new_run: bool) -> None:
        """Add the wear of the run to the wire's history. A failure to write is told and recorded, and ends nothing."""
        wear, self.wear = self.wear, self.new_wear()
        try:
            history = self.history()
            if history is not None:
                history = history.after(wear, new_run=new_run, heat=self._heat())
                in_time(history.save, f"The history of wire '{self.wire}'")
                if wear.last_tick:
                    recorder.describe("history_until_tick", wear.last_tick)
        except SmarigError as error:
            for listener in runner.listeners:
                listener.event(runner.t_s, "history", not_written(error), level="warning")

    def _heat(self) -> LastHeat | None:
        """The heat of the wires at the end of a run; None if their devices end with the session."""
        if not outlives_session(self.file):
            return None
        unconfirmed = self._last if self.rig.shutdown_unconfirmed else None
        return heat_at_the_end(self.guard, self.device, unconfirmed, self.file.lease_s)

    def count_unsaved_wear(self, run: Run) -> None:
        """Start with the wear that a killed process did not add to the wire's history."""
        kept = run.info.history_until_tick or 0
        for tick, input_K in zip(run["tick"].tolist(), run["input"].tolist()):
            if tick > kept:
                self.wear.add(int(tick), input_K)

    def new_wear(self, input_K: float = 0.0) -> Wear:
        """Wear of zero, from an input on."""
        return wear_from(self.setup, input_K)

    def _note_zero(self, kind: str, t_s: float) -> None:
        if kind == "zero":
            self._zero = f"zeroed at {t_s:g} s"

    @property
    def source(self) -> str:
        """The source of the data: "bench", "twin" or "simulation"."""
        return twin_source(self.file, self.settings)

    @property
    def device(self) -> str:
        """Identifies the ticks and the encoder's zero: the same text means the same device since the same boot."""
        sensor = getattr(self.rig, "sensor", None)
        session_part = "" if outlives_session(self.file) else f"session of {self._epoch}"
        return " ".join(part for part in (sensor.identity if sensor else "", session_part) if part)

    @property
    def initial(self) -> str:
        """The present state of the wire as far as it is known."""
        return self.actuator.file.hysteresis.initial if self.rig.tick == 0 else CONTINUED

    def _describe(self, protocol: str, settings: Mapping[str, Any], notes: str) -> dict[str, Any]:
        per_count = self.rig.position_per_count
        return experiment_metadata(self.actuator, self.settings, per_count, protocol, settings) | {
            "rig": self.file.name,
            "wire": self.wire,
            "source": self.source,
            "start_epoch": self._epoch,
            "period_s": self.file.period_s,
            "initial": self.initial,
            "encoder_zero": self._zero,
            **self.description,
            "notes": notes,
            "device": self.device,
            **({"instruments": self.rig.identity()} if isinstance(self.rig, Bench) else {}),
            **({"ambient_from": "rig file"} if not getattr(self.rig, "measures_ambient", True) else {}),
            "has_lease": self.has_lease,
            OWN_FILES: used_own_files(
                protocol, self.settings.effects, self.file, str(settings.get("controller", ""))
            ),
            LAUNCH_ARGS: launch_args(
                self._name, self.file.wire, self._speed, self.settings, settings, self._given_load
            ),
        }
