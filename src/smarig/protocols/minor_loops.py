"""Minor loops at a chosen period, which show the effect of the heating's lag (Fig. 5.3)."""

from smarig.core import Elapsed, Hold, Mark, Protocol, UsageError, Waveform
from smarig.protocols._setup import Setup

LOW, HIGH = 0.5, 0.75  # of the largest current, by default: the thesis's 0.5 and 0.75 A on its wire


def minor_loops(
    setup: Setup,
    *,
    low_A: float | None = None,
    high_A: float | None = None,
    loops: int = 5,
    loop_s: float = 8.0,
) -> Protocol:
    """Triangular current from zero, then minor loops between two currents (Fig. 5.3, §5.1.3).

    If a loop takes seconds, the wire's temperature lags the current and the loops drift. If a loop takes minutes, the
    loops close. ``loop_s`` is the period of one loop. The first rise takes half of it. The currents are by default a
    half and three quarters of the largest that the limits allow.
    """
    low_A = LOW * setup.largest_A if low_A is None else low_A
    high_A = HIGH * setup.largest_A if high_A is None else high_A
    if not (
        0 <= low_A < high_A and 0 < loop_s <= 86_400 and 1 <= loops <= 1000 and loops * loop_s <= 864_000
    ):
        raise UsageError(
            "minor_loops needs 0 ≤ low_A < high_A, 0 < loop_s ≤ 86400, 1 ≤ loops ≤ 1000, at most ten days in all; got "
            f"{low_A:g}, {high_A:g}, {loop_s:g}, {loops}."
        )
    half = max(1, round(loop_s / 2 / setup.period_s))
    up = [low_A + (high_A - low_A) * (k + 1) / half for k in range(half)]
    first = [high_A * (k + 1) / half for k in range(half)]
    currents = first + (list(reversed(up))[1:] + [low_A] + up) * loops
    yield Mark("minor loops", {"low_A": low_A, "high_A": high_A, "loops": loops, "loop_s": loop_s})
    yield Hold(0.0, Elapsed(8 * setup.tau_s), branch="cool")
    yield Waveform(tuple(currents), setup.period_s, branch="loops")
    yield Hold(0.0, Elapsed(8 * setup.tau_s), branch="cool")
