"""Bring-up: checks on the rig itself whether it is fit to run.

The checks move the wire gently in small steps of current, test the lease and end at zero current.
"""

import contextlib
import math
from collections.abc import Callable, Iterator
from itertools import chain, takewhile
from typing import Protocol

import numpy as np

from smarig.config import RigFile
from smarig.core import Quality, RigFault, Sample, Settled
from smarig.device import Check
from smarig.plant import Actuator
from smarig.rig.electrical_plausibility import MIN_CURRENT_A, read_back_tolerance_A
from smarig.rig.expected_resistance import ExpectedResistance, without_voltage_text
from smarig.rig.guard import Guard
from smarig.rig.limits_without_lease import limits_in_force, without_lease_text
from smarig.rig.motion_model import MotionModel, motion_of
from smarig.rig.resistance_motion import ResistanceMotion
from smarig.rig.rig import Rig
from smarig.rig.room_temperature import RoomTemperature
from smarig.rig.stress_limit import stress_limit

REST_TICKS, REST_WINDOWS = 100, 4  # readings at rest, and the settling windows that they last at most
BLOCKS = 25  # of a settling window
LEAST_RANGE = 2.49  # of 25 normal values, in standard deviations: 1 % of windows have a smaller one
READINGS = 10  # compared, at rest and at the end of a step
CURRENT_STEPS = 20  # from zero to the current limit
STEP_TAUS = 1.5  # time constants per step
COOL_TAUS = 5.0
LEASE_TEST_SHARE = 0.1  # of the largest current, during the test of the lease
LEASE_MARGIN_S = 1.5
ProgressCallback = Callable[[str], None]
STEPS_UNLIKE = 2  # one after the other with a wrong resistance: one reading of a small voltage may be wrong
BACKLOG_S = 10.0  # of samples after re-arming that may still show the trip
HOST_ALONE = (
    "The host alone holds the limit of the measured wire temperature: the amplifier has no thermometer on the wire, or "
    "no register for the limit."
)
_RESISTANCE_REMEDY = (
    "check clamps, wire and shunt; another wire has an actuator file of its own (smarig new actuator NAME), with these "
    "resistances"
)
_FURTHER_SENSORS = {"room": "room temperature", "force": "load cell"}  # by the kind of their alarms
_NO_CURRENT_REMEDY = (
    "no current flows: check the circuit of the wire, and whether the driver switches the output on"
)
_READ_BACK_REMEDY = "check the circuit of the wire, the amplifier, the shunt, and the unit of the driver"


class SupportsIdle(Rig, Protocol):
    """A rig that can be left without commands on purpose."""

    def idle(self, seconds: float) -> None:
        """Send no command for this time."""
        ...

    def identity(self) -> list[str]:
        """One line for each device."""
        ...

    @property
    def has_lease(self) -> bool:
        """Whether it switches itself off when the host stops communicating."""
        ...

    @property
    def counts_ticks(self) -> bool:
        """Whether the tick at which it switched itself off is known."""
        ...

    @property
    def holds_wire_limit(self) -> bool:
        """Whether its source measures the wire temperature and can limit it by itself."""
        ...

    @property
    def measures_ambient(self) -> bool:
        """Whether the ambient temperature of the samples is measured."""
        ...


class WireWatch(Protocol):
    """What follows the heat of the wire through a bring-up."""

    def begin(self, guard: Guard) -> None:
        """Receive the guard, whose prediction it may start hot, before the first step."""
        ...

    def add(self, sample: Sample, input_K: float) -> None:
        """Receive each sample with the predicted input."""
        ...


def bring_up(
    rig: SupportsIdle,
    file: RigFile,
    on_check: Callable[[Check], None],
    on_progress: ProgressCallback = lambda _: None,
    watch: WireWatch | None = None,
) -> None:
    """Make all checks in order; ``on_check`` receives each at once, so that those before a fault are not lost with it.

    ``watch`` follows the wire, except through the test of the lease, at a tenth of the largest current. Raises RigFault
    if the rig is lost or trips.
    """
    try:
        for check in _checks(rig, file, on_progress, watch):
            on_check(check)
    finally:
        rig.safe()


class _WatchedWire:
    """The wire behind a guard, and what follows its heat."""

    def __init__(self, guard: Guard, watch: WireWatch | None) -> None:
        self._guard, self._watch = guard, watch
        if watch is not None:
            watch.begin(guard)

    @property
    def input_K(self) -> float:
        """The predicted input."""
        return self._guard.input_K

    def samples(self, current_A: float, ticks: int) -> list[Sample]:
        """The samples of at least one tick at a current."""
        found: list[Sample] = []
        while len(found) < max(1, ticks):
            arrived = self._guard.step(current_A, max(1, ticks) - len(found))
            if self._watch is not None:
                for sample, input_K in arrived:
                    self._watch.add(sample, input_K)
            self._guard.raise_if_tripped()
            found += [sample for sample, _ in arrived]
        return found


def _checks(
    rig: SupportsIdle, file: RigFile, on_progress: ProgressCallback, watch: WireWatch | None
) -> Iterator[Check]:
    """A rig that does not follow its command, or does not move when heated, is not heated further."""
    yield Check("devices", True, "; ".join(rig.identity()))
    actuator = Actuator.named(file.actuator)
    no_lease = without_lease_text(file, actuator)
    file = file.model_copy(update={"limits": limits_in_force(file.limits, actuator, has_lease=rig.has_lease)})
    guard = Guard(rig, file.limits, actuator, stress=stress_limit(file, actuator), room=RoomTemperature(file))
    wire = _WatchedWire(guard, watch)
    at_rest = wire.samples(0.0, _rest_ticks(file.period_s))
    rest = at_rest[-1]
    yield _at_rest(rest, file, measured=rig.measures_ambient)
    if not _follows_command(rest, 0.0, file):
        return
    yield from _further_sensors(guard)
    if blind := _blind(at_rest, file, actuator):  # heat would show nothing
        yield blind
        return
    yield from _settling(at_rest, file)
    if not math.isnan(rest.temperature_degC) and not rig.holds_wire_limit:
        yield Check("wire temperature", True, HOST_ALONE, limitation=True)
    pulses = [_heating_checks(wire, file, actuator, +1, on_progress)]
    if file.limits.current_min_A < 0:  # the second wire
        pulses.append(_heating_checks(wire, file, actuator, -1, on_progress))
    for check in chain(*pulses):
        yield check
        if not check.passed:
            return
    if rig.has_lease:
        yield from _check_lease(rig, file)
    else:
        yield Check("lease", True, no_lease, limitation=True)


def _at_rest(sample: Sample, file: RigFile, *, measured: bool) -> Check:
    """No current flows at a command of zero. ``measured``: the ambient temperature."""
    by = "" if measured else " by the rig file (not measured)"
    observed = f"{sample.current_A:.4f} A measured at 0 A; ambient {sample.ambient_degC:.1f} °C{by}"
    return Check("at rest", _follows_command(sample, 0.0, file), observed)


def _further_sensors(guard: Guard) -> Iterator[Check]:
    """A limitation for each sensor whose readings are not plausible at rest."""
    for alarm in guard.alarms():
        if alarm.kind in _FURTHER_SENSORS:
            yield Check(_FURTHER_SENSORS[alarm.kind], True, alarm.text, limitation=True)


def _blind(at_rest: list[Sample], file: RigFile, actuator: Actuator) -> Check | None:
    """A failed check if readings at rest scatter so much that no motion would be seen among them."""
    rest = at_rest[-READINGS:]
    return MotionModel(actuator, file, +1).blind(motion_of(rest, rest, +1))


def _settling(at_rest: list[Sample], file: RigFile) -> Iterator[Check]:
    """A limitation if readings at rest scatter so much that no window of a hold is likely to settle.

    A hold compares the means of ``BLOCKS`` blocks; the mean of n readings scatters √n times less than a reading.
    """
    rule = Settled()
    per_block = max(1, round(rule.window_s / BLOCKS / file.period_s))
    scatter = float(np.std([s.counts for s in at_rest], ddof=1))
    if LEAST_RANGE * scatter / math.sqrt(per_block) > rule.band_counts:
        text = (
            f"readings at rest scatter by {scatter:.2g} counts, too much to settle within band_counts = "
            f"{rule.band_counts:g}: check the unit of the driver first; then make encoder.resolution "
            "several times the noise of a reading, or raise settle.band_counts"
        )
        yield Check("settling", True, text, limitation=True)


def _rest_ticks(period_s: float) -> int:
    """Ticks at rest: enough for a standard deviation within 7 %, if they do not last too long."""
    return min(REST_TICKS, max(10, round(REST_WINDOWS * Settled().window_s / period_s)))


def _heating_checks(
    wire: _WatchedWire, file: RigFile, actuator: Actuator, sign: int, on_progress: ProgressCallback
) -> Iterator[Check]:
    """Raise the current in steps until the wire moves or must have moved by its model; then report and cool."""
    tau_ticks = max(1, round(actuator.tau_s / file.period_s))
    model = MotionModel(actuator, file, sign)
    largest_A = file.limits.current_max_A if sign > 0 else file.limits.current_min_A
    rest = wire.samples(0.0, READINGS)[-READINGS:]
    sample, command_A, motion = rest[-1], 0.0, motion_of(rest, rest, sign)
    expected, unlike = ExpectedResistance(actuator, file.limits.resistance_tolerance), 0
    low_ohm, high_ohm = actuator.resistance_range_ohm
    range_ln = 0.0 if actuator.two_wire else math.log(high_ohm / low_ohm)
    by_resistance = ResistanceMotion(range_ln, still_counts=math.inf, heated_K=0.0)
    for k in range(1, CURRENT_STEPS + 1):
        command_A = largest_A * k / CURRENT_STEPS
        heated = wire.samples(command_A, round(STEP_TAUS * tau_ticks))[-READINGS:]
        sample, motion = heated[-1], motion_of(rest, heated, sign)
        counts = f"{sign * motion.heated_by:+d} counts"
        on_progress(f"    {command_A:+.2f} A: {counts}, {wire.input_K:+.0f} K (heating model)")
        for ohm in filter(None, map(_ohm, heated)):
            by_resistance.add(math.log(ohm), wire.input_K)
        unlike = unlike + 1 if _is_another_wire(sample, expected, wire.input_K) else 0
        if not _follows_command(sample, command_A, file) or unlike == STEPS_UNLIKE:
            break
        if model.has_shown(motion, wire.input_K):
            break
    how = "(last reading, no new one)" if sample.quality & Quality.STALE else "measured"
    which = ", wire 2" if sign < 0 else ""
    comparison = f"{sample.current_A:.4f} A {how} at {command_A:.4f} A"
    follows = _follows_command(sample, command_A, file)
    remedy = _NO_CURRENT_REMEDY if _follows_command(sample, 0.0, file) else _READ_BACK_REMEDY
    yield Check(f"read-back{which}", follows, comparison if follows else f"{comparison}; {remedy}")
    yield _resistance(sample, expected, wire.input_K)._replace(name=f"resistance{which}")
    where = f"{sign * motion.heated_by:+d} counts at {command_A:.2f} A, {wire.input_K:.0f} K (heating model)"
    transformed = bool(by_resistance.started)
    direction = model.direction(motion, where, wire.input_K, transformed=transformed)
    direction = direction._replace(name=f"encoder direction{which}")
    scale = model.scale(motion, wire.input_K)._replace(name=f"encoder scale{which}")
    # counts of a wrong unit tell no direction
    yield from (direction, scale) if scale.passed else (scale, direction)
    wire.samples(0.0, round(COOL_TAUS * tau_ticks))


def _follows_command(sample: Sample, command_A: float, file: RigFile) -> bool:
    """Whether the measured current is the commanded one within the tolerance."""
    near = abs(sample.current_A - command_A) <= read_back_tolerance_A(file.limits, file.amplifier)
    return near and not sample.quality & Quality.STALE


def _resistance(sample: Sample, expected: ExpectedResistance, input_K: float) -> Check:
    if abs(sample.current_A) < MIN_CURRENT_A:
        return Check("resistance", False, "the current was too small to measure it")
    low, high = expected.band_ohm(input_K, sample.current_A)
    if (ohm := _ohm(sample)) is None:
        return Check("resistance", True, without_voltage_text(low, high), limitation=True)
    passed = low <= ohm <= high
    remedy = "" if passed else f"; {_RESISTANCE_REMEDY}"
    return Check("resistance", passed, f"{ohm:.2f} ohm, expected {low:.2f} to {high:.2f}{remedy}")


def _ohm(sample: Sample) -> float | None:
    """V/I; None if the current is too small or the voltage is not measured."""
    measured = abs(sample.current_A) >= MIN_CURRENT_A and not math.isnan(sample.voltage_V)
    return sample.voltage_V / sample.current_A if measured else None


def _is_another_wire(sample: Sample, expected: ExpectedResistance, input_K: float) -> bool:
    """Whether V/I is no resistance of the actuator file's wire, whose heating model does not hold for this one then."""
    return _ohm(sample) is not None and not _resistance(sample, expected, input_K).passed


def _check_lease(rig: SupportsIdle, file: RigFile) -> Iterator[Check]:
    """At a small current, send no command and measure when the device switches off by itself."""
    last_command_tick = rig.step(LEASE_TEST_SHARE * file.limits.current_max_A)[-1].tick
    rig.idle(file.lease_s + LEASE_MARGIN_S)
    first = _first_tripped(rig, last_command_tick)
    rig.arm()
    backlog = round(BACKLOG_S / rig.period_s)
    later = list(takewhile(_tripped, (s for _ in range(backlog) for s in rig.step(0.0))))
    took_s = (first - last_command_tick) * rig.period_s if first else math.nan
    in_time = abs(took_s - file.lease_s) <= max(2 * rig.period_s, 0.1 * file.lease_s)
    found = f"the output switched off {took_s:.2f} s after the last command"
    if not first:
        found = "the output did not switch off"
        if not getattr(rig, "counts_ticks", True):  # only asked: nobody knows what it did in between
            found += ", or an order after the silence switched it on again"
    elif not rig.counts_ticks:  # it was off when it was next queried; the moment is not known
        in_time, found = True, f"the output was off when it was asked {took_s:.2f} s after the last command"
    flows_A = max((abs(s.current_A) for s in later if s.tick > first), default=0.0)
    observed = f"{found}; lease {file.lease_s:g} s"
    if flows_A > read_back_tolerance_A(file.limits, file.amplifier):
        observed, in_time = (
            f"tripped {took_s:.2f} s after the last command, but {flows_A:.4f} A flowed after the trip",
            False,
        )
    yield Check("lease", in_time, observed)
    yield Check("re-arm", len(later) < backlog, "re-arming clears the trip")


def _first_tripped(rig: Rig, last_command_tick: int) -> int:
    """The first tick at which the device was tripped; 0 if it never was."""
    with contextlib.suppress(RigFault):
        for _ in range(1000):
            for sample in rig.step(0.0):
                if _tripped(sample):
                    return sample.tick
                if (sample.tick - last_command_tick) * rig.period_s > 60:
                    return 0
    return 0


def _tripped(sample: Sample) -> bool:
    return bool(sample.quality & Quality.TRIPPED)
