"""Where an input that depends on its own output comes to rest: the first root on a monotone move.

    u = f(u),    sought from the present u along the direction in which f drives it

Feedback against the move has one root before where the output would stand still; feedback with the move is followed
step by step, so an avalanche ends where it first finds hold. Knows no physics.
"""

from collections.abc import Callable

EXACT = 1e-6  # K
MOST = 60
PATIENCE, LONGER = 10, 1.5


def agreed(drive: Callable[[float], float], u: float, at_u: float) -> float:
    """The input at which ``drive``, f(u) − u, vanishes first, from ``u`` where it is ``at_u``.

    >>> round(agreed(lambda u: 10.0 - 2.5 * u, 0.0, 10.0), 5)
    4.0
    """
    if abs(at_u) < EXACT:
        return u
    other, at_other = u + at_u, drive(u + at_u)
    for k in range(MOST):  # with the move: it goes on, in the end by longer and longer steps
        if at_other * at_u <= 0 or abs(at_other) < EXACT:
            break
        u, at_u = other, at_other
        other = u + at_u * LONGER ** max(0, k - PATIENCE)
        at_other = drive(other)
    return _between(drive, u, at_u, other, at_other) if at_other * at_u < 0 else other


def _between(drive: Callable[[float], float], u: float, at_u: float, other: float, at_other: float) -> float:
    """The root between two inputs, by the Illinois variant of false position."""
    new = other
    for _ in range(MOST):
        new = (u * at_other - other * at_u) / (at_other - at_u)
        at_new = drive(new)
        if abs(at_new) < EXACT or abs(other - u) < EXACT:
            return new
        if at_new * at_other < 0:
            u, at_u = other, at_other
        else:
            at_u *= 0.5
        other, at_other = new, at_new
    return new
