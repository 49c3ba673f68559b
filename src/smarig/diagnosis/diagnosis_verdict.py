"""The verdict of a diagnosis: silent, named, ambiguous, unknown or not identifiable.

P(explanation) ∝ exp(−lead / T),    T² = T₀² + T_e²,    T_e: a hundredth of the gain of the best, at most 10 nats

``lead``: nats behind the best. T₀ is chosen, to be tuned on sealed boxes. Equations and time steps are approximations:
of a gain of a thousand nats, a dozen decides nothing.
"""

from dataclasses import dataclass
from math import exp, hypot, inf
from typing import Literal

from smarig.diagnosis.critique.critique import CandidateScore, Critique
from smarig.diagnosis.explain.search import SearchLevel

VerdictWord = Literal["silent", "named", "ambiguous", "unknown", "not_identifiable"]
LEAD_SCALE_NATS = 4.0  # nats: T₀
EQUATION_SHARE, MOST_EQUATION_NATS = 0.01, 10.0  # of the gain, and at most: T_e
SET_PROBABILITY = 0.9  # least probability of the set
GENERIC_ADVANTAGE = 1.5  # factor by which a variable must explain more than any effect
MIN_GENERIC_NATS = 30.0  # nats beyond chance for the verdict "unknown"
MIN_REMAINDER_NATS = (
    50.0  # nats: the same for residuals of a named effect, where errors of the time steps count
)


@dataclass(frozen=True)
class DiagnosisVerdict:
    """The word; explanations (tuples of effect names) with probabilities, likeliest first; a variable if unknown.

    ``names`` is the set: all effects of the explanations that together reach ``SET_PROBABILITY``. ``compatible``: those
    that a model which is wrong in other ways leaves as candidates; None if it restricts nothing.
    """

    word: VerdictWord
    explanations: tuple[tuple[tuple[str, ...], float], ...] = ()
    depends_on: str | None = None
    compatible: tuple[str, ...] | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """Effects of the likeliest explanations that cover ``SET_PROBABILITY``, or the compatible ones."""
        if self.compatible is not None:
            return self.compatible
        found: dict[str, None] = {}
        total = 0.0
        for names, p in self.explanations:
            if total >= SET_PROBABILITY:
                break
            found |= dict.fromkeys(names)
            total += p
        return tuple(found)

    def probability(self, name: str) -> float:
        """The probability of an effect: the sum over the explanations that contain it."""
        return sum(p for names, p in self.explanations if name in names)


def decide_verdict(first: Critique, levels: list[SearchLevel]) -> DiagnosisVerdict:
    """The verdict on a first critique and the levels of explanations that passed the search's gate."""
    variable = _variable(first)
    if first.silent:
        return DiagnosisVerdict("silent" if _anything_visible(first) else "not_identifiable")
    if not levels:
        return (
            DiagnosisVerdict("unknown", depends_on=_name(variable))
            if variable
            else DiagnosisVerdict("silent")
        )
    explanations = _probabilities(levels[-1])
    unexplained = _unexplained_variable(first, levels)
    if unexplained:
        return DiagnosisVerdict("unknown", explanations, _name(variable or unexplained))
    verdict = DiagnosisVerdict("named", explanations)
    return (
        verdict
        if set(verdict.names) == set(explanations[0][0])
        else DiagnosisVerdict("ambiguous", explanations)
    )


def lead_scale_nats(gain: float) -> float:
    """T, the nats that are a factor e in the score, for a gain (nats) of the best explanation."""
    return hypot(LEAD_SCALE_NATS, min(EQUATION_SHARE * gain, MOST_EQUATION_NATS))


def _anything_visible(critique: Critique) -> bool:
    return any(s.candidate.traces.shape[1] for s in critique.scores if not s.candidate.generic)


def _name(score: CandidateScore | None) -> str | None:
    return score.candidate.depends_on if score else None


def _variable(critique: Critique) -> CandidateScore | None:
    """The variable that explains most beyond chance, or None if none explains enough."""
    best = critique.best(1, generic=True)
    return (
        best[0]
        if best and best[0].net >= MIN_GENERIC_NATS and best[0].standard > critique.threshold
        else None
    )


def _unexplained_variable(first: Critique, levels: list[SearchLevel]) -> CandidateScore | None:
    """A plain variable that explains much more than any effect, at first or in the residuals of the best
    explanation.
    """
    data, variable = first.refitted.data, _variable(first)
    if variable:
        plain = (
            0.5 * float(variable.candidate.explained_share(data)[0]) * float(data @ data) - variable.median
        )
        if plain > GENERIC_ADVANTAGE * max(levels[0].linear_gain, levels[0].gain):
            return variable
    remainder, best_effect = _variable(levels[-1].critique), levels[-1].critique.best(1)
    required_nats = max(MIN_REMAINDER_NATS, GENERIC_ADVANTAGE * (best_effect[0].net if best_effect else 0.0))
    return remainder if remainder and remainder.net > required_nats else None


def _probabilities(level: SearchLevel) -> tuple[tuple[tuple[str, ...], float], ...]:
    best: dict[tuple[str, ...], float] = {}
    for k, found in enumerate(level.explanations):
        best[found.names] = min(best.get(found.names, inf), level.lead(k))
    scale = lead_scale_nats(level.gain)
    weights = {names: exp(-lead / scale) for names, lead in best.items()}
    total = sum(weights.values())
    return tuple(sorted(((n, w / total) for n, w in weights.items()), key=lambda item: -item[1]))
