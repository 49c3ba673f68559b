"""Constant gain."""

import numpy as np

from smarig.control.velocity.velocity_controller import MemorylessController, positive


def constant_gain(gain: float = 100.0) -> MemorylessController:
    """ũ = k ė: δ = γ = k, the thesis's proportional controller (§8.2).

        gain (K·s/unit): k, input over velocity error

    >>> constant_gain(3.0).delta, constant_gain(3.0).gamma
    (3.0, 3.0)
    """
    k = positive("gain", gain)
    return MemorylessController(lambda _, error: k * error, k, k, lambda: [np.array([1.0])])
