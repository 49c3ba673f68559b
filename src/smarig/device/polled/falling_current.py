"""The current of an output that was switched off: it needs time to fall, and a single reading may be wrong."""

from collections.abc import Callable
from typing import Any

OFF_PAUSE_S = 0.2  # between two readings
MORE_READINGS = 3  # after one that is not zero


def current_after_off(
    measured_A: Callable[[], float], off: Callable[[], Any], tolerance_A: float, pause: Callable[[], None]
) -> float:
    """The current in A that still flows; 0 if it is zero. Raises what the functions raise.

    Only what is above the tolerance in one reading and in ``MORE_READINGS`` more counts, with a pause and another order
    of zero before each.

    >>> readings = iter([0.5, 0.1, 0.0])
    >>> current_after_off(lambda: next(readings), lambda: None, 0.02, lambda: None)
    0.0
    >>> current_after_off(lambda: 0.3, lambda: None, 0.02, lambda: None)
    0.3
    """
    flows_A = float(measured_A())
    for _ in range(MORE_READINGS):
        if abs(flows_A) <= tolerance_A:
            return 0.0
        off()
        pause()
        flows_A = float(measured_A())
    return 0.0 if abs(flows_A) <= tolerance_A else flows_A
