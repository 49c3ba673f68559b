"""A run whose steps come from outside, one after the other: from a notebook, a scan, another program's plan.

The rig keeps ticking in a thread of its own, with the guard, the record and the endings of every other run:

    with SteppedRun("bench_one_wire", "scan.run.sqlite") as run:
        for input_K in (20, 40, 60, 40, 20):
            print(run.hold_input(input_K).result().position)

Between steps the last current stays on. On a twin without ``speed`` time passes during holds only.
"""

import atexit
import queue
import threading
from collections.abc import Generator
from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeoutError
from numbers import Real
from pathlib import Path
from types import TracebackType
from typing import NamedTuple, Self

from smarig.core import (
    Command,
    Drive,
    Hold,
    Interrupted,
    LimitExceeded,
    RigFault,
    Sample,
    Settled,
    SmarigError,
    StepResult,
    UsageError,
)
from smarig.protocols import Setup
from smarig.rig import TwinSettings, outside_limits_text
from smarig.runner import CallbackListener, Preview, RunControl, Session

PROTOCOL = "stepped"  # name of these runs in their records
ABOUT_BYTES = 20_000_000  # free space that a start asks for: the length of a run is not known
START_TIMEOUT_S = 120.0  # for a rig to be opened
_ROUNDING_A = 1e-9


class _Step(NamedTuple):
    current_A: float
    target_K: float | None
    done: "Future[StepResult]"


class SteppedRun:
    """``settle``: when a hold ends; ``speed`` × real time for twins. Use it as a context, or ``start`` and ``stop``."""

    def __init__(
        self,
        rig: str,
        out: str | Path,
        *,
        settle: Settled | None = None,
        twin: TwinSettings | None = None,
        speed: float | None = None,
        wire: str = "",
        notes: str = "",
        force: bool = False,
    ) -> None:
        self.out, self._settle, self._notes, self._force = Path(out), settle or Settled(), notes, force
        self._control = RunControl()
        self.session = Session(rig, twin=twin, speed=speed, wire=wire, control=self._control)
        self._time_stops = self.session.file.kind == "twin" and speed is None
        self._steps: queue.Queue[_Step | None] = queue.Queue()
        self._thread = threading.Thread(target=self._run, name="stepped run", daemon=True)
        self._ready: Future[None] = Future()
        self._error: BaseException | None = None
        self._waiting: _Step | None = None  # being executed
        self.latest: Sample | None = None
        self.input_K = 0.0

    def start(self) -> None:
        """Open the rig. Raises what the rig or the record raises."""
        if self._thread.ident is not None:
            raise UsageError("This run was started before. Make another SteppedRun.")
        atexit.register(self._end_at_exit)
        self._thread.start()
        try:
            self._ready.result(START_TIMEOUT_S)
        except FutureTimeoutError:
            self._control.stop("the rig was not opened in time")
            raise RigFault(f"The rig did not open within {START_TIMEOUT_S:g} s.") from None

    def hold(self, current_A: float) -> "Future[StepResult]":
        """Hold a current until the position has settled; steps are executed in order.

        Raises LimitExceeded if the limits forbid the current, UsageError if the run is over.
        """
        return self._put(current_A, None)

    def hold_input(self, input_K: float) -> "Future[StepResult]":
        """Hold the steady current of a temperature above ambient (T₁ − T₂ for two wires)."""
        setup = self.session.setup
        if isinstance(input_K, bool) or not isinstance(input_K, Real):
            raise UsageError(f"An input is a number in K, not {input_K!r}.")
        if not setup.lower_K - _ROUNDING_A <= input_K <= setup.upper_K + _ROUNDING_A:
            raise LimitExceeded(
                f"{input_K:g} K is outside the rig's range {setup.lower_K:g}…{setup.upper_K:g} K above ambient."
            )
        return self._put(setup.current_for(input_K), input_K)

    def stop(self, cause: str = "") -> None:
        """End the run: after the steps that were given, or at once with a ``cause``. The current is at zero.

        Raises the error that ended the run, if one did.
        """
        if cause:
            self._control.stop(cause)
        self._steps.put(None)
        if self._thread.ident is not None:
            self._thread.join()
        atexit.unregister(self._end_at_exit)
        if self._error is not None and not cause:
            raise self._error

    @property
    def running(self) -> bool:
        """Whether steps can be given."""
        return self._thread.is_alive() and self._ready.done()

    @property
    def busy(self) -> bool:
        """Whether steps are waiting or being executed."""
        return self._waiting is not None or not self._steps.empty()

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop("" if error is None else f"stopped by {type(error).__name__} in the calling program")

    def _put(self, current_A: float, target_K: float | None) -> "Future[StepResult]":
        if not self.running:
            if self._error is not None and not isinstance(self._error, Interrupted):
                raise self._error
            if self._thread.ident is None:
                raise UsageError("The run was not started. Use it in a with block, or call start().")
            raise UsageError(f"The run is over{f': {self._error}' if self._error else ''}.")
        limits = self.session.guard.limits
        if isinstance(current_A, bool) or not isinstance(current_A, Real):
            raise UsageError(f"A current is a number in A, not {current_A!r}.")
        if not limits.current_min_A - _ROUNDING_A <= current_A <= limits.current_max_A + _ROUNDING_A:
            raise LimitExceeded(outside_limits_text(current_A, limits))
        step = _Step(float(current_A), target_K, Future())
        self._steps.put(step)
        if not self._thread.is_alive():  # it ended meanwhile, and may have emptied the queue before
            self._fail_waiting()
        return step.done

    def _end_at_exit(self) -> None:
        """A program that ends without ``stop`` leaves the current at zero and a closed record."""
        if self._thread.is_alive():
            self._control.stop("the calling program ended")
            self._steps.put(None)
            self._thread.join()

    def _run(self) -> None:
        """The thread: open the rig, execute the steps, and end like every run."""
        try:
            with self.session:
                self.session.run(
                    PROTOCOL,
                    {},
                    self.out,
                    listeners=[CallbackListener(on_sample=self._note)],
                    force=self._force,
                    notes=self._notes,
                    expected=Preview(PROTOCOL, 0.0, 0, 0.0, 0.0, 0, ABOUT_BYTES),
                    protocol_factory=self._commands,
                )
        except BaseException as error:  # also Interrupted, which is none of the errors
            self._error = error
        finally:
            self._fail_waiting()

    def _note(self, sample: Sample, _step: int | None, input_K: float) -> None:
        self.latest, self.input_K = sample, input_K

    def _commands(self, setup: Setup) -> Generator[Command, StepResult | Sample | None, None]:
        """The protocol: holds as they come, and the present current in between."""
        now_A = 0.0
        largest_A = setup.limits.current_rate_A_per_s * setup.period_s
        yield Drive(now_A)
        self._ready.set_result(None)
        while (step := self._next()) is not None:
            if isinstance(step, Drive):
                yield Drive(now_A)
                continue
            while abs(step.current_A - now_A) > largest_A:
                now_A += largest_A if step.current_A > now_A else -largest_A
                yield Drive(now_A)
            now_A = step.current_A
            self._waiting = step
            result = yield Hold(now_A, self._settle, step.target_K)
            self._waiting = None
            assert isinstance(result, StepResult)  # noqa: S101 - the answer to a Hold
            step.done.set_result(result)
        if self._control.stopping:
            yield Drive(now_A)  # its tick ends the run with the cause

    def _next(self) -> "_Step | Drive | None":
        """The next step; a tick at the present current if there is none; None at the end."""
        try:
            return self._steps.get(block=self._time_stops)
        except queue.Empty:
            return Drive(0.0)

    def _fail_waiting(self) -> None:
        """Nobody waits for a step of a run that is over."""
        error = self._error or UsageError("The run was ended before this step.")
        if not self._ready.done():
            self._ready.set_exception(error)
        waiting = [self._waiting]
        while not self._steps.empty():
            waiting.append(self._steps.get())
        for step in filter(None, waiting):
            if not step.done.done():
                step.done.set_exception(error if isinstance(error, Exception) else SmarigError(str(error)))
