"""The strength of an effect by evidence alone: the likelihood of all readings at strengths around the best.

    E(s) = log p(readings | s, a density of its own at s),    s* at its top,    sd = (−E″)^(−1/2) there

E is interpolated by parabolas through the strengths tried. A fit with one fixed density underestimates the change,
because that density has already absorbed part of the effect of another strength.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

MAX_TRIED = 8  # strengths tried in total
FIRST_STEP_SD = 2.0  # guessed sds: distance of the first strengths
EXTENSION = 1.8  # factor of the distance if the maximum lies beyond
MIN_STEP_SD = 0.3  # sds: least distance between strengths tried
MIN_DROP_NATS = 1.0  # nats: smaller differences determine no curvature
FIT_RANGE_NATS = 12.0  # nats below the maximum: strengths that are fitted

EvidenceFunction = Callable[[float], tuple[float, Any]]


@dataclass(frozen=True, eq=False)
class EvidenceMaximum:
    """The likeliest strength tried, its evidence, its payload, and its sd (inf if not found)."""

    strength: float
    evidence: float
    at: Any
    sd: float


def maximise_evidence(
    evidence: EvidenceFunction, start: EvidenceMaximum, bounds: tuple[float, float]
) -> EvidenceMaximum:
    """Maximise the evidence between bounds, from a start whose ``sd`` is a guess.

    ``evidence`` returns the nats of a strength and its payload.

    >>> start = EvidenceMaximum(2.0, -2.0, None, 0.1)
    >>> found = maximise_evidence(lambda s: (-2.0 * (s - 3.0) ** 2, None), start, (0.0, 10.0))
    >>> round(found.strength, 6), round(found.sd, 6)
    (3.0, 0.5)
    """
    tried: dict[float, tuple[float, Any]] = {start.strength: (start.evidence, start.at)}
    wanted: list[float] = [
        start.strength - FIRST_STEP_SD * start.sd,
        start.strength + FIRST_STEP_SD * start.sd,
    ]
    while wanted and len(tried) < MAX_TRIED:
        for s in np.clip(wanted, *bounds).tolist():
            if s not in tried:
                tried[s] = evidence(s)
        wanted = [s for s in _next(tried) if float(np.clip(s, *bounds)) not in tried]
    best = max(tried, key=lambda s: tried[s][0])
    return EvidenceMaximum(best, *tried[best], _sd(tried))


def _next(tried: dict[float, tuple[float, Any]]) -> list[float]:
    """The next strengths to try: beyond the best end, farther out if the curvature is unknown, else the maximum of
    a parabola.
    """
    s = np.array(sorted(tried))
    E = np.array([tried[x][0] for x in s.tolist()])
    k = int(np.argmax(E))
    if k == 0 or k == s.size - 1:
        inner = s[1] if k == 0 else s[-2]
        return [float(s[k] + EXTENSION * (s[k] - inner))]
    if E[k] - E.min() < MIN_DROP_NATS:
        return [float(s[k] + 2 * (end - s[k])) for end in (s[0], s[-1])]
    curve = np.polyfit(s[k - 1 : k + 2] - s[k], E[k - 1 : k + 2], 2)
    offset, sd = -curve[1] / (2 * curve[0]), (-2 * curve[0]) ** -0.5
    return [float(s[k] + offset)] if abs(offset) > MIN_STEP_SD * sd else []


def _sd(tried: dict[float, tuple[float, Any]]) -> float:
    """The sd by least squares through all strengths near the maximum, or through its neighbours."""
    s = np.array(sorted(tried))
    E = np.array([tried[x][0] for x in s.tolist()])
    k = int(np.argmax(E))
    near = E[k] - FIT_RANGE_NATS < E
    near[max(k - 1, 0) : k + 2] = True
    if np.sum(near) < 3:
        return float("inf")
    curvature = np.polyfit(s[near] - s[k], E[near] - E[k], 2)[0]
    return float((-2 * curvature) ** -0.5) if curvature < 0 else float("inf")
