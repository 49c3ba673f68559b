"""Requirements on position sensors, thermometers and load cells. No current flows."""

import math
from typing import Any

from smarig.device.contract.contract_case import SETTLE_TICKS, Broken, ContractCase, require
from smarig.device.roles.ticked import PositionReading

WATCHED_TICKS = 10  # over which ticks are compared with time
LATE_TICKS = 4  # a machine may be busy
STILL_COUNTS = (
    3  # by which a resting position may differ from zero, besides five times the noise of the rig file
)


def ticks_by_time(case: ContractCase) -> str:
    """Its ticks advance by one in each period of the rig."""
    with case.opened() as sensor:
        before = sensor.tick()
        periods = case.wait_ticks(WATCHED_TICKS)
        passed = sensor.tick() - before
    require(isinstance(before, int), "a tick is no integer")
    text = f"{passed} ticks in {periods:.0f} periods"
    require(0.8 * periods - LATE_TICKS / 2 <= passed <= 2 * periods + LATE_TICKS, text)
    require(passed >= WATCHED_TICKS - 2, text)
    return text


def positions_in_order(case: ContractCase) -> str:
    """``since`` returns at most as many readings as asked for, none from the future, by ascending ticks."""
    with case.opened() as sensor:
        found: list[PositionReading] = []
        tick = sensor.tick()
        for _ in range(SETTLE_TICKS):
            case.wait_ticks(1)
            new = sensor.since(tick + 1, 2)
            require(len(new) <= 2, f"it returned {len(new)} readings instead of at most 2")
            found += new
            tick = new[-1].tick if new else tick
        future = sensor.since(sensor.tick() + 1000, 1)
    require(bool(found), "it returned no reading after several ticks")
    require(not future, "it returned a reading of a tick that has not come")
    ticks = [reading.tick for reading in found]
    require(ticks == sorted(set(ticks)), f"ticks {ticks}")
    require(all(isinstance(reading.counts, int) for reading in found), "counts are no integers")
    return f"ticks {ticks[0]} to {ticks[-1]}, {found[-1].counts} counts"


def zeroing(case: ContractCase) -> str:
    """After ``zero`` a resting position reads zero."""
    with case.opened() as sensor:
        _last(case, sensor)
        sensor.zero()
        counts = _last(case, sensor).counts
    most = STILL_COUNTS + 5 * case.rig.encoder.noise_counts
    require(
        abs(counts) <= most,
        f"{counts} counts after zero; check that the driver returns its readings in its unit, and that a count (for a "
        "sensor in mm or degrees encoder.resolution) is no smaller than the noise of a reading",
    )
    return f"{counts} counts after zero"


def temperature(case: ContractCase) -> str:
    """A temperature that is possible, or NaN."""
    with case.opened() as instrument:
        value = instrument.temperature_degC()
    require(math.isnan(value) or -80 <= value <= 1000, f"{value:g} °C")
    return f"{value:.1f} °C"


def force(case: ContractCase) -> str:
    """A force that is a number, or NaN."""
    with case.opened() as instrument:
        value = instrument.force_N()
    require(isinstance(value, float) and not math.isinf(value), f"{value!r} is no force")
    return f"{value:.3g} N"


POSITION_REQUIREMENTS = {
    "ticks by time": ticks_by_time,
    "readings in order": positions_in_order,
    "zero": zeroing,
}


def _last(case: ContractCase, sensor: Any) -> PositionReading:
    """A reading of the present."""
    begin = sensor.tick()
    for _ in range(4 * SETTLE_TICKS):
        case.wait_ticks(0.5)
        found = sensor.since(max(begin, sensor.tick()), 1)
        if found and found[-1].tick > begin:
            return found[-1]
    raise Broken("it returns no reading of its present tick")
