"""The verdict of a thermal diagnosis, and the settings of its null data.

P(explanation) ∝ exp(−lead / T),    lead: nats behind the best
"""

from dataclasses import dataclass
from typing import Literal

from smarig.core import UsageError

ALPHA = 0.03
NULLS = 200
LEAST_ALPHA = 0.005  # null data say nothing of rarer alarms
MAX_NULL_DATA_SETS = 100_000  # a larger number is a typing error
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


def check_settings(alpha: float, nulls: int, seed: int) -> None:
    """Raise UsageError for a false alarm probability, a number of null data sets or a seed that cannot be used."""
    if not LEAST_ALPHA <= alpha < 0.5:
        raise UsageError(
            f"The false alarm probability must lie between {LEAST_ALPHA:g} and 0.5, but is {alpha:g}."
        )
    if seed < 0:
        raise UsageError(f"Seed {seed} is negative. Give a whole number ≥ 0.")
    if nulls > MAX_NULL_DATA_SETS:
        raise UsageError(f"{nulls} null data sets are too many. Use at most {MAX_NULL_DATA_SETS}.")
    if nulls < 1 / alpha:
        raise UsageError(
            f"{nulls} null data sets cannot resolve a probability of {alpha:g}. Use at least {int(1 / alpha) + 1}."
        )
