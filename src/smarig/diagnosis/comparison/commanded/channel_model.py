"""A channel that no density changes, such as the measured current or the room, as a Gaussian problem.

    y = c_session + e,    e ~ N(0, σ² (1 + r k(t, t′))),    k = e^(−|t − t′|/τ)

c is free; σ, r and τ are the likeliest of the residuals (restricted likelihood). A room fluctuates within minutes, and
what fluctuates must not count as an effect. A measured current scatters about the current that flows, r = 0.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from smarig.core import Array
from smarig.diagnosis.drive_statistics import CORRELATIONS_S
from smarig.replay import ReadingSeries, Timeline

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

    def with_kernels(
        self, kernels: Sequence[Array], sizes: tuple[float, ...] = (1.0, 10.0, 100.0)
    ) -> "ChannelModel":
        """The same with any of these parts (n, n) of the fluctuations, of several sizes relative to the others."""
        bases = list(self.bases)
        for vectors, values in self.bases:
            own = (vectors * values) @ vectors.T
            added = sizes if np.any(values) else sizes[:1]  # alone, its size is that of the fluctuations
            bases += [_basis(own + s * k, vectors @ vectors.T) for k in kernels for s in added]
        return ChannelModel(self.kind, self.block, tuple(bases), self.span)


def channel_models(timeline: Timeline, input_span_K: float) -> tuple[ChannelModel, ...]:
    """The models of all independent channels, in the order of the timeline's readings."""
    return tuple(_model(r, timeline, input_span_K) for r in timeline.other_readings if r.kind in LEAST_NOISE)


def _model(r: ReadingSeries, timeline: Timeline, input_span_K: float) -> ChannelModel:
    session = timeline.session[r.step]
    same = (session[:, None] == session).astype(float)
    block = timeline.block[r.step]
    if r.kind == "current":
        bases = (_basis(np.zeros_like(same), np.eye(len(r))),)
        return ChannelModel(r.kind, block, bases, float(np.max(np.abs(timeline.drive.value))))
    free = np.eye(len(r)) - same / same.sum(axis=1)
    bases = tuple(_basis(same * k, free) for k in fluctuations(r.t_s))
    return ChannelModel(r.kind, block, bases, input_span_K)


def fluctuations(t_s: Array) -> list[Array]:
    """The shapes (n, n) of fluctuations within minutes."""
    distance = np.abs(t_s[:, None] - t_s)
    return [np.exp(-distance / seconds) for seconds in CORRELATIONS_S]


def _basis(kernel: Array, free: Array) -> tuple[Array, Array]:
    """(vectors, values) of a kernel among the changes that the constants leave free; ``free`` is a projection."""
    constants, vectors = eigh(free, check_finite=False)
    kept = vectors[:, constants > 0.5]
    values, inner = eigh(kept.T @ kernel @ kept, check_finite=False)
    return kept @ inner, np.maximum(values, 0.0)
