"""Switching a source off, and why its current may flow on nevertheless."""

import contextlib
from collections.abc import Callable
from typing import Any

from smarig.core import error_text, renew_watch, shown
from smarig.device import current_after_off
from smarig.rig.shutdown import NOT_CONFIRMED


class SourceShutdown:
    """``order_off`` and ``measure`` never raise; ``unconfirmed`` tells why the source may still be on, "" if it is off.

    ``tolerance_A``: a smaller current is the offset of a measurement; ``pause``: until another reading.
    """

    def __init__(self, source: Any, tolerance_A: float, pause: Callable[[], None]) -> None:
        self._source, self._tolerance_A, self._pause = source, tolerance_A, pause
        self.unconfirmed = ""
        self._still_measured = ""  # the sentence about a current that did not end

    def order_off(self) -> bool:
        """Order zero current; whether the source confirms it."""
        self.unconfirmed = NOT_CONFIRMED  # also if a signal or a driver cuts it off
        renew_watch()
        try:
            self.unconfirmed = self._source.off()
            if not isinstance(self.unconfirmed, str):
                raise TypeError(f"off returned {shown(self.unconfirmed)}, which is not a text")
        except BaseException as error:  # SystemExit of a library, too: the current must end
            self.unconfirmed = f"{NOT_CONFIRMED} The driver says: {error_text(error)}."
        return not self.unconfirmed

    def measure(self) -> str:
        """After a confirmed ``order_off``: a sentence if a current is still measured, as a set-point does not tell."""
        if self.unconfirmed:
            return ""
        flows_A = 0.0
        # whatever a driver raises: the source has confirmed that it is off, and need not measure
        with contextlib.suppress(BaseException):
            flows_A = current_after_off(
                self._source.measured_A, self._source.off, self._tolerance_A, self._pause
            )
        flows = abs(flows_A) > self._tolerance_A  # a reading that is no number shows nothing
        text = f"{abs(flows_A):.2g} A is still measured: switch it off by hand now." if flows else ""
        self._still_measured = (self._still_measured or text) if text else ""  # one sentence for one fault
        self.unconfirmed = self._still_measured
        return self._still_measured
