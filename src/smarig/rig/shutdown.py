"""The end of a rig's operation: the current is set to zero, and what a source does not confirm is said."""

import time
from collections.abc import Callable
from typing import Any, Protocol, TypeVar

from smarig.core import AT_ZERO, SmarigError
from smarig.device import OFF_PAUSE_S

AT_ZERO_LATE = f"The source did not confirm zero at first, and a current may have flowed meanwhile. {AT_ZERO}"
NOT_CONFIRMED = "The source did not confirm that it is off: switch it off by hand now."
_Error = TypeVar("_Error", bound=SmarigError)
# more attempts to switch off a source that has no lease and did not confirm, and as long: a line that was plugged in
# again needs 1 to 3 s
OFF_ATTEMPTS, OFF_S = 5, 4.0


class SupportsShutdown(Protocol):
    """A rig, or its guard."""

    @property
    def shutdown_unconfirmed(self) -> str:
        """Why a current may still flow after ``safe``, "" if none does."""
        ...


def switch_off(
    rig: Any,
    sleep: Callable[[float], None] = time.sleep,
    report: Callable[[str], None] = lambda _: None,
    clock: Callable[[], float] = time.monotonic,
) -> str:
    """Set the current to zero. A source without a lease that does not confirm it is asked again: nothing else switches
    it off. One that confirms it is then measured, if it measures.

    Returns why it may still be on, or "". ``report`` gets it after the first attempt: who can switch it off by hand
    must not wait for the others.
    """
    rig.safe()
    reported = rig.shutdown_unconfirmed
    try:
        if reported:
            report(reported)
    finally:  # also if nobody can be reached
        attempts, end_s = 0, clock() + OFF_S
        while rig.shutdown_unconfirmed and not getattr(rig, "has_lease", True):
            if attempts >= OFF_ATTEMPTS and clock() >= end_s:
                break
            sleep(OFF_PAUSE_S)
            rig.safe()
            attempts += 1
    reported = reported and rig.shutdown_unconfirmed
    confirm_zero(rig)
    if rig.shutdown_unconfirmed and not reported:
        report(rig.shutdown_unconfirmed)
    return rig.shutdown_unconfirmed


def confirm_zero(rig: Any) -> str:
    """After ``safe``: the sentence of a rig that still measures a current; "" if none flows or it does not measure."""
    return rig.confirm_zero() if hasattr(rig, "confirm_zero") else ""


def after_shutdown(error: _Error, rig: SupportsShutdown) -> _Error:
    """The error, with what is known of the current after ``safe``. A source may confirm zero seconds after the error
    said that it did not: a current may have flowed until then.
    """
    late = error.current_text not in ("", AT_ZERO)
    error.current_text = rig.shutdown_unconfirmed or (AT_ZERO_LATE if late else AT_ZERO)
    return error
