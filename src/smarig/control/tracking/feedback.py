"""Proportional and integral action on the position error, whatever sets the gain; what PI controllers share.

    s = ∫ k e dt/T_i + k e,        e = wanted − position, k in kelvin per unit

Conditional integration: nothing is added while the source s is at an end of its range and the error would push it
further. Knows no schedule.
"""

from collections.abc import Callable

from smarig.control.tracking.known import Controller, Known, Wanted
from smarig.control.tracking.lag import clipped


def feedback(
    known: Known,
    wanted: Wanted,
    gain: Callable[[float, float], float],
    *,
    integral_s: float,
    lead_s: float,
) -> Controller:
    """``gain(error, position)`` in K per unit; the error is taken to what is wanted ``lead_s`` from now."""
    setup = known.setup
    whole_K = 0.0
    sample = yield setup.current_for(clipped(setup, 0.0))
    while True:
        error = wanted(sample.t_s + lead_s) - sample.position
        pushed_K = gain(error, sample.position) * error
        given_K = clipped(setup, whole_K + pushed_K)
        if (whole_K + pushed_K - given_K) * error <= 0:
            whole_K += pushed_K * setup.period_s / integral_s
        sample = yield setup.current_for(given_K)
