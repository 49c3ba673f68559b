"""A gain that is high for small errors and low for large ones."""

import numpy as np

from smarig.control.velocity.velocity_controller import MemorylessController, positive
from smarig.core import UsageError


def saturating_gain(least: float = 50.0, most: float = 200.0, width: float = 0.1) -> MemorylessController:
    """ũ = k₁ ė + (k₂ − k₁) sat(ė), sat clipping at ± ``width`` (output unit per second); sector [k₁, k₂].

    Every |ė| ≤ width has the gain k₂; k₁ is the limit for large errors: δ = k₁, γ = k₂. A gain that saturated
    completely (k₁ = 0) would not be strictly passive.

        least (K·s/unit): k₁, the gain of large velocity errors
        most (K·s/unit): k₂, the gain of small velocity errors
        width (unit/s): velocity error up to which the gain is k₂

    >>> law = saturating_gain(1.0, 5.0, width=0.1)
    >>> law.delta, law.gamma, round(law.start(0.1).output(2.0), 12)
    (1.0, 5.0, 2.4)
    """
    k1, k2, w = (positive(n, v) for n, v in (("least", least), ("most", most), ("width", width)))
    if k1 > k2:
        raise UsageError(f"A saturating gain needs least ≤ most, got {k1:g} and {k2:g}.")

    def law(_: int, error: float) -> float:
        return k1 * error + (k2 - k1) * min(max(error, -w), w)

    return MemorylessController(law, k1, k2, lambda: (np.array([w * 10.0**k]) for k in range(13)))
