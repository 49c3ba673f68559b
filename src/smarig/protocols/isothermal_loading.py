"""The isothermal stress–strain test (thesis 5.1.2): constant temperature while the load of the rig rises and falls."""

import math

from smarig.core import Elapsed, Hold, Mark, Protocol, UsageError
from smarig.protocols._building_blocks import checked_count, checked_inputs
from smarig.protocols._setup import Setup

LONGEST_S = 1e6


def isothermal_loading(
    setup: Setup,
    *,
    input_K: float | None = None,
    lead_s: float = 120.0,
    duration_s: float = 1800.0,
    points: int = 90,
) -> Protocol:
    """Readings at constant current while the load changes: a stress–strain loop, if the load rises and falls.

    The load is that of the rig over time ([load] of the rig file, or ``--load``), as a formula or a file. It should
    stay at its first value for ``lead_s``, in which the wire reaches ``input_K`` above ambient (by default half of the
    rig's range), and then change so slowly that the wire gives off its latent heat. ``points`` readings are taken over
    ``duration_s``; each is the mean of the last samples of its hold. At a current, the temperature follows the
    resistance, so it is constant only at ``input_K`` = 0, in a room or chamber at the temperature of the test.
    """
    checked_count("points", points, 2, 100_000)
    (held_K,) = checked_inputs(setup, [setup.upper_K / 2 if input_K is None else input_K], "input_K")
    for name, seconds in (("lead_s", lead_s), ("duration_s", duration_s)):
        if not 0 < seconds <= LONGEST_S or not math.isfinite(seconds):
            raise UsageError(f"{name} must be positive and at most {LONGEST_S:g}, got {seconds:g}.")
    each_s = duration_s / points
    if each_s < 2 * setup.period_s:
        raise UsageError(
            f"{points} points in {duration_s:g} s leave less than two ticks each. Take fewer points."
        )
    current_A = setup.current_for(held_K)
    yield Mark("isothermal loading", {"input_K": held_K, "points": points, "duration_s": duration_s})
    yield Hold(current_A, Elapsed(lead_s), target=held_K, branch="lead")
    for _ in range(points):
        yield Hold(current_A, Elapsed(each_s), target=held_K, branch="loading")
