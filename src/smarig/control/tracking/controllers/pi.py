"""The baseline: proportional and integral action on the position error, in kelvin of steady temperature."""

from smarig.control.tracking.known import Controller, Known, Wanted
from smarig.control.tracking.lag import clipped

RANGES = {"gain_share": (0.05, 100.0), "integral_s": (0.1, 200.0)}


def pi(
    known: Known,
    wanted: Wanted,
    *,
    gain_share: float = 20.0,
    integral_s: float = 1.3,
    lead_s: float = 0.0,
) -> Controller:
    """s = k (e + ∫e dt/T_i): the source s in kelvin, e = wanted − position, both directions alike.

    k is ``gain_share`` times the range of temperatures over that of positions, T_i is ``integral_s``; with
    ``lead_s`` the error is taken to what is wanted so long from now, which a plain loop does not know. Conditional
    integration: nothing is added while the source is at an end of its range and the error would push it further.
    """
    setup = known.setup
    low, high = known.reach
    gain = gain_share * (setup.upper_K - setup.lower_K) / (high - low)
    whole_K = 0.0
    sample = yield setup.current_for(clipped(setup, 0.0))
    while True:
        error = wanted(sample.t_s + lead_s) - sample.position
        asked_K = whole_K + gain * error
        given_K = clipped(setup, asked_K)
        if (asked_K - given_K) * error <= 0:
            whole_K += gain * error * setup.period_s / integral_s
        sample = yield setup.current_for(given_K)
