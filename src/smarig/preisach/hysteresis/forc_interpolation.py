"""The surface through first-order curves in arrays: value and both slopes at many points at once.

Linear along each curve, linear between neighbouring curves at constant β; between the lower curve's peak
and the diagonal, linear at constant β from the major branch to the upper curve. Below the first peak the
surface is the first curve. Knows lines (saturation to peak, nodes rising) and not where they come from.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smarig.preisach.hysteresis.forc_curve import Line

Array = NDArray[np.float64]


class ValueAndSlopes(NamedTuple):
    """y(α, β), ∂y/∂α and ∂y/∂β, broadcast shapes."""

    value: Array
    d_alpha: Array
    d_beta: Array


@dataclass(frozen=True, eq=False)
class ForcInterpolant:
    """All lines end to end. ``key`` rises along them: a line's index times twice the range, plus β."""

    beta: Array
    y: Array
    key: Array
    first: NDArray[np.intp]
    peaks: Array
    stride: float

    @classmethod
    def of(cls, lines: list[Line]) -> "ForcInterpolant":
        """From completed lines in order of rising peaks."""
        lower, upper = lines[0][0][0], lines[-1][0][-1]
        stride = 2 * (upper - lower)
        key = np.concatenate([k * stride + (b - lower) for k, (b, _) in enumerate(lines)])
        first = np.concatenate([[0], np.cumsum([b.size for b, _ in lines])])
        beta, y = (np.concatenate([line[i] for line in lines]) for i in (0, 1))
        return cls(beta, y, key, first, np.array([b[-1] for b, _ in lines]), float(stride))

    def value_and_slopes(self, alpha: ArrayLike, beta: ArrayLike) -> ValueAndSlopes:
        """Value and slopes at (α, β), β ≤ α; on a kink the slopes are those of one side."""
        a, b = np.broadcast_arrays(np.asarray(alpha, dtype=float), np.asarray(beta, dtype=float))
        k = np.clip(np.searchsorted(self.peaks, a), 0, self.peaks.size - 1)
        below = np.maximum(k - 1, 0)
        top, bottom = self.peaks[k], self.peaks[below]
        width = np.where(k > 0, top - bottom, 1.0)
        high, d_high = self._on_line(k, b)
        low, d_low = self._on_line(below, b)
        s = (a - bottom) / width
        rect = ValueAndSlopes(low + s * (high - low), (high - low) / width, d_low + s * (d_high - d_low))
        corner = self._corner(a, b, k, high, d_high)
        near, alone = b > bottom, k == 0
        return ValueAndSlopes(
            np.where(alone | (a >= top), high, np.where(near, corner.value, rect.value)),
            np.where(alone, 0.0, np.where(near, corner.d_alpha, rect.d_alpha)),
            np.where(alone, d_high, np.where(near, corner.d_beta, rect.d_beta)),
        )

    def _corner(self, a: Array, b: Array, k: NDArray[np.intp], high: Array, d_high: Array) -> ValueAndSlopes:
        """The triangle on the diagonal: from the major branch (straight between peaks) to the upper curve."""
        below = np.maximum(k - 1, 0)
        top, bottom = self.peaks[k], self.peaks[below]
        on_top, on_bottom = self.y[self.first[k + 1] - 1], self.y[self.first[below + 1] - 1]
        slope = (on_top - on_bottom) / np.where(k > 0, top - bottom, 1.0)
        rise = high - (on_bottom + slope * (b - bottom))
        reach = np.where(top > b, top - b, 1.0)
        r = (a - b) / reach
        return ValueAndSlopes(
            on_bottom + slope * (b - bottom) + r * rise,
            rise / reach,
            slope + r * (d_high - slope) - rise * (top - a) / reach**2,
        )

    def _on_line(self, k: NDArray[np.intp], b: Array) -> tuple[Array, Array]:
        j = np.searchsorted(self.key, k * self.stride + (b - self.beta[0]), side="right") - 1
        j = np.clip(j, self.first[k], self.first[k + 1] - 2)
        slope = (self.y[j + 1] - self.y[j]) / (self.beta[j + 1] - self.beta[j])
        return self.y[j] + slope * (b - self.beta[j]), slope
