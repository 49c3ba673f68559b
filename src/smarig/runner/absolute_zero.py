"""The zero of an absolute sensor in the record of a run, so that a later session continues the same counts.

count of the record = own count of the sensor − own count at the zero of the record
"""

from typing import Any

from smarig.device import AbsoluteZero
from smarig.record import ABSOLUTE_ZERO, Run

_EVENT_KINDS = ("start", "zero")  # the last of these counts


def zero_data(zero: AbsoluteZero | None) -> dict[str, Any]:
    """Data of an event; nothing for a sensor whose zero is lost with its session."""
    return {} if zero is None else {ABSOLUTE_ZERO: zero._asdict()}


def recorded_zero(run: Run) -> AbsoluteZero | None:
    """The zero of a record; None if its sensor is not absolute, or the record is damaged."""
    zeros = [event.data.get(ABSOLUTE_ZERO) for event in run.events if event.kind in _EVENT_KINDS]
    match zeros[-1] if zeros else None:
        case {"sensor": str(sensor), "counts": int(counts)}:
            return AbsoluteZero(sensor, counts)
    return None


def counts_to_add(run: Run, now: AbsoluteZero | None) -> int | None:
    """What continues the counts of a record on the same absolute sensor; None if its zero is not known."""
    then = recorded_zero(run)
    if then is None or now is None or then.sensor != now.sensor:
        return None
    return now.counts - then.counts
