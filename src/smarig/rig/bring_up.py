"""Bring-up: is a rig fit to run? Each check is done on the rig itself and says what was seen.

Moves the wire gently, in small steps of current, and ends at zero with the lease tried out. Knows the Rig seam
and the rig file; refuses to know devices, and who reads the list.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple, Protocol

from smarig.config import RigFile
from smarig.errors import RigFault
from smarig.model.actuator import Actuator
from smarig.rig.guard import Guard
from smarig.rig.plausibility import FLOWING_A, READ_BACK, RESISTANCE
from smarig.rig.rig import Rig
from smarig.sample import Quality, Sample

MOVED = 5  # counts: more than noise
STAIRS = 20  # of current, up to the limit
STAIR_TAUS = 1.5  # time constants on each
COOL_TAUS = 5.0
LEAST_PULSE = 0.1  # of the largest current: flows while the lease is tried
AFTER_LEASE_S = 1.5
BACKLOG_S = 10.0  # of samples that show the trip still


class Check(NamedTuple):
    """One line of the list."""

    name: str
    passed: bool
    seen: str


class Silenceable(Rig, Protocol):
    """A rig that can be left alone on purpose."""

    def idle(self, seconds: float) -> None:
        """Say nothing for so long."""
        ...

    def arm(self) -> None:
        """Clear a trip."""
        ...

    def identity(self) -> list[str]:
        """Who answers, a line for each device."""
        ...


def bring_up(rig: Silenceable, file: RigFile, say: Callable[[str], None] = lambda _: None) -> list[Check]:
    """All checks in order; what cannot be gone on with ends the list."""
    found: list[Check] = []
    try:
        for check in _checks(rig, file):
            say(f"{'ok ' if check.passed else 'NOT'} {check.name}: {check.seen}")
            found.append(check)
    except RigFault as fault:
        found.append(Check("rig", False, str(fault)))
    finally:
        rig.safe()
    return found


def _checks(rig: Silenceable, file: RigFile) -> Iterator[Check]:
    yield Check("devices", True, "; ".join(rig.identity()))
    actuator = Actuator.named(file.actuator)
    guard = Guard(rig, file.limits, actuator)
    yield _at_rest(guard)
    yield from _pulse(guard, file, actuator)
    yield from _lease(rig, file)


def _at_rest(guard: Guard) -> Check:
    """Nothing flows when nothing is asked for."""
    sample = _last(guard, 0.0, 10)
    fine = abs(sample.current_A) <= READ_BACK * guard.limits.current_max_A
    return Check(
        "at rest", fine, f"{sample.current_A:.4f} A flow at 0 A; ambient {sample.ambient_degC:.1f} °C"
    )


def _pulse(guard: Guard, file: RigFile, actuator: Actuator) -> Iterator[Check]:
    """Up in stairs until the wire moves; which way, how much current flowed, through which resistance."""
    tau_ticks = max(1, round(actuator.tau_s / file.period_s))
    begin = _last(guard, 0.0, 1).counts
    sample, asked_A = _last(guard, 0.0, 1), 0.0
    for k in range(1, STAIRS + 1):
        asked_A = file.limits.current_max_A * k / STAIRS
        sample = _last(guard, asked_A, round(STAIR_TAUS * tau_ticks))
        if abs(sample.counts - begin) >= MOVED:
            break
    moved = sample.counts - begin
    where = f"{moved:+d} counts at {asked_A:.2f} A, {guard.input_K:.0f} K above ambient by the model"
    yield Check("encoder direction", moved >= MOVED, f"{where}; heating must count upwards")
    off = abs(sample.current_A - asked_A)
    fine = off <= READ_BACK * file.limits.current_max_A
    yield Check("read-back", fine, f"{sample.current_A:.4f} A measured at {asked_A:.4f} A")
    yield _resistance(sample, actuator)
    _last(guard, 0.0, round(COOL_TAUS * tau_ticks))


def _resistance(sample: Sample, actuator: Actuator) -> Check:
    heating = actuator.file.heating
    low = RESISTANCE[0] * heating.resistance_austenite.value
    high = RESISTANCE[1] * heating.resistance_martensite.value
    if abs(sample.current_A) < FLOWING_A:
        return Check("resistance", False, "too little current flowed to tell")
    ohm = sample.voltage_V / sample.current_A
    return Check("resistance", low <= ohm <= high, f"{ohm:.2f} ohm, expected {low:.2f} to {high:.2f}")


def _lease(rig: Silenceable, file: RigFile) -> Iterator[Check]:
    """With a little current flowing, say nothing: when does the device switch off by itself?"""
    heard = rig.step(LEAST_PULSE * file.limits.current_max_A)[-1].tick
    rig.idle(file.lease_s + AFTER_LEASE_S)
    first = _first_tripped(rig, heard)
    took_s = (first - heard) * rig.period_s if first else float("nan")
    fine = abs(took_s - file.lease_s) <= max(2 * rig.period_s, 0.1 * file.lease_s)
    yield Check(
        "lease", fine, f"the output went off {took_s:.2f} s after the last word; lease {file.lease_s:g} s"
    )
    rig.arm()
    backlog = round(BACKLOG_S / rig.period_s)
    cleared = any(not rig.step(0.0)[-1].quality & Quality.TRIPPED for _ in range(backlog))
    yield Check("re-arm", cleared, "the trip is over once it is armed again")


def _first_tripped(rig: Rig, heard: int) -> int:
    """The tick in which the device was first tripped; 0 if it never was."""
    try:
        for _ in range(1000):
            for sample in rig.step(0.0):
                if sample.quality & Quality.TRIPPED:
                    return sample.tick
                if (sample.tick - heard) * rig.period_s > 60:
                    return 0
    except RigFault:
        return 0
    return 0


def _last(guard: Guard, current_A: float, ticks: int) -> Sample:
    """The last sample of so many ticks at a current."""
    sample: Sample | None = None
    left = max(1, ticks)
    while left > 0:
        arrived = guard.step(current_A, left)
        guard.raise_if_tripped()
        left -= len(arrived)
        sample = arrived[-1][0]
    assert sample is not None  # noqa: S101 - at least one tick passed
    return sample
