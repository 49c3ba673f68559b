"""Measured first-order curves with irregular points as a hysteresis, by interpolation of the FOD data (§3.4).

The interpolation is linear along each curve and, at constant β, linear between neighbouring curves. Between a curve's
peak and the diagonal it is linear from the major branch. For curves on one common partition the result is ``FodTable``.
Magnetic FORCs rise: give them mirrored, (u, y) → (−u, −y), and mirror the result with ``Mirrored``.

Values that were not measured are filled in; ``measured`` identifies them:

* beyond its last point a curve is completed to saturation along its neighbours (``forc_curve``);
* below the first peak there is no curve and no memory is assumed: the output retraces the first curve;
* inputs above the last peak count as positive saturation.

The table passes exactly through the points, so it contains the measured noise, and branches need not be monotone. Drift
between curves is not corrected: on magnetic data, division by the noisy calibration points does not improve the
prediction of held-out curves, and makes it worse for one sample (docs/decisions/01_everett_operator.md).
"""

from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smarig.core import Array, DataError
from smarig.preisach.everett import DiagonalIntegrals
from smarig.preisach.hysteresis.forc_curve import ForcCurve, Line, completed_curves, saturation


class ValueAndSlopes(NamedTuple):
    """y(α, β), ∂y/∂α and ∂y/∂β, with broadcast shapes."""

    value: Array
    d_alpha: Array
    d_beta: Array


@dataclass(frozen=True, eq=False)
class ForcInterpolant:
    """All lines in one array. ``key`` rises along them: a line's index times twice the range, plus β."""

    beta: Array
    y: Array
    key: Array
    first: NDArray[np.intp]
    peaks: Array
    stride: float

    @classmethod
    def of(cls, lines: list[Line]) -> "ForcInterpolant":
        """The interpolant of completed lines, sorted by rising peak."""
        lower, upper = lines[0][0][0], lines[-1][0][-1]
        stride = 2 * (upper - lower)
        key = np.concatenate([k * stride + (b - lower) for k, (b, _) in enumerate(lines)])
        first = np.concatenate([[0], np.cumsum([b.size for b, _ in lines])])
        beta, y = (np.concatenate([line[i] for line in lines]) for i in (0, 1))
        return cls(beta, y, key, first, np.array([b[-1] for b, _ in lines]), float(stride))

    def value_and_slopes(self, alpha: ArrayLike, beta: ArrayLike) -> ValueAndSlopes:
        """Value and slopes at (α, β), β ≤ α. At a kink the slopes are one-sided."""
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
        """The triangle at the diagonal: from the major branch (straight between peaks) to the upper curve."""
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


@dataclass(frozen=True, eq=False)
class ForcTable(DiagonalIntegrals):
    """The hysteresis defined by first-order curves; satisfies ``Everett`` and ``Differentiable``.

    ``curves`` are sorted by rising peak. All meet at (``lower``, ``y_lower``), negative saturation.

    >>> down = [ForcCurve(a, np.linspace(a, 0.0, 5), a * np.linspace(a, 0.0, 5)) for a in (1.0, 2.0)]
    >>> table = ForcTable.from_curves(down)
    >>> float(table.y(2.0, 1.0)), table.everett(1.5, 1.5), table.y_lower
    (2.0, 0.0, 0.0)
    """

    curves: tuple[ForcCurve, ...] = field(repr=False)
    lower: float
    y_lower: float
    unit: str = ""
    _peaks: list[float] = field(init=False, repr=False)
    _lines: list[tuple[list[float], list[float]]] = field(init=False, repr=False)
    _interpolant: ForcInterpolant = field(init=False, repr=False)

    def __post_init__(self) -> None:
        _check(self.curves, self.lower)
        lines = completed_curves(self.curves, self.lower, self.y_lower)
        object.__setattr__(self, "_peaks", [c.alpha for c in self.curves])
        object.__setattr__(self, "_lines", [(beta.tolist(), y.tolist()) for beta, y in lines])
        object.__setattr__(self, "_interpolant", ForcInterpolant.of(lines))

    @classmethod
    def from_curves(cls, curves: Sequence[ForcCurve], unit: str = "") -> "ForcTable":
        """A table of at least two curves with different peaks, in any order. Saturation follows from the curves."""
        if len(curves) < 2:
            raise DataError(f"A table needs at least two first-order curves, got {len(curves)}.")
        return cls(tuple(sorted(curves, key=lambda c: c.alpha)), *saturation(curves), unit)

    @property
    def upper(self) -> float:
        """Positive saturation: the highest measured peak."""
        return self._peaks[-1]

    @property
    def kinks(self) -> Array:
        """Inputs at which derivatives jump: every node of every curve."""
        return np.unique(self._interpolant.beta)

    def measured(self, alpha: ArrayLike, beta: ArrayLike) -> NDArray[np.bool_]:
        """Whether y(α, β) is interpolated: both neighbouring curves were measured at least down to β."""
        a, b = np.broadcast_arrays(np.asarray(alpha, dtype=float), np.asarray(beta, dtype=float))
        peaks, ends = np.array(self._peaks), np.array([c.beta[-1] for c in self.curves])
        above = np.clip(np.searchsorted(peaks, a), 0, peaks.size - 1)
        below = np.where(peaks[above] == a, above, np.maximum(above - 1, 0))
        inside = (peaks[0] <= a) & (a <= self.upper) & (b <= a)
        return inside & (b >= np.maximum(ends[above], ends[below]))

    def y(self, alpha: ArrayLike, beta: ArrayLike) -> Array:
        """y(α, β): output after negative saturation → α → β, vectorised."""
        return self._interpolant.value_and_slopes(alpha, beta).value

    def everett(self, alpha: float, beta: float) -> float:
        """F(α, β) = y(α, α) − y(α, β), scalar."""
        return self._value(alpha, alpha) - self._value(alpha, beta)

    def swept(self, alpha: ArrayLike, beta: ArrayLike) -> Array:
        """F(α, β) for arrays."""
        return self.y(alpha, alpha) - self.y(alpha, beta)

    def _value(self, alpha: float, beta: float) -> float:
        """One point of the surface without arrays, for use in the tick. ``value_and_slopes`` is the array version."""
        peaks = self._peaks
        k = min(bisect_left(peaks, alpha), len(peaks) - 1)
        high = _on_line(self._lines[k], beta)
        top = peaks[k]
        if k == 0 or alpha >= top:
            return high
        bottom = peaks[k - 1]
        if beta <= bottom:
            low = _on_line(self._lines[k - 1], beta)
            return low + (alpha - bottom) / (top - bottom) * (high - low)
        on_bottom, on_top = self._lines[k - 1][1][-1], self._lines[k][1][-1]
        major = on_bottom + (beta - bottom) / (top - bottom) * (on_top - on_bottom)
        return major + (alpha - beta) / (top - beta) * (high - major)

    def strip_alpha(self, alpha: Array, beta: Array) -> Array:
        """∂F/∂α: the strip that a rising input sweeps per unit."""
        on_diagonal = self._interpolant.value_and_slopes(alpha, alpha)
        return (
            on_diagonal.d_alpha + on_diagonal.d_beta - self._interpolant.value_and_slopes(alpha, beta).d_alpha
        )

    def strip_beta(self, alpha: Array, beta: Array) -> Array:
        """∂y/∂β: the strip that a falling input sweeps per unit."""
        return self._interpolant.value_and_slopes(alpha, beta).d_beta

    def to_json(self) -> dict[str, Any]:
        """The measured curves as plain lists. ``from_json`` restores the same table bit for bit."""
        curves = [{"alpha": c.alpha, "beta": c.beta.tolist(), "y": c.y.tolist()} for c in self.curves]
        return {"unit": self.unit, "lower": self.lower, "y_lower": self.y_lower, "curves": curves}

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> "ForcTable":
        """The table from ``to_json``. DataError if a key is missing or wrong."""
        try:
            curves = tuple(
                ForcCurve(float(c["alpha"]), np.array(c["beta"], dtype=float), np.array(c["y"], dtype=float))
                for c in data["curves"]
            )
            return cls(curves, float(data["lower"]), float(data["y_lower"]), str(data["unit"]))
        except (KeyError, TypeError, ValueError) as error:
            raise DataError(f"The table of first-order curves is damaged: {error!r}.") from None


def _on_line(line: tuple[list[float], list[float]], u: float) -> float:
    nodes, values = line
    j = min(max(bisect_right(nodes, u) - 1, 0), len(nodes) - 2)
    return values[j] + (u - nodes[j]) / (nodes[j + 1] - nodes[j]) * (values[j + 1] - values[j])


def _check(curves: tuple[ForcCurve, ...], lower: float) -> None:
    for a, b in pairwise(curves):
        if a.alpha >= b.alpha:
            raise DataError(f"Two first-order curves have their peak at {b.alpha:g}. Average them first.")
    if not curves or curves[0].alpha <= lower:
        raise DataError(
            f"A first-order curve starts at or below negative saturation ({lower:g}). Leave it out."
        )
    if any(c.beta[-1] < lower for c in curves):
        raise DataError(f"A first-order curve extends below negative saturation ({lower:g}). Cut it there.")
