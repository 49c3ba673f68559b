"""The strength of an effect by evidence alone: how likely all readings are at strengths around it.

    E(s) = log p(readings | s, a density of its own at s),    s* at its top,    sd = (−E″)^(−1/2) there

from parabolas through what was tried. A fit beside one density says too little: that density has taken up part of
what another strength would do. Knows neither effects nor verdicts.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

MOST = 8  # strengths tried, in all
FIRST = 2.0  # of the sd that was guessed: how far the first are away
FARTHER = 1.8  # times as far, where the top lies beyond
CLOSE = 0.3  # sd: nearer to a strength that was tried no other is
TELLING = 1.0  # nats: neighbours that differ less tell no curvature
NEAR = 12.0  # nats: what lies lower tells little of the top

Evidence = Callable[[float], tuple[float, Any]]


@dataclass(frozen=True, eq=False)
class Top:
    """The likeliest strength tried, its evidence, what belongs to it, and the sd, inf where that was not found."""

    strength: float
    evidence: float
    at: Any
    sd: float


def top(evidence: Evidence, start: Top, bounds: tuple[float, float]) -> Top:
    """From a start, whose ``sd`` is a guess, to the top between bounds.

    ``evidence`` gives the nats of a strength and what belongs to it.

    >>> found = top(lambda s: (-2.0 * (s - 3.0) ** 2, None), Top(2.0, -2.0, None, 0.1), (0.0, 10.0))
    >>> round(found.strength, 6), round(found.sd, 6)
    (3.0, 0.5)
    """
    tried: dict[float, tuple[float, Any]] = {start.strength: (start.evidence, start.at)}
    wanted: list[float] = [start.strength - FIRST * start.sd, start.strength + FIRST * start.sd]
    while wanted and len(tried) < MOST:
        for s in np.clip(wanted, *bounds).tolist():
            if s not in tried:
                tried[s] = evidence(s)
        wanted = [s for s in _next(tried) if float(np.clip(s, *bounds)) not in tried]
    best = max(tried, key=lambda s: tried[s][0])
    return Top(best, *tried[best], _sd(tried))


def _next(tried: dict[float, tuple[float, Any]]) -> list[float]:
    """Strengths worth trying: beyond an end that is best, farther out where nothing tells, else a parabola's top."""
    s = np.array(sorted(tried))
    E = np.array([tried[x][0] for x in s.tolist()])
    k = int(np.argmax(E))
    if k == 0 or k == s.size - 1:
        inner = s[1] if k == 0 else s[-2]
        return [float(s[k] + FARTHER * (s[k] - inner))]
    if E[k] - E.min() < TELLING:
        return [float(s[k] + 2 * (end - s[k])) for end in (s[0], s[-1])]
    curve = np.polyfit(s[k - 1 : k + 2] - s[k], E[k - 1 : k + 2], 2)
    away, sd = -curve[1] / (2 * curve[0]), (-2 * curve[0]) ** -0.5
    return [float(s[k] + away)] if abs(away) > CLOSE * sd else []


def _sd(tried: dict[float, tuple[float, Any]]) -> float:
    """By least squares through all that is near the top, or its neighbours."""
    s = np.array(sorted(tried))
    E = np.array([tried[x][0] for x in s.tolist()])
    k = int(np.argmax(E))
    near = E[k] - NEAR < E
    near[max(k - 1, 0) : k + 2] = True
    if np.sum(near) < 3:
        return float("inf")
    bend = np.polyfit(s[near] - s[k], E[near] - E[k], 2)[0]
    return float((-2 * bend) ** -0.5) if bend < 0 else float("inf")
