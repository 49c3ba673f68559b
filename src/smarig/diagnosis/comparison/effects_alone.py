"""Whether effects are enough, or leave a dependence on a variable beside them."""

from dataclasses import replace

from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis
from smarig.diagnosis.comparison.verdict_rules import VerdictEvidence
from smarig.diagnosis.comparison.weights import Weights
from smarig.diagnosis.refit.reading_noise import EFFECT_ERROR_SHARE


def with_effects_alone(e: VerdictEvidence, weights: Weights) -> VerdictEvidence:
    """Evidence with the probability of hypotheses of effects only, among those that hold an effect.

    A variable beside an effect takes no name away if it changes too little to be told, less than it leaves, or no more
    than the equation of the effect is wrong.
    """

    def alone(h: ComparedHypothesis) -> bool:
        effect = max((e.size[p] for p in h.parts if p.kind == "effect"), default=0.0)
        least = max(e.least_size, EFFECT_ERROR_SHARE * effect)
        return all(p.kind == "effect" or e.size[p] < max(least, e.rest(p)) for p in h.parts)

    with_effect = [
        (w, alone(h))
        for h, w in zip(weights.hypotheses, weights.weight.tolist())
        if any(p.kind == "effect" for p in h.parts)
    ]
    total = sum(w for w, _ in with_effect)
    return replace(
        e, effects_alone=sum(w for w, by_effects in with_effect if by_effects) / total if total else 1.0
    )
