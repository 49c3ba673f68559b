"""Where an input that depends on its own output comes to rest: the first root on a monotone move.

    u = f(u),    sought from the present u along the direction in which f drives it

Feedback against the move has one root before where the output would stand still; feedback with the move is followed
step by step, so an avalanche ends where it first finds hold. Knows no physics.
"""

from collections.abc import Callable

TOLERANCE_K = 1e-6  # K
MAX_ITERATIONS = 60
EQUAL_STEPS, STEP_GROWTH = 10, 1.5


def self_consistent_input(drive: Callable[[float], float], u: float, drive_at_u: float) -> float:
    """The input at which ``drive``, f(u) − u, vanishes first, from ``u`` where it is ``drive_at_u``.

    >>> round(self_consistent_input(lambda u: 10.0 - 2.5 * u, 0.0, 10.0), 5)
    4.0
    """
    if abs(drive_at_u) < TOLERANCE_K:
        return u
    other, drive_at_other = u + drive_at_u, drive(u + drive_at_u)
    for k in range(MAX_ITERATIONS):  # with the move: it goes on, in the end by longer and longer steps
        if drive_at_other * drive_at_u <= 0 or abs(drive_at_other) < TOLERANCE_K:
            break
        u, drive_at_u = other, drive_at_other
        other = u + drive_at_u * STEP_GROWTH ** max(0, k - EQUAL_STEPS)
        drive_at_other = drive(other)
    return (
        _bracketed_root(drive, u, drive_at_u, other, drive_at_other)
        if drive_at_other * drive_at_u < 0
        else other
    )


def _bracketed_root(
    drive: Callable[[float], float], u: float, drive_at_u: float, other: float, drive_at_other: float
) -> float:
    """The root between two inputs, by the Illinois variant of false position."""
    new = other
    for _ in range(MAX_ITERATIONS):
        new = (u * drive_at_other - other * drive_at_u) / (drive_at_other - drive_at_u)
        drive_at_new = drive(new)
        if abs(drive_at_new) < TOLERANCE_K or abs(other - u) < TOLERANCE_K:
            return new
        if drive_at_new * drive_at_other < 0:
            u, drive_at_u = other, drive_at_other
        else:
            drive_at_u *= 0.5
        other, drive_at_other = new, drive_at_new
    return new
