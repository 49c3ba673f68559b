"""Noise that the hysteresis remembers: temperature noise at every reversal is in all that follows, until wiped out.

    Cov(y_i, y_j) = s₀² δ_ij + s_T² Σ_kl J_ik J_jl e^(−|t_k − t_l|/τ_T)

J are the slopes of an output to the present input and to every remembered extremum (``preisach.sensitivity``),
t_k when that extremum was reached. Readings of one step share their past. Knows no fit.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from smarig.preisach.everett import Differentiable
from smarig.preisach.operator import State
from smarig.preisach.sensitivity import sensitivity
from smarig.story.retelling import Retelling

Array = NDArray[np.float64]


def remembered(hysteresis: Differentiable, told: Retelling) -> tuple[csr_matrix, Array]:
    """(J (n, p), times (p,)): slopes of the n positions to the p remembered inputs, and when those were felt."""
    when = [  # by sitting: the last time an input was felt, which is when it was kept
        dict(zip(felt.tolist(), t.tolist()))
        for felt, t in zip(np.split(told.felt_K, told.begins[1:]), np.split(told.t_s, told.begins[1:]))
    ]
    times: dict[float, int] = {}
    rows, columns, slopes = [], [], []
    for k, (state, mark, sitting) in enumerate(zip(told.states, told.marks.tolist(), told.sitting.tolist())):
        for u, slope in _slopes(hysteresis, state):
            t = told.t_s[mark] if u == state.u else when[sitting].get(u)
            if t is None or slope == 0.0:
                continue
            rows.append(k)
            columns.append(times.setdefault(float(t), len(times)))
            slopes.append(slope)
    shape = (len(told.states), max(len(times), 1))
    return csr_matrix((slopes, (rows, columns)), shape=shape), np.array(list(times) or [0.0])


def _slopes(hysteresis: Differentiable, state: State) -> Sequence[tuple[float, float]]:
    """(input, slope) of every remembered extremum and the present input; saturation feels no temperature."""
    inputs = (*state.extrema, state.u)
    ends = (hysteresis.lower, hysteresis.upper)
    return [(u, 0.0 if u in ends else s) for u, s in zip(inputs, sensitivity(hysteresis, state).tolist())]


def propagated(J: csr_matrix, times_s: Array, correlation_s: float) -> Array:
    """J K Jᵀ, (n, n), per K² of an Ornstein–Uhlenbeck temperature noise."""
    kernel = np.exp(-np.abs(times_s[:, None] - times_s[None, :]) / correlation_s)
    return np.asarray((J @ (J @ kernel).T).T)
