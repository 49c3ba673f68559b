"""A channel that no density changes, such as the measured current or the room, as a Gaussian problem.

    y = c_session + e,    e ~ N(0, σ² (1 + r k(t, t′))),    k = e^(−|t − t′|/τ)

c is free; σ, r and τ are the likeliest of the residuals (restricted likelihood). A room fluctuates within minutes, and
what fluctuates must not count as an effect.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from smarig.diagnosis.drive_statistics import CORRELATIONS_S
from smarig.replay import ReadingSeries, Timeline

Array = NDArray[np.float64]
Rows = NDArray[np.int64]
RATIOS = np.concatenate([[0.0], 10.0 ** np.linspace(-1.5, 3.5, 21)])  # r tried
LEAST_NOISE = {"current": 5e-5, "room": 0.005}  # A, K: best instruments


@dataclass(frozen=True, eq=False)
class ChannelModel:
    """Readings of a channel; ``bases`` are (vectors (n, m), values (m,)) of each shape of fluctuations k.

    ``block`` (n,) is the block of each reading; ``span`` the range that a change of it is compared with.
    """

    kind: str
    block: Rows
    bases: tuple[tuple[Array, Array], ...]
    span: float

    def precision(self, residual: Array) -> Array:
        """C⁻¹ (n, n) without the constants, at the likeliest variances of residuals (n,)."""
        best, found = np.inf, np.empty((0, 0))
        for vectors, values in self.bases:
            z2 = (vectors.T @ residual) ** 2
            grown = 1 + RATIOS[:, None] * values
            variance = np.maximum(np.mean(z2 / grown, axis=1), LEAST_NOISE[self.kind] ** 2)
            cost = np.sum(z2 / grown, axis=1) / variance + np.log(grown).sum(axis=1)
            cost += values.size * np.log(variance)
            k = int(np.argmin(cost))
            if cost[k] < best:
                best = float(cost[k])
                found = (vectors / (variance[k] * grown[k])) @ vectors.T
        return found

    def with_kernel(self, kernel: Array, sizes: tuple[float, ...] = (1.0, 10.0, 100.0)) -> "ChannelModel":
        """The same with one more part (n, n) of the fluctuations, of several sizes relative to the others."""
        bases = []
        for vectors, values in self.bases:
            own = (vectors * values) @ vectors.T
            for size in (0.0, *sizes):
                bases.append(_basis(own + size * kernel, vectors @ vectors.T))
        return ChannelModel(self.kind, self.block, tuple(bases), self.span)


def channel_models(timeline: Timeline, input_span_K: float) -> tuple[ChannelModel, ...]:
    """The models of all independent channels, in the order of the timeline's readings."""
    return tuple(_model(r, timeline, input_span_K) for r in timeline.other_readings if r.kind in LEAST_NOISE)


def _model(r: ReadingSeries, timeline: Timeline, input_span_K: float) -> ChannelModel:
    session = timeline.session[r.step]
    same = (session[:, None] == session).astype(float)
    free = np.eye(len(r))
    if r.kind != "current":
        free -= same / same.sum(axis=1)
    distance = np.abs(r.t_s[:, None] - r.t_s)
    bases = tuple(_basis(same * np.exp(-distance / seconds), free) for seconds in CORRELATIONS_S)
    span = input_span_K if r.kind == "room" else float(np.max(np.abs(timeline.drive.value)))
    return ChannelModel(r.kind, timeline.block[r.step], bases, span)


def _basis(kernel: Array, free: Array) -> tuple[Array, Array]:
    """(vectors, values) of a kernel among the changes that the constants leave free; ``free`` is a projection."""
    constants, vectors = eigh(free, check_finite=False)
    kept = vectors[:, constants > 0.5]
    values, inner = eigh(kept.T @ kernel @ kept, check_finite=False)
    return kept @ inner, np.maximum(values, 0.0)
