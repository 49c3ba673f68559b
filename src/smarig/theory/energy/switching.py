"""The work of switching one weighted relay (thesis §7.1.1, Table 7.1).

A relay (α, β) of density μ changes the output by 2μ. The work ∫ u dy is done at the threshold:

    q_α = 2μα (up),    q_β = −2μβ (down),    q_α + q_β = 2μ(α − β) (one cycle).

For a relay of finite mass m replace μ by m: its output changes from −m to +m. A reversible relay (α = β, in the part g)
returns all the work. Work has units of output times input.
"""

import numpy as np
from numpy.typing import ArrayLike

from smarig.core import Array


def work_up(mu: ArrayLike, alpha: ArrayLike) -> Array:
    """q_α = 2μα: work done on a relay as the input rises past α. Broadcasts.

    >>> float(work_up(0.5, 80.0)), float(work_up(0.5, -80.0))     # the second one drives the input
    (80.0, -80.0)
    """
    return np.multiply(2.0, mu) * np.asarray(alpha, dtype=float)


def work_down(mu: ArrayLike, beta: ArrayLike) -> Array:
    """q_β = −2μβ: work done on a relay as the input falls past β. Broadcasts."""
    return np.multiply(-2.0, mu) * np.asarray(beta, dtype=float)


def loss_per_cycle(mu: ArrayLike, alpha: ArrayLike, beta: ArrayLike) -> Array:
    """q_α + q_β = 2μ(α − β): the area of the relay's own loop."""
    return work_up(mu, alpha) + work_down(mu, beta)


def recoverable(mu: ArrayLike, alpha: ArrayLike, beta: ArrayLike, on: ArrayLike) -> Array:
    """Energy that a relay returns at its next switch, Table 7.1 (μ ≥ 0): −q_β in Q₁ when on, −q_α in Q₃ when off.

    Relays of Q₂ (β ≤ 0 ≤ α) only take up energy. For α, β > 0 a relay in state −1 stores nothing, and so on.
    """
    a, b = np.asarray(alpha, dtype=float), np.asarray(beta, dtype=float)
    stored = np.where(np.asarray(on), np.maximum(b, 0.0), np.maximum(-a, 0.0))
    return np.multiply(2.0, mu) * stored
