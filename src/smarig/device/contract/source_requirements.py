"""Requirements on current sources. They drive a tenth of the rig's largest current, and leave the output at zero."""

import math
from contextlib import suppress
from typing import Any

from smarig.core import Quality, SmarigError
from smarig.device.contract.contract_case import (
    GAIN_TOLERANCE,
    SETTLE_TICKS,
    Broken,
    ContractCase,
    Limitation,
    Unusable,
    require,
)
from smarig.device.roles.ticked import NO_MEASURED_CURRENT, CurrentReading, CurrentSource

LEASE_MARGIN_S = 1.5  # besides the lease, until the output must be off
BLOCK_TICKS = 3  # readings asked for at once
HELD_LEASES = 2.0  # for which an order is held
LATE, ATTEMPTS = 0.5, 8  # of the lease between two queries: it may expire for that, so it is tried again


def off_after_opening(case: ContractCase) -> str:
    """Opening leaves the output at zero current."""
    with case.opened() as source:
        current_A = _settled(case, source).current_A
        if math.isnan(current_A):
            raise Unusable(f"the driver measures no current. {NO_MEASURED_CURRENT}")
        require(abs(current_A) <= case.tolerance_A, f"{current_A:.4g} A flow after opening")
        return f"{current_A:.4f} A after opening"


def off_after_a_killed_host(case: ContractCase) -> str:
    """A host that was killed leaves the output on; opening it again switches it off."""
    source = case.open()
    source.set(case.test_A)
    flowing_A = _settled(case, source).current_A
    source.close()
    require(
        abs(flowing_A) > case.tolerance_A, f"{flowing_A:.4g} A measured before, {case.test_A:.4g} A ordered"
    )
    with case.opened() as again:
        current_A = _settled(case, again).current_A
        require(abs(current_A) <= case.tolerance_A, f"{current_A:.4g} A flow after it was opened again")
        if not again.has_lease:
            return Limitation(f"the current flows until it is opened again; then {current_A:.4f} A")
        return f"{current_A:.4f} A after it was opened again"


def current_as_ordered(case: ContractCase) -> str:
    """The measured current is the ordered one; the next order replaces it; the gain is 1."""
    found, measured_A, has_voltage = [], [], True
    with case.opened() as source:
        for ordered_A in (case.test_A, case.test_A / 2):
            source.set(ordered_A)
            now = _settled(case, source)
            require(
                abs(now.current_A - ordered_A) <= case.tolerance_A,
                f"{now.current_A:.4g} A measured, {ordered_A:.4g} A ordered{_unit_text(now.current_A / ordered_A)}",
            )
            has_voltage = has_voltage and math.isfinite(now.voltage_V)
            found.append(f"{now.current_A:.4f} A at {ordered_A:.4g} A")
            measured_A.append(now.current_A)
    gain = (measured_A[0] - measured_A[1]) / (case.test_A / 2)
    text = f"{', '.join(found)}: gain {gain:.2f}"
    require(abs(gain - 1) <= GAIN_TOLERANCE, f"{text}, not 1")
    if not has_voltage:
        return Limitation(f"{text}; it measures no voltage, so the resistance of the wire is not checked")
    return text


def _unit_text(ratio: float) -> str:
    """A question about the unit of a reading that is a thousand times the order, or a thousandth."""
    for factor, named in ((1000.0, "1000"), (0.001, "1/1000")):
        if abs(abs(ratio) / factor - 1) <= GAIN_TOLERANCE:
            return f", a factor of about {named}: is the unit of the reading right?"
    return ""


def readings_in_order(case: ContractCase) -> str:
    """``since`` returns at most as many readings as asked for, by ascending ticks, from the asked tick on."""
    with case.opened() as source:
        first = source.tick() + 1
        case.wait_ticks(BLOCK_TICKS + 1)
        found = source.since(first, BLOCK_TICKS)
        ticks = [reading.tick for reading in found]
    require(bool(found), "it returned no reading after several ticks")
    require(len(found) <= BLOCK_TICKS, f"it returned {len(found)} readings instead of at most {BLOCK_TICKS}")
    require(all(isinstance(reading, CurrentReading) for reading in found), "they are no CurrentReading")
    require(all(isinstance(tick, int) for tick in ticks), "a tick is no integer")
    require(ticks[0] >= first and ticks == sorted(set(ticks)), f"ticks {ticks} since tick {first}")
    return f"ticks {ticks[0]} to {ticks[-1]}"


def no_number_refused(case: ContractCase) -> str:
    """NaN and infinity are refused and do not change the current."""
    with case.opened() as source:
        for wrong in (math.nan, math.inf):
            try:
                source.set(wrong)
            except (SmarigError, ValueError, OverflowError):
                pass
            else:
                require(bool(source.tripped), f"it accepted {wrong:g} A")
        current_A = _settled(case, source).current_A
        require(abs(current_A) <= case.tolerance_A, f"{current_A:.4g} A flow after a refused order")
    return "refused; the current stays at zero"


def off_confirmed(case: ContractCase) -> str:
    """``off`` sets zero current, returns "" and may be repeated."""
    with case.opened() as source:
        source.set(case.test_A)
        case.wait_ticks(1)
        for _ in range(2):
            _no_error(source.off, "off", "")
        current_A = _settled(case, source).current_A
        require(abs(current_A) <= case.tolerance_A, f"{current_A:.4g} A flow after off")
        source.arm()
        source.set(case.test_A)
        now_A = _settled(case, source).current_A
        require(abs(now_A - case.test_A) <= case.tolerance_A, f"{now_A:.4g} A after off, arm and a new order")
    return f"{current_A:.4f} A after off; armed again"


def off_on_a_closed_line(case: ContractCase) -> str:
    """``off`` on a closed line does not raise: it opens the line again and confirms, or says that nobody confirmed."""
    source = case.open()
    source.off()
    source.close()
    text = _no_error(source.off, "off", None)
    source.close()
    require(isinstance(text, str), f"off returned {text!r}, which is no text")
    return f"it reports: {text}" if text else "the line was opened again, and the device confirmed"


def first_order_after_a_pause(case: ContractCase) -> str:
    """A host may pause between opening and its first order: the lease counts from that order on."""
    with case.opened() as source:
        if not source.has_lease:
            return "it has no lease that could expire"
        pause_s = case.rig.lease_s + LEASE_MARGIN_S
        case.wait(pause_s)
        source.set(case.test_A)
        current_A = _settled(case, source).current_A
        require(
            not source.tripped,
            f"{source.tripped} It had {pause_s:g} s without an order after it was opened: start the lease with the "
            "first order, or arm again with it",
        )
        require(
            abs(current_A - case.test_A) <= case.tolerance_A,
            f"{current_A:.4g} A flow by a first order of {case.test_A:.4g} A",
        )
    return f"{current_A:.4f} A by an order {pause_s:g} s after opening"


def current_held(case: ContractCase) -> str:
    """An order stays in force for longer than the lease, if only readings are asked for: a run repeats no order."""
    with case.opened() as source:
        if not source.has_lease:
            return "it has no lease that could expire"
        now_A, passed_s, late_s, is_late = math.nan, 0.0, 0.0, False
        for _ in range(ATTEMPTS):
            now_A, passed_s, late_s = _held(case, source)
            is_late = late_s >= LATE * case.rig.lease_s
            if not source.tripped or not is_late:
                break
        require(
            not source.tripped or not is_late,
            f"this cannot be tested here: in each of {ATTEMPTS} attempts, {late_s:.1f} s passed between two queries, "
            "because this computer is busy or the device answers late, and the lease expired",
        )
        require(
            not source.tripped,
            f"{source.tripped} That was {passed_s:.1f} s after an order, with a query in each tick: measure must "
            "renew the lease, too",
        )
        require(
            abs(now_A - case.test_A) <= case.tolerance_A,
            f"{now_A:.4g} A flow {passed_s:.1f} s after an order",
        )
    return f"{now_A:.4f} A {passed_s:.1f} s after the order, which is not repeated"


def _held(case: ContractCase, source: CurrentSource) -> tuple[float, float, float]:
    """The current at the end of an order, how long that was, and the longest time between two queries, in seconds."""
    source.arm()
    before_s = case.now_s()
    source.set(case.test_A)
    now_A, passed_s, late_s = math.nan, 0.0, 0.0
    while passed_s < HELD_LEASES * case.rig.lease_s and not source.tripped:
        waited_s = case.wait_ticks(1) * case.rig.period_s
        now_A, now_s = _reading(case, source).current_A, case.now_s()
        gap_s, before_s = max(waited_s, now_s - before_s), now_s
        passed_s, late_s = passed_s + gap_s, max(late_s, gap_s)
    return now_A, passed_s, late_s


def lease(case: ContractCase) -> str:
    """A source that claims a lease switches itself off when the host is silent, says so, and stays off until it is
    armed, also if the next order comes before anybody has asked it.
    """
    with case.opened() as source:
        if not source.has_lease:
            return Limitation("it has none: its rig takes lower limits, and only a cut-out stops the current")
        source.set(case.test_A)
        before_A = _settled(case, source).current_A
        case.wait(case.rig.lease_s + LEASE_MARGIN_S)
        now = _reading(case, source)
        reason = source.tripped
        require(
            abs(before_A - case.test_A) <= case.tolerance_A, f"{before_A:.4g} A flowed before the silence"
        )
        require(abs(now.current_A) <= case.tolerance_A, f"{now.current_A:.4g} A flow after the lease is over")
        require(bool(reason), "it switched itself off, but tripped does not say why")
        require(bool(int(now.quality) & Quality.TRIPPED), "its readings are not marked as tripped")
        source.arm()
        require(not source.tripped, f"arm does not clear the trip: {source.tripped}")
        source.set(case.test_A)
        case.wait(case.rig.lease_s + LEASE_MARGIN_S)
        with suppress(SmarigError):
            source.set(case.test_A)
        again_A = _settled(case, source).current_A
        require(
            abs(again_A) <= case.tolerance_A,
            f"{again_A:.4g} A flow by an order after the lease is over: switch on only after arm",
        )
    return f"{reason}"


REQUIREMENTS = {
    "off after opening": off_after_opening,
    "current as ordered": current_as_ordered,
    "readings in order": readings_in_order,
    "no number refused": no_number_refused,
    "off confirmed": off_confirmed,
    "off on a closed line": off_on_a_closed_line,
    "off after a killed host": off_after_a_killed_host,
    "first order after a pause": first_order_after_a_pause,
    "current held": current_held,
    "lease": lease,
}


def _settled(case: ContractCase, source: CurrentSource) -> CurrentReading:
    """The last reading after an order has taken effect; queried meanwhile, as a bench does."""
    for _ in range(SETTLE_TICKS):
        case.wait_ticks(1)
        _reading(case, source)
    return _reading(case, source)


def _reading(case: ContractCase, source: CurrentSource) -> CurrentReading:
    """The reading of the present tick."""
    for _ in range(SETTLE_TICKS):
        found = source.since(source.tick(), 1)
        if found:
            return found[-1]
        case.wait_ticks(0.5)
    raise Broken("it returns no reading of its present tick")


def _no_error(call: Any, name: str, expected: str | None) -> str:
    """What a method that must not raise returns, if it is what is expected."""
    try:
        found = call()
    except Exception as error:
        raise Broken(f"{name} raised {type(error).__name__}: {error}") from None
    require(expected is None or found == expected, f"{name} returned {found!r} instead of {expected!r}")
    return found
