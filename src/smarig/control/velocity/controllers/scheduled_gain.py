"""A scheduled gain."""

from collections.abc import Callable, Iterator

import numpy as np

from smarig.control.velocity.velocity_controller import MemorylessController, positive
from smarig.core import UsageError

_PROBED_SAMPLES = 4096
_SWITCH_SAMPLES = 50


def alternating(sample: int) -> float:
    """The default schedule: smallest and largest gain in turn, fifty samples each."""
    return float("inf") if sample // _SWITCH_SAMPLES % 2 else 0.0


def scheduled_gain(
    least: float = 50.0, most: float = 200.0, schedule: Callable[[int], float] = alternating
) -> MemorylessController:
    """ũ_k = k(σ_k) ė_k with k₁ ≤ k(σ) ≤ k₂ for any σ; ``schedule`` gives the gain of a sample.

    The law has no memory in ė, so ė ũ ≥ k₁ ė² and |ũ| ≤ k₂ |ė| at every sample: δ = k₁ and γ = k₂ for every schedule,
    also one that depends on positions, time or earlier samples. Gains outside [k₁, k₂] are clipped.

        least (K·s/unit): k₁, the smallest gain of the schedule
        most (K·s/unit): k₂, the largest gain of the schedule

    >>> by_turns = scheduled_gain(1.0, 4.0, lambda k: 1.0 if k % 2 else 4.0)
    >>> by_turns.delta, by_turns.gamma
    (1.0, 4.0)
    """
    k1, k2 = positive("least", least), positive("most", most)
    if k1 > k2:
        raise UsageError(f"A scheduled gain needs least ≤ most, got {k1:g} and {k2:g}.")

    def gain(sample: int) -> float:
        return min(max(schedule(sample), k1), k2)

    def impulses() -> Iterator[np.ndarray]:
        gains = np.array([gain(k) for k in range(_PROBED_SAMPLES)])
        for where in (int(gains.argmin()), int(gains.argmax())):
            yield np.eye(1, where + 1, where)[0]

    return MemorylessController(lambda sample, error: gain(sample) * error, k1, k2, impulses)
