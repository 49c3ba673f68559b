"""The probability of each cause that a verdict states: the weights, less what may lie outside all hypotheses.

Weights compare hypotheses with one another: if none is true, the least wrong has nearly all of the weight. A verdict
that withholds a name has seen signs of that (``RULES``), so a share of the weight of its effects belongs to causes that
no hypothesis has. How large that share is was counted in boxes whose causes are known.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

from smarig.diagnosis.comparison.compared_hypothesis import Part
from smarig.diagnosis.comparison.verdict_rules import Verdict

# of the effects whose name an unknown verdict withholds, the share that is true: public boxes of all worlds
WITHHELD = 0.5


class Weighed(Protocol):
    """What has weights of causes and of nothing: the weights themselves, or the evidence of a verdict."""

    @property
    def causes(self) -> Mapping[Part, float]: ...
    @property
    def nothing(self) -> float: ...


@dataclass(frozen=True)
class Probabilities:
    """The probability of each cause, likeliest first; of nothing; and of an effect that is ``outside`` the catalogue.

    Causes of one hypothesis count for both, so the sum may exceed 1.
    """

    causes: Mapping[Part, float]
    nothing: float
    outside: float


def probabilities(verdict: Verdict, weighed: Weighed) -> Probabilities:
    """Probabilities from weights; what a verdict names or sets as likely keeps its weight."""
    causes, nothing = weighed.causes, weighed.nothing
    share = 1.0 if verdict.word in ("named", "ambiguous") else WITHHELD
    stated = {p: w * share if p.kind == "effect" else w for p, w in causes.items()}
    effects = max((w for p, w in causes.items() if p.kind == "effect"), default=0.0)
    outside = (1.0 - share) * min(effects, 1.0 - nothing)
    return Probabilities(dict(sorted(stated.items(), key=lambda item: -item[1])), nothing, outside)
