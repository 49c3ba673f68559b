"""The plan for resuming an interrupted run, made before anything is changed.

Hysteresis forbids replaying a step. The memory after the last finished step can be restored: the wire settles at its
dominant extrema in order. If the memory is unknown, the protocol restarts and all earlier steps are void.
"""

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from smarig.core import DataError, Hold, Settled, Waveform
from smarig.device import AbsoluteZero
from smarig.preisach import Preisach, RelayMeasure
from smarig.protocols import Setup
from smarig.record import Run, Step
from smarig.runner.absolute_zero import counts_to_add
from smarig.runner.restart_shift import Shift
from smarig.runner.resume.replay_protocol import FinishedStep, ReplayedProtocol
from smarig.runner.wire_heat import COLD_TAUS

RE_ESTABLISH = "re-establish"
STEADY_TOLERANCE_K = 0.5  # a hold that ended further from its steady input did not settle there
_COLD_SHARE = 1e-2  # of the range: the wire is cold below this input

StartState = Literal["negative", "anhysteretic"]
SAME_INPUT = 1e-6  # relative to the range


@dataclass(frozen=True)
class RestorePath:
    """Inputs (K) to settle at in order. ``from_start``: the path starts in the initial state of the run.

    Otherwise the first input saturates the wire, so the path works from any state.
    """

    inputs_K: tuple[float, ...]
    from_start: bool


def find_restore_path(
    inputs_K: Sequence[float | None], lower_K: float, upper_K: float, start: StartState | None
) -> RestorePath | None:
    """The path to the memory after settled inputs; None if that memory is unknown.

    None among the inputs marks a segment without settling (a waveform): its memory is unknown until the next
    saturation. ``start`` is the state before the first input, None if unknown.

    >>> find_restore_path([0.0, 100.0, 20.0, 60.0, 20.0], 0.0, 174.0, "negative")
    RestorePath(inputs_K=(0.0, 100.0, 20.0), from_start=False)
    >>> find_restore_path([0.0, None, 20.0], 0.0, 174.0, "negative") is None
    True
    """
    tolerance = SAME_INPUT * (upper_K - lower_K)
    memory = _initial_memory(start, lower_K, upper_K)
    for u in inputs_K:
        if u is None:
            memory = None
        elif u <= lower_K + tolerance:
            memory = Preisach(RelayMeasure.zero(lower_K, upper_K), "negative")
        elif u >= upper_K - tolerance:
            memory = Preisach(RelayMeasure.zero(lower_K, upper_K), "positive")
        elif memory is not None:
            memory.step(u)
    if memory is None:
        return None
    state = memory.state.reduced()
    extrema_K = list(state.extrema[state.diagonal :])
    if not extrema_K or extrema_K[-1] != state.u:
        extrema_K.append(state.u)
    if len(extrema_K) > 1 and extrema_K[1] >= upper_K - tolerance:
        extrema_K = extrema_K[1:]  # the upper saturation wipes out the lower extremum
    return RestorePath(tuple(extrema_K), bool(state.diagonal))


def _initial_memory(start: StartState | None, lower_K: float, upper_K: float) -> Preisach | None:
    if start is None:
        return None
    reach = max(-lower_K, upper_K)
    lower_K, upper_K = (-reach, reach) if start == "anhysteretic" else (lower_K, upper_K)
    return Preisach(RelayMeasure.zero(lower_K, upper_K), start)


@dataclass(frozen=True)
class RigState:
    """The present state of the rig: its device and tick, whether it is a new twin in its first state, and the zero of
    a sensor that keeps it through a restart.
    """

    device: str
    tick: int
    fresh_twin: bool
    initial: str
    absolute_zero: AbsoluteZero | None = None


@dataclass(frozen=True)
class ResumePlan:
    """How to resume. ``reason`` is why the protocol restarts, "" if it continues. ``currents_A`` is the path back.
    ``reference`` is the step whose position restores the encoder's zero, None if the zero is known. ``remarks``
    tell what has changed about the rig.
    """

    replayed: ReplayedProtocol
    settle: Settled
    shift: Shift
    reason: str = ""
    currents_A: tuple[float, ...] = ()
    inputs_K: tuple[float, ...] = ()
    reference: Step | None = None
    remarks: tuple[str, ...] = ()

    @property
    def start_over(self) -> bool:
        """Whether the protocol restarts."""
        return bool(self.reason)

    @property
    def holds(self) -> int:
        """Number of holds of the path back; the first two cool the wire."""
        return 2 + len(self.currents_A[self.begins_cold :])

    @property
    def begins_cold(self) -> bool:
        """Whether the first point of the path back is the cold wire."""
        return self.currents_A[:1] == (0.0,)

    def sentence(self) -> str:
        """The plan in one line, with the remarks."""
        return " ".join((self._how(), *self.remarks))

    def _how(self) -> str:
        if self.start_over:
            return f"Restarted: {self.reason}. All earlier steps are void; the wire is cooled first."
        if self.replayed.pending is None:
            return "Resumed: all steps were already finished."
        inputs = ", ".join(f"{u:g}" for u in self.inputs_K)
        return (
            f"Resumed: cooled the wire, settled it at {inputs} K in turn, and repeated the interrupted step."
        )


def plan_resume(run: Run, replayed: ReplayedProtocol, setup: Setup, now: RigState) -> ResumePlan:
    """The plan for a run on a rig. Raises DataError if the encoder's zero cannot be restored."""
    same_device = _same_device(run, now)
    shift = _shift(run, setup, now, same_device)
    settle = _settle_rule(replayed)
    reason, path_K = _restore_path_or_reason(run, replayed, setup, now, same_device)
    if path_K is None:
        return ResumePlan(replayed, settle, shift, reason)
    currents = _currents(path_K, replayed, setup)
    zero_kept = counts_to_add(run, now.absolute_zero) is not None
    zero_known = same_device or zero_kept or (now.fresh_twin and _last_zero(run) == "power-up")
    reference = None if zero_known else _reference(run, replayed, path_K, setup)
    return ResumePlan(
        replayed=replayed,
        settle=settle,
        shift=shift,
        reason="",
        currents_A=currents,
        inputs_K=path_K.inputs_K,
        reference=reference,
    )


def _restore_path_or_reason(
    run: Run, replayed: ReplayedProtocol, setup: Setup, now: RigState, same_device: bool
) -> tuple[str, RestorePath | None]:
    """The path back, or the reason why there is none."""
    if not replayed.exact:
        return "a closed loop cannot be resumed in the middle", None
    if isinstance(replayed.pending, Waveform):
        return "a waveform cannot be resumed in the middle", None
    path_K = find_restore_path(
        _settled_inputs(replayed, setup),
        wipe_out_input_K(setup),
        setup.upper_K,
        _start(run, replayed, setup, now),
    )
    if path_K is None:
        return "settled holds cannot restore the memory of the wire before the interruption", None
    was_restarted = any(e.data.get("start_over") for e in run.events)
    if path_K.from_start and (
        same_device or not now.fresh_twin or was_restarted or run.info.initial != now.initial
    ):
        return f"its initial state '{run.info.initial}' cannot be restored", None
    return "", path_K


def wipe_out_input_K(setup: Setup) -> float:
    """The input that wipes out a memory from below; a single wire is cold at rest."""
    return setup.lower_K if setup.two_wire else 0.0


def _settled_inputs(replayed: ReplayedProtocol, setup: Setup) -> list[float | None]:
    return [_settled_input(d, setup) for d in replayed.done]


def _settled_input(done: FinishedStep, setup: Setup) -> float | None:
    """The input at which a step settled, None if it did not settle."""
    if not isinstance(done.command, Hold):
        return None
    steady_K = setup.actuator.input_for(done.command.current_A)
    return steady_K if abs(done.input_K - steady_K) <= STEADY_TOLERANCE_K else None


def _start(run: Run, replayed: ReplayedProtocol, setup: Setup, now: RigState) -> StartState | None:
    """The state before the first finished step, None if unknown."""
    if setup.two_wire:
        return "anhysteretic" if run.info.initial == "anhysteretic" and now.fresh_twin else None
    if run.info.initial == "negative" or not replayed.done:
        return "negative"
    before = max(run.rows(replayed.done[0].step).start - 1, 0)
    cold = abs(float(run["input"][before])) <= _COLD_SHARE * setup.upper_K
    return "negative" if cold else None


def _currents(path_K: RestorePath, replayed: ReplayedProtocol, setup: Setup) -> tuple[float, ...]:
    """The currents of the path, exactly as they were held in the run."""
    held = {
        setup.actuator.input_for(d.command.current_A): d.command.current_A
        for d in replayed.done
        if isinstance(d.command, Hold)
    }
    lowest = setup.current_for(setup.lower_K) if setup.two_wire else 0.0
    highest = setup.current_for(setup.upper_K)
    ends = {wipe_out_input_K(setup): lowest, setup.upper_K: highest}
    return tuple(float({**ends, **held}.get(u, setup.current_for(u))) for u in path_K.inputs_K)


def _settle_rule(replayed: ReplayedProtocol) -> Settled:
    """The settling rule of the protocol."""
    requested_holds = [
        c for c in (replayed.pending, *(d.command for d in reversed(replayed.done))) if isinstance(c, Hold)
    ]
    return next((c.until for c in requested_holds if isinstance(c.until, Settled)), Settled())


# --- the device's clock and zero -------------------------------------------------------------------------


def _same_device(run: Run, now: RigState) -> bool:
    """Whether the device has been running since: the same one, the same boot, and a later tick."""
    last = int(run["tick"][-1]) if len(run) else 0
    return run.info.device == now.device and now.tick + int(run.info.shift.get("ticks", 0)) >= last


def _shift(run: Run, setup: Setup, now: RigState, same_device: bool) -> Shift:
    if same_device:
        known = run.info.shift
        reference_s, zeroed_s = (
            max((e.t_s for e in run.events if e.kind == k), default=0.0) for k in ("shift", "zero")
        )
        return Shift(
            int(known.get("ticks", 0)), int(known.get("counts", 0)) if zeroed_s <= reference_s else 0
        )
    last = int(run["tick"][-1]) if len(run) else 0
    gap_s = max(COLD_TAUS * setup.tau_s, _idle_s(run))
    counts = counts_to_add(run, now.absolute_zero) or 0
    return Shift(last + math.ceil(gap_s / setup.period_s) - now.tick, counts)


def _idle_s(run: Run) -> float:
    """Time since hardware was last recorded; 0 for a twin, which has its own time."""
    started = [e for e in run.events if "epoch" in e.data]
    if run.info.source != "bench" or not started or not len(run):
        return 0.0
    since_start_s = float(run["t_s"][-1]) - started[-1].t_s
    return time.time() - float(started[-1].data["epoch"]) - since_start_s


def _last_zero(run: Run) -> str:
    """Where the encoder was last zeroed, according to the record."""
    zeroed = [e for e in run.events if e.kind == "zero"]
    return f"zeroed at {zeroed[-1].t_s:g} s" if zeroed else str(run.info.encoder_zero)


def _reference(run: Run, replayed: ReplayedProtocol, path_K: RestorePath, setup: Setup) -> Step:
    """The first step since the last zero that settled at the start of the path back."""
    zeroed_s = max((e.t_s for e in run.events if e.kind == "zero"), default=-math.inf)
    tolerance = SAME_INPUT * (setup.upper_K - setup.lower_K)
    for done, u in zip(replayed.done, _settled_inputs(replayed, setup)):
        matches = u is not None and not path_K.from_start and abs(u - path_K.inputs_K[0]) <= tolerance
        if matches and done.step.t_start_s >= zeroed_s and done.step.position is not None:
            return done.step
    raise DataError(
        f"{run.path.name}: the encoder has restarted, and the run has no settled step at the first input of the path "
        "back to the remembered state. The zero of the encoder is lost. Run the protocol again."
    )
