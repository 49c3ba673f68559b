"""The limits of a rig whose current source has no lease: lower, because a current may stay on when the host fails.

A current that stays on must never overheat the wire. Without a lease, the steady temperature of the largest current,

    T_ss = (R/hA) i²  (5.3),        is at most 80 % of limits.temperature_max_K,

which leaves a margin for a room that is warmer, or air that is stiller, than the wire file assumes.
"""

from smarig.config import LimitsFile, RigFile
from smarig.plant import Actuator

LARGEST_SHARE = 0.8  # of the largest permitted temperature, in the steady state
NO_LEASE = "The current source has no lease: if the host fails, only the cut-out stops the current."


def limits_in_force(limits: LimitsFile, actuator: Actuator, *, has_lease: bool) -> LimitsFile:
    """The limits of the rig file, or the lower ones of a rig without a lease."""
    if has_lease:
        return limits
    largest_A = actuator.current_for(LARGEST_SHARE * limits.temperature_max_K)
    return limits.model_copy(
        update={
            "current_max_A": min(limits.current_max_A, largest_A),
            "current_min_A": max(limits.current_min_A, -largest_A),
        }
    )


def without_lease_text(file: RigFile, actuator: Actuator) -> str:
    """What it means for a rig that its source has no lease, in sentences with its figures."""
    limits = limits_in_force(file.limits, actuator, has_lease=False)
    largest_A = max(limits.current_max_A, -limits.current_min_A)
    lowered = (limits.current_max_A, limits.current_min_A) != (
        file.limits.current_max_A,
        file.limits.current_min_A,
    )
    steady_K = abs(actuator.input_for(largest_A))
    what = f"limited to {largest_A:.4g} A" if lowered else f"at most {largest_A:.4g} A"
    return (
        f"{NO_LEASE} The current is {what}, which heats the wire to {steady_K:.4g} K above ambient if it stays on "
        f"(limit {file.limits.temperature_max_K:g} K)."
    )
