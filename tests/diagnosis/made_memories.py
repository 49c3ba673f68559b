"""Trajectories made by hand: a path of the hysteresis input, and the operator's memory at every point of it."""

import numpy as np

from smarig.preisach.operator import Initial, Preisach
from smarig.replay import Prediction


def prediction_for_inputs(hysteresis, inputs, t_s=None, initial: Initial = "negative"):
    """Each input is one tick, and every tick is read."""
    operator = Preisach(hysteresis, initial)
    states = []
    for u in inputs:
        operator.step(u)
        states.append(operator.state)
    n = len(inputs)
    t = np.arange(1.0, n + 1) if t_s is None else np.asarray(t_s, dtype=float)
    output = np.array([s.y for s in states])
    at = np.array([s.u for s in states])  # as a retelling has it: what the operator kept
    return Prediction({}, t, at, tuple(states), output, np.arange(n), np.ones(n))
