"""The verdict of a thermal diagnosis.

P(explanation) ∝ exp(−lead / T),    lead: nats behind the best
"""

from dataclasses import dataclass
from typing import Literal

ALPHA = 0.03
NULLS = 200
LEAD_SCALE_NATS = 4.0  # T
SET_PROBABILITY = 0.9  # least probability of the set


@dataclass(frozen=True)
class ThermalVerdict:
    """The word; explanations (tuples of extensions) with probabilities, likeliest first; a variable if unknown."""

    word: Literal["silent", "named", "ambiguous", "unknown"]
    explanations: tuple[tuple[tuple[str, ...], float], ...] = ()
    depends_on: str | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """The extensions of the likeliest explanations that together reach ``SET_PROBABILITY``."""
        names: dict[str, None] = {}
        total = 0.0
        for explanation, p in self.explanations:
            if total >= SET_PROBABILITY:
                break
            names |= dict.fromkeys(explanation)
            total += p
        return tuple(names)

    def probability(self, name: str) -> float:
        """The probability of an extension: the sum over the explanations that contain it."""
        return sum(p for names, p in self.explanations if name in names)
