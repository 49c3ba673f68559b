"""What may be said: silent, a name, a set of names, "unknown, it depends on …", or that these data cannot tell.

    P(explanation) ∝ exp(−lead / T)        lead: nats behind the best;  T: a guess, to be tempered on boxes

Takes decisions from what the search found, and computes nothing of physics.
"""

from dataclasses import dataclass
from math import exp, inf
from typing import Literal

from smarig.diagnosis.critique import Critique, Score
from smarig.diagnosis.search import Level

Word = Literal["silent", "named", "ambiguous", "unknown", "not_identifiable"]
TEMPERATURE = 4.0  # nats
COVERED = 0.9  # probability of the set
BETTER = 1.5  # a variable that explains so much more than any name is no name's
GENERIC_GATE = 30.0  # nats beyond chance for "it depends on"
LEFT_GATE = 50.0  # nats: the same for what is left beside a name, lest the critic's own time steps speak


@dataclass(frozen=True)
class Verdict:
    """The word; explanations (tuples of effect names) with probabilities, likeliest first; a variable if unknown.

    ``names`` is the set: every effect of the explanations that together are likely enough.
    """

    word: Word
    explanations: tuple[tuple[tuple[str, ...], float], ...] = ()
    depends_on: str | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """Effects of the likeliest explanations that cover ``COVERED``."""
        found: dict[str, None] = {}
        total = 0.0
        for names, p in self.explanations:
            if total >= COVERED:
                break
            found |= dict.fromkeys(names)
            total += p
        return tuple(found)

    def probability(self, name: str) -> float:
        """Of an effect: the sum over the explanations it is part of."""
        return sum(p for names, p in self.explanations if name in names)


def decided(first: Critique, levels: list[Level]) -> Verdict:
    """The verdict on a first critique and the levels of explanations that passed the search's gate."""
    variable = _variable(first)
    if first.silent:
        return Verdict("silent" if _anything_seen(first) else "not_identifiable")
    if not levels:
        return Verdict("unknown", depends_on=_name(variable)) if variable else Verdict("silent")
    explanations = _probabilities(levels[-1])
    nameless = _nameless(first, levels)
    if nameless:
        return Verdict("unknown", explanations, _name(variable or nameless))
    verdict = Verdict("named", explanations)
    return verdict if set(verdict.names) == set(explanations[0][0]) else Verdict("ambiguous", explanations)


def _anything_seen(critique: Critique) -> bool:
    return any(s.candidate.traces.shape[1] for s in critique.scores if not s.candidate.generic)


def _name(score: Score | None) -> str | None:
    return score.candidate.depends_on if score else None


def _variable(critique: Critique) -> Score | None:
    """The variable that explains most beyond chance, if any explains enough."""
    best = critique.best(1, generic=True)
    return best[0] if best and best[0].net >= GENERIC_GATE and best[0].standard > critique.threshold else None


def _nameless(first: Critique, levels: list[Level]) -> Score | None:
    """A plain variable that explains much more than any name does: at first, or of what is left when all are in."""
    data, variable = first.refitted.data, _variable(first)
    if variable:
        plain = 0.5 * float(variable.candidate.explained(data)[0]) * float(data @ data) - variable.median
        if plain > BETTER * max(levels[0].rough, levels[0].gain):
            return variable
    left, named = _variable(levels[-1].critique), levels[-1].critique.best(1)
    much = max(LEFT_GATE, BETTER * (named[0].net if named else 0.0))
    return left if left and left.net > much else None


def _probabilities(level: Level) -> tuple[tuple[tuple[str, ...], float], ...]:
    best: dict[tuple[str, ...], float] = {}
    for k, found in enumerate(level.explanations):
        best[found.names] = min(best.get(found.names, inf), level.lead(k))
    weights = {names: exp(-lead / TEMPERATURE) for names, lead in best.items()}
    total = sum(weights.values())
    return tuple(sorted(((n, w / total) for n, w in weights.items()), key=lambda item: -item[1]))
