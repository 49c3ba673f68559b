"""Executes a protocol's commands on a guarded rig, one tick at a time, and calls the listeners.

Protocols meet rigs only here. The runner calls ``safe()`` of the rig however a protocol ends.
"""

import math
from collections.abc import Sequence

from smarig.core import (
    Command,
    Drive,
    Elapsed,
    Hold,
    Interrupted,
    Mark,
    Protocol,
    Quality,
    RigFault,
    Sample,
    Settled,
    SmarigError,
    StepResult,
    StepVerdict,
    Waveform,
    Zero,
    error_text,
    own_file_error,
)
from smarig.rig import Guard, after_shutdown, switch_off
from smarig.runner.absolute_zero import zero_data
from smarig.runner.checked_generator import CheckedGenerator
from smarig.runner.listener import Listener, StepStartListener, SuspectListener
from smarig.runner.restart_shift import Shift
from smarig.runner.run_control import RunControl
from smarig.runner.settling_detection import Approach, SettleWindow

_SUSPECT = int(Quality.SUSPECT)
BACKLOG = 2000  # samples of an earlier current that a ring may still contain


class Runner:
    """Runs protocols in order on one rig; step numbers and time continue between them."""

    def __init__(
        self,
        rig: Guard,
        position_per_count: float,
        listeners: Sequence[Listener],
        control: RunControl | None = None,
    ) -> None:
        self.rig, self.listeners = rig, listeners
        self.control = control or RunControl()
        self.position_per_count = position_per_count
        self.steps_done = 0
        self.t_s = 0.0
        self.shift = Shift()
        self._step: int | None = None
        self._last: Sample | None = None
        self._stale_samples = 0
        self._was_paused = False

    def run(self, protocol: Protocol) -> None:
        """Execute a protocol to its end. The rig is safe afterwards in every case."""
        checked_generator = CheckedGenerator(protocol, self.control)
        fault: SmarigError | None = None
        try:
            answer: StepResult | Sample | None = None
            while (command := checked_generator.next(answer)) is not None:
                answer = self._carry_out(command)
        except (Interrupted, KeyboardInterrupt):  # claims nothing about the current
            raise
        except SmarigError as error:
            fault = error
            raise
        except BaseException as error:  # SystemExit of a library, too, which would end the process in silence
            sentence = own_file_error(error, "smarig.device.drivers")
            if not sentence and isinstance(error, Exception):
                raise
            fault = RigFault(sentence or f"The run was ended by {error_text(error)}.").at_zero()
            raise fault from error
        finally:
            try:
                self._switch_off(fault)
            finally:
                checked_generator.close()

    def _switch_off(self, fault: SmarigError | None) -> None:
        """Set the current to zero. One that may flow on is reported, and ``fault`` does not deny it."""
        reported: list[str] = []

        def report(unconfirmed: str) -> None:
            reported.append(unconfirmed)
            self._notify("still_on", unconfirmed, level="error")

        with self.control.undisturbed():
            if switch_off(self.rig, report=report):
                if fault is not None:
                    after_shutdown(fault, self.rig)
            elif reported:
                self._notify("off", "The source has now confirmed that it is off.", level="warning")

    def _carry_out(self, command: Command) -> StepResult | Sample | None:
        match command:
            case Hold():
                return self._hold(command)
            case Waveform():
                return self._waveform(command)
            case Drive(current_A):
                self._tick(current_A, None)
                while self._paused():
                    self._tick(current_A, None)
                return self._last
            case Zero():
                self.rig.zero()
                self.shift.counts = 0
                self._notify("zero", "Encoder zeroed.", **zero_data(self.rig.absolute_zero))
            case Mark(label, data):
                self._notify("mark", label, **data)
        return None

    def _hold(self, command: Hold) -> StepResult:
        window = SettleWindow(command.until, self.rig.period_s)
        match command.until:
            case Elapsed(seconds):
                limit_s, approach_K, at_limit = seconds, math.inf, StepVerdict.ELAPSED
            case Settled(timeout_s=timeout_s, approach_K=approach_K):
                limit_s, at_limit = timeout_s, StepVerdict.TIMED_OUT
        limit = max(1, round(limit_s / self.rig.period_s))
        start_s, ticks = self.t_s, 0
        approach = Approach(
            self.rig.steady_input_K(command.current_A) - self.rig.input_K, approach_K, self.rig.heating.decay
        )
        self._begin(command, window)
        while (paused := self._paused()) or (ticks < limit and not window.settled):
            at_most = 1 if paused else min(limit - ticks, window.min_ticks_left)
            got = self._tick(command.current_A, window, approach, at_most)
            ticks += 0 if paused else got
        verdict = StepVerdict.SETTLED if window.settled else at_limit
        return self._finish(window, verdict, start_s, command.branch, command.target)

    def _waveform(self, command: Waveform) -> StepResult:
        per_tick = self.rig.period_s / command.period_s
        ticks = max(1, round(len(command.currents_A) / per_tick))
        window = SettleWindow(Elapsed(ticks * self.rig.period_s), self.rig.period_s)
        start_s = self.t_s
        self._begin(command, window)
        last = len(command.currents_A) - 1
        for k in range(ticks):
            current_A = command.currents_A[min(int(k * per_tick + 1e-9), last)]
            self._tick(current_A, window)
            while self._paused():
                self._tick(current_A, window)
        return self._finish(window, StepVerdict.ELAPSED, start_s, command.branch, None)

    def _begin(self, command: Hold | Waveform, window: SettleWindow) -> None:
        self._step = self.steps_done
        for listener in self.listeners:
            if isinstance(listener, StepStartListener):
                listener.begin(self._step, command, window)

    def _paused(self) -> bool:
        """Whether the operator has paused the run; changes are recorded as events."""
        if self.control.paused != self._was_paused:
            self._was_paused = self.control.paused
            if self._was_paused:
                self._notify("paused", "Paused by the operator: the current stays and sampling continues.")
            else:
                self._notify("unpaused", "Continued by the operator.")
        return self._was_paused

    def _finish(
        self, window: SettleWindow, verdict: StepVerdict, start_s: float, branch: str, target: float | None
    ) -> StepResult:
        mean, sd, n = window.statistics()
        position = mean * self.position_per_count
        result = StepResult(
            index=self.steps_done,
            verdict=verdict,
            position=position,
            counts=mean,
            counts_sd=sd,
            n=n,
            t_start_s=start_s,
            t_end_s=self.t_s,
        )
        for listener in self.listeners:
            listener.step(result, branch=branch, target=target)
        self.steps_done += 1
        self._step = None
        return result

    def _tick(
        self,
        current_A: float,
        window: SettleWindow | None,
        approach: Approach | None = None,
        at_most: int = 1,
    ) -> int:
        """Step the rig. Returns the number of samples at this current, without those of the previous one."""
        self.control.raise_if_stopped()
        counted = 0
        for measured, input_K in self.rig.step(current_A, at_most):
            sample = self.shift.apply(measured, self.rig.period_s, self.position_per_count)
            self.t_s, self._last = sample.t_s, sample
            is_current = sample.current_command_A == current_A or self._stale_samples >= BACKLOG
            self._stale_samples = 0 if is_current else self._stale_samples + 1
            counted += is_current
            heated = approach is None or (is_current and approach.passed())
            if window is not None and is_current and not sample.quality & _SUSPECT:
                window.add(sample.counts, heated)
            for listener in self.listeners:
                listener.sample(sample, self._step, input_K)
        for alarm in self.rig.alarms():
            self._notify(alarm.kind, alarm.text, level=alarm.level)
            if alarm.level == "error" and alarm.doubtful_from is not None:
                self._suspect((alarm.doubtful_from + self.shift.ticks) * self.rig.period_s)
        for kind, text, level in self.control.reports():
            self._notify(kind, text, level=level)
        self.rig.raise_if_tripped()
        return counted

    def _suspect(self, from_s: float) -> None:
        """Nobody knows when a fault began that only shows now."""
        if from_s < self.t_s:
            text = f"The readings since {from_s:.1f} s contradict each other: steps that settled since are suspect."
            self._notify("suspect", text, level="warning", since_s=from_s)
        for listener in self.listeners:
            if isinstance(listener, SuspectListener):
                listener.suspect(from_s)

    def _notify(self, kind: str, text: str, **data) -> None:
        for listener in self.listeners:
            listener.event(self.t_s, kind, text, **data)
