"""The moving (output-dependent) Preisach model: the output feeds back to the input.

    y = Γ[w],     w = u + k y

(Della Torre, IEEE Trans. Audio Electroacoust. 14:86, 1966: the effective field H + k M; k in kelvin per output unit).
On a monotone move w solves φ(w) = w − k Γ(w) = u. φ rises strictly on every branch, so that w exists and is unique, if
and only if 1 − k s > 0 for every slope s = ∂Γ/∂w of a branch:

    k < 1/s_max      and, where outputs reverse (s_min < 0),      k > 1/s_min

Beyond these limits the output would jump; such a k is rejected. Wiping-out holds, because w is monotone in u. Loops
between equal inputs run between different w, so congruency and equal vertical chords fail. k = 0 gives the classical
model bit for bit.
"""

from dataclasses import dataclass
from functools import singledispatch
from typing import Any

import numpy as np

from smarig.core import UsageError
from smarig.preisach import Everett, Initial, RelayMeasure, input_number, lattice
from smarig.theory.extended.operator_base import ExtendedOperator

_CELLS = 256
_ROUNDING: Any = 9e-16  # the smallest tolerance that brentq accepts


@dataclass(frozen=True)
class SlopeRange:
    """The least and the greatest slope ∂Γ/∂w over all branches, with their places (origin of the branch, w)."""

    least: float
    least_at: tuple[float, float]
    greatest: float
    greatest_at: tuple[float, float]

    @property
    def bounds(self) -> tuple[float, float]:
        """The open interval of well-posed feedbacks k."""
        low = 1 / self.least if self.least < 0 else -np.inf
        return low, 1 / self.greatest if self.greatest > 0 else np.inf


@singledispatch
def slope_range(hysteresis: Everett) -> SlopeRange:
    """Slopes ∂_αF(α, β) of rising and ∂_βy(α, β) of falling branches, as divided differences of F.

    Exact for a FOD table, whose slopes are linear between nodes. For smooth surfaces it uses 257 levels and misses the
    true extremes by O(step²). Relays switch in steps, so their slope is unbounded (UsageError).
    """
    v = lattice(hysteresis, _CELLS)
    on = np.tri(v.size, dtype=bool)
    F = np.zeros((v.size, v.size))
    i, j = np.nonzero(on)
    F[i, j] = hysteresis.swept(v[i], v[j])
    width = np.diff(v)
    rising = np.where(on[:-1], np.diff(F, axis=0) / width[:, None], np.nan)  # from β = v_j, near α = v_i
    falling = np.where(on[:, 1:], -np.diff(F, axis=1) / width, np.nan)  # from α = v_i, near β = v_j
    every = np.concatenate([np.ravel(rising.T), np.ravel(falling)])
    from_, to = np.meshgrid(v, v[:-1] + width / 2, indexing="ij")
    where = np.tile(np.column_stack([np.ravel(from_), np.ravel(to)]), (2, 1))
    low, high = int(np.nanargmin(every)), int(np.nanargmax(every))
    a, b = where[low].tolist(), where[high].tolist()
    return SlopeRange(float(every[low]), (a[0], a[1]), float(every[high]), (b[0], b[1]))


@slope_range.register
def _slopes_of_relays(hysteresis: RelayMeasure) -> SlopeRange:
    del hysteresis
    raise UsageError(
        "A measure of relays switches in steps, so no feedback k ≠ 0 is well posed. Use a FOD table or surface."
    )


class MovingPreisach(ExtendedOperator):
    """y = Γ[u + k y]; ``feedback`` k in input units per output unit; see the module.

    ``hysteresis`` is that of Γ, a function of w. A state is the memory of Γ; its extrema are values of w.

    >>> from smarig.preisach import thesis_surface
    >>> wire = MovingPreisach(thesis_surface("one_c"), feedback=-0.5)
    >>> y = wire.simulate([80.0, 40.0, 60.0, 40.0])     # wiping-out holds with feedback
    >>> abs(float(y[1] - y[3])) < 1e-12
    True
    """

    def __init__(self, hysteresis: Everett, feedback: float, initial: Initial = "negative") -> None:
        if feedback != 0:
            _check(slope_range(hysteresis), feedback)
        self.feedback = float(feedback)
        super().__init__(hysteresis, initial)

    def step(self, u: float) -> float:
        """Move the input monotonically to u. Returns y."""
        return super().step(u if self.feedback == 0 else self._effective(u))

    def _effective(self, u: float) -> float:
        """The w of one monotone move that solves w − k Γ(w) = u; beyond saturation the end of the range."""
        memory, k, h, u = self._memory, self.feedback, self.hysteresis, input_number(u)

        def excess(w: float) -> float:
            return w - k * memory.peek(w) - u

        here = memory.u
        now = here - k * memory.y - u
        end = h.upper if now < 0 else h.lower
        if now == 0 or here == end:
            return here
        beyond = excess(end)
        if beyond * now >= 0:
            return end
        from scipy.optimize import brentq  # imported here: takes half a second

        root: Any = brentq(excess, here, end, xtol=1e-15 * (h.upper - h.lower), rtol=_ROUNDING)
        return float(root)


def _check(s: SlopeRange, k: float) -> None:
    low, high = s.bounds
    if low < k < high:
        return
    slope, (origin, w) = (s.greatest, s.greatest_at) if k > 0 else (s.least, s.least_at)
    raise UsageError(
        f"Feedback k = {k:g} is ill posed: on the branch from {origin:g} the slope near {w:g} is {slope:.4g}, "
        f"so the output would jump. k must lie between {low:.4g} and {high:.4g}."
    )
