"""The weights of hypotheses, and from them the probability of every cause.

    w_H ∝ E_a [ softmax_H ( log prior_H + Σ_b a_b s_Hb / T ) ],     a ~ B · Dirichlet(1, …, 1) over the B blocks

The Bayesian bootstrap over blocks says how far the choice of blocks decides (pseudo-BMA+, Yao et al., Bayesian Analysis
13 (2018) 917). The prior is ½ on nothing; single parts share most of the rest, pairs what remains. A dependence on a
variable describes and is no cause: what an effect explains as well is the effect's, so each counts ``PRIOR_VARIABLE``.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from smarig.core import Array
from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis, Part

PRIOR_NOTHING, PRIOR_SINGLE, PRIOR_PAIR = 0.5, 0.4, 0.1
PRIOR_VARIABLE = 0.1
TEMPERATURE = 3.0  # readings of a block share errors of the model, so their scores count less
# what the prior of a pair takes: less is no lead
PAIR_NATS = TEMPERATURE * float(np.log(PRIOR_SINGLE / PRIOR_PAIR))
DRAWS = 1000
CREDIBLE = 0.95


@dataclass(frozen=True, eq=False)
class Weights:
    """Hypotheses with their ``weight`` (H,); ``shares`` (draws, B) are the resampled weights of the blocks.

    ``acts_through``: the variables of each effect.
    """

    hypotheses: tuple[ComparedHypothesis, ...]
    weight: Array
    shares: Array
    temperature: float = TEMPERATURE
    acts_through: Mapping[Part, tuple[Part, ...]] = field(default_factory=dict)

    @property
    def nothing(self) -> float:
        """The probability that the plain model lacks nothing."""
        return float(sum(w for h, w in zip(self.hypotheses, self.weight) if not h.parts))

    @cached_property
    def causes(self) -> dict[Part, float]:
        """The probability of each part, summed over the hypotheses that hold it, likeliest first."""
        total: dict[Part, float] = {}
        for h, w in zip(self.hypotheses, self.weight.tolist()):
            for part in h.parts:
                total.setdefault(part, 0.0)
            for part in self.credited(h):
                total[part] = total.get(part, 0.0) + w
        return dict(sorted(total.items(), key=lambda item: -item[1]))

    def credited(self, hypothesis: ComparedHypothesis) -> tuple[Part, ...]:
        """The parts whose cause a hypothesis supports: of a variable, the effect through it that is likelier.

        A law of the variable describes what that effect does; with its many values it is never far behind.
        """
        variable, *others = hypothesis.parts or (None,)
        if variable is None or others or variable.kind != "variable":
            return hypothesis.parts
        through = [p for p in self._alone if variable in self.acts_through.get(p, ())]
        best = max(through, key=lambda p: self._alone[p], default=variable)
        return (best,) if self._alone[best] > self._alone[variable] else hypothesis.parts

    @cached_property
    def _alone(self) -> dict[Part, float]:
        """The weight of each part alone."""
        return {h.parts[0]: w for h, w in zip(self.hypotheses, self.weight.tolist()) if len(h.parts) == 1}

    def best_with(self, part: Part) -> ComparedHypothesis:
        """The heaviest hypothesis that holds a part."""
        holders = [(w, h) for h, w in zip(self.hypotheses, self.weight.tolist()) if part in h.parts]
        return max(holders, key=lambda pair: pair[0])[1]

    def without_states(self) -> "Weights":
        """The same without what fits the hypotheses again, which is large."""
        bare = [replace(h, trials=tuple(replace(t, state=None) for t in h.trials)) for h in self.hypotheses]
        return replace(self, hypotheses=tuple(bare))

    @property
    def heaviest(self) -> ComparedHypothesis:
        """The hypothesis of largest weight."""
        return self.hypotheses[int(self.weight.argmax())]


def weigh(
    hypotheses: Sequence[ComparedHypothesis],
    seed: int = 0,
    temperature: float = TEMPERATURE,
    acts_through: Mapping[Part, tuple[Part, ...]] | None = None,
) -> Weights:
    """The weights of hypotheses that are scored on the same blocks; exactly one of them has no parts."""
    scores = np.array([h.log_scores for h in hypotheses])
    blocks = scores.shape[1]
    shares = np.random.default_rng(seed).dirichlet(np.ones(blocks), DRAWS) * blocks
    log_weight = shares @ scores.T / temperature + _log_prior(hypotheses)
    weight = np.exp(log_weight - log_weight.max(axis=1, keepdims=True))
    weight /= weight.sum(axis=1, keepdims=True)
    return Weights(tuple(hypotheses), weight.mean(axis=0), shares, temperature, acts_through or {})


def _log_prior(hypotheses: Sequence[ComparedHypothesis]) -> Array:
    parts = np.array([min(len(h.parts), 2) for h in hypotheses])
    prior = np.array([PRIOR_NOTHING, PRIOR_SINGLE, PRIOR_PAIR])
    count = np.maximum(np.bincount(parts, minlength=3), 1)
    # pairs that could be tried: the best two, each with all others
    count[2] = max(count[2], 2 * (count[1] - 1))
    variables = np.array([sum(p.kind == "variable" for p in h.parts) for h in hypotheses])
    return np.log(prior / count)[parts] + variables * np.log(PRIOR_VARIABLE)
