"""Where the heating model starts in a new session: as hot as the wires may still be.

    after a kill      the record of the run that is resumed: its last state, heated on by the last current until the
                      lease has ended it, then cooled for the time that has passed since
    after a run       the wire's history: the state at its end, cooled since
    otherwise cold    also for a new run after a kill: a killed process leaves nothing in the wire's history

An upper bound: the wire may be colder. The time that has passed is that of the device if it has been running since,
otherwise that of the host's clock if it is plausible; without either, nothing is assumed to have cooled.
"""

import math
import time

import numpy as np

from smarig.core import Quality, Sample, SmarigError
from smarig.plant import Actuator, JouleHeating
from smarig.protocols import Setup
from smarig.record import LastHeat, Run, Wear
from smarig.rig import Guard

COLD_TAUS = 10.0  # after this time without a current the wire is cold
UNRECORDED_S = 1.0  # of the host's time: the last samples of a killed process may be missing
LONGEST_S = 3e8  # ten years: a clock that says more has been set
_MEMORY_TAUS = 40.0  # an earlier temperature is forgotten to the last bit


def wear_from(setup: Setup, input_K: float) -> Wear:
    """Wear of zero, from an input on."""
    return Wear(max(setup.upper_K, -setup.lower_K), setup.period_s, input_K)


def not_written(error: SmarigError) -> str:
    """What it means that the history of a wire could not be written."""
    return f"The wire's history was not written: {error} The next session takes the wire to be cold."


def heat_left(
    last: LastHeat, actuator: Actuator, elapsed_s: float | None, *, has_lease: bool
) -> tuple[float, float]:
    """The hottest that each wire can be, in kelvin above ambient, a time after what is last known of it."""
    if elapsed_s == math.inf:
        return 0.0, 0.0
    on_s = last.flows_s if has_lease else math.inf  # without a lease, until this session has switched it off
    heating = JouleHeating(actuator, min(on_s, math.inf if elapsed_s is None else elapsed_s))
    heating.wire_K = list(last.wire_K)
    heating.step(last.current_A)
    if elapsed_s is None:
        first, second = map(max, zip(heating.wire_K, last.wire_K))
        return first, second
    off_s = max(elapsed_s - on_s, 0.0)
    if off_s >= COLD_TAUS * actuator.tau_s:
        return 0.0, 0.0
    heating.tick(off_s)
    heating.step(0.0)
    return heating.wire_K[0], heating.wire_K[1]


def elapsed_s(
    last: LastHeat, device: str, tick: int, period_s: float, *, twin: bool, now: float | None = None
) -> float | None:
    """The time since then, None if no clock tells. Simulated devices have a time of their own: that of their ticks."""
    if last.device and last.device == device and tick >= last.tick:
        return (tick - last.tick) * period_s
    if twin:  # devices that were started since then have a new, cold wire
        return math.inf if last.device and last.device != device else None
    since_s = math.nan if last.epoch is None else (time.time() if now is None else now) - last.epoch
    return since_s if 0 <= since_s <= LONGEST_S else None


def recorded_heat(run: Run, actuator: Actuator, lease_s: float) -> LastHeat | None:
    """What the record of an interrupted run tells last of the heat of its wire; None without samples.

    The current may have flowed on for the time whose samples are missing and for the lease: the present one, or that of
    the record if it was longer. Simulated devices may run at any speed, so there the missing time has no bound. A
    command that was set in that time is not known; this is why a resumed run first cools its wire at zero current.
    """
    if not len(run):
        return None
    then_s = run.info.rig_values.get("lease_s")
    lease_s = max(lease_s, float(then_s)) if isinstance(then_s, int | float) else lease_s
    return LastHeat(
        wire_K=_wire_K_at_the_end(run, actuator),
        current_A=_larger(float(run["current_command_A"][-1]), float(run["current_A"][-1])),
        flows_s=lease_s + (0.0 if run.complete else math.inf if run.twin else UNRECORDED_S),
        device=run.info.device or "",
        tick=int(run["tick"][-1]) - int(run.info.shift.get("ticks", 0)),
        epoch=_epoch_at_the_end(run),
    )


def heat_at_the_end(guard: Guard, device: str, unconfirmed: Sample | None, lease_s: float) -> LastHeat:
    """The heat at the end of a run, whose current is zero; if a device did not confirm that, of its last sample."""
    limit_K = guard.limits.temperature_max_K
    first_K, second_K = (T if math.isfinite(T) else limit_K for T in guard.heating.wire_K)
    return LastHeat(
        wire_K=(first_K, second_K),
        current_A=_larger(unconfirmed.current_command_A, unconfirmed.current_A) if unconfirmed else 0.0,
        flows_s=lease_s if unconfirmed else 0.0,
        device=device,
        tick=guard.rig.tick,
        epoch=time.time(),
    )


def _larger(*currents_A: float) -> float:
    """The current that heats most, of those that are known."""
    return max((i for i in currents_A if math.isfinite(i)), key=abs, default=0.0)


def _epoch_at_the_end(run: Run) -> float | None:
    """The time of day of the last sample of hardware; None if it is not known, or the clock jumped."""
    begin = next((k for k in reversed(range(len(run.events))) if "epoch" in run.events[k].data), None)
    if begin is None or any(e.kind == "clock" for e in run.events[begin:]):
        return None
    return float(run.events[begin].data["epoch"]) + float(run["t_s"][-1]) - run.events[begin].t_s


def _wire_K_at_the_end(run: Run, actuator: Actuator) -> tuple[float, float]:
    """The temperatures after the last sample, as the guard predicted them.

    The record holds their difference. For two wires both follow from the currents since the last start, and the
    difference is then made to agree by raising one of them.
    """
    last_K = float(run["input"][-1])
    if not actuator.two_wire:
        return max(last_K, 0.0), 0.0
    heating = JouleHeating(actuator, float(run.info.period_s or 1.0))
    started_s, heating.wire_K = _start(run)
    rows = np.flatnonzero(run["t_s"] > max(started_s, run["t_s"][-1] - _MEMORY_TAUS * actuator.tau_s))
    before = int(run["tick"][rows[0]]) - 1 if rows.size else 0
    for k in rows.tolist():
        tick, current_A = int(run["tick"][k]), _heating_current_A(run, k)
        # Also lost ticks.
        for _ in range(min(tick - before, round(_MEMORY_TAUS * actuator.tau_s / heating.dt_s))):
            heating.step(current_A)
        before = tick
    first, second = heating.wire_K
    missing_K = last_K - (first - second)
    return (first + missing_K, second) if missing_K > 0 else (first, second - missing_K)


def _start(run: Run) -> tuple[float, list[float]]:
    """When the last session began, and the temperatures at which its prediction started; cold if not recorded."""
    begin = next((e for e in reversed(run.events) if e.kind in ("start", "resumed")), None)
    found = begin.data.get("wire_K") if begin is not None else None
    hot = isinstance(found, list) and len(found) == 2 and all(isinstance(x, int | float) for x in found)
    return (begin.t_s if begin else -math.inf), [float(x) for x in found] if hot and found else [0.0, 0.0]


def _heating_current_A(run: Run, k: int) -> float:
    """The current that heated in a sample: the measured one; if it is stale, the larger of it and the commanded."""
    measured_A, commanded_A = float(run["current_A"][k]), float(run["current_command_A"][k])
    if math.isfinite(measured_A) and not int(run["quality"][k]) & int(Quality.STALE):
        return measured_A
    return _larger(commanded_A, measured_A)
