"""Remembered noise: temperature noise at a reversal affects all later outputs until the reversal is wiped out.

    Cov(y_i, y_j) = s₀² δ_ij + s_T² Σ_kl J_ik J_jl e^(−|t_k − t_l|/τ_T)

J are the slopes of an output to the present input and to every remembered extremum (``preisach.sensitivity``). t_k
is the time at which that extremum was reached. Readings of one step share their past.
"""

from bisect import bisect_right

import numpy as np
from scipy.sparse import csr_matrix

from smarig.core import Array
from smarig.preisach import Everett, sensitivities
from smarig.replay import Prediction


def memory_slopes(hysteresis: Everett, prediction: Prediction) -> tuple[csr_matrix, Array]:
    """(J (n, p), times (p,)): slopes of the n positions to the p remembered inputs, and the times of these inputs."""
    ticks_of_input = _ticks_by_input(prediction)
    times: dict[float, int] = {}
    rows, columns, slopes = [], [], []
    session_starts = [prediction.session_starts[session] for session in prediction.session]
    own = sensitivities(hysteresis, prediction.states)
    ends = (hysteresis.lower, hysteresis.upper)  # temperature noise does not change saturation
    for k, (state, slope_of, mark, begin) in enumerate(
        zip(prediction.states, own, prediction.tick_index.tolist(), session_starts)
    ):
        for u, slope in zip((*state.extrema, state.u), slope_of.tolist()):
            t = (
                prediction.t_s[mark]
                if u == state.u
                else _last_time_of(ticks_of_input.get(u, []), begin, mark, prediction.t_s)
            )
            if t is None or u in ends or slope == 0.0:
                continue
            rows.append(k)
            columns.append(times.setdefault(float(t), len(times)))
            slopes.append(slope)
    shape = (len(prediction.states), max(len(times), 1))
    return csr_matrix((slopes, (rows, columns)), shape=shape), np.array(list(times) or [0.0])


def _ticks_by_input(prediction: Prediction) -> dict[float, list[int]]:
    """For each remembered input, its ticks; the same levels recur."""
    remembered = np.array([u for state in prediction.states for u in state.extrema])
    ticks = np.flatnonzero(np.isin(prediction.hysteresis_input_K, remembered))
    ticks_of_input: dict[float, list[int]] = {}
    for k, u in zip(ticks.tolist(), prediction.hysteresis_input_K[ticks].tolist()):
        ticks_of_input.setdefault(u, []).append(k)
    return ticks_of_input


def _last_time_of(ticks: list[int], begin: int, mark: int, t_s: Array) -> float | None:
    """The last time of a remembered input before a mark, in the session that started at a tick."""
    k = bisect_right(ticks, mark) - 1
    return float(t_s[ticks[k]]) if k >= 0 and ticks[k] >= begin else None


def memory_covariance(J: csr_matrix, times_s: Array, correlation_s: float) -> Array:
    """J K Jᵀ, (n, n), per K² of an Ornstein–Uhlenbeck temperature noise."""
    kernel = np.exp(-np.abs(times_s[:, None] - times_s[None, :]) / correlation_s)
    return np.asarray((J @ (J @ kernel).T).T)
