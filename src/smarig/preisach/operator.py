"""The Preisach operator, by its dominant extrema: no relay grid, no integration, exact to rounding.

The boundary B of the Preisach plane is a staircase whose corners are the remembered extrema
(thesis §3.1, §6.1). The operator keeps them on a stack with the output at each: a monotone move
costs one evaluation of the Everett function F, a wipe-out is a pop (§3.3.1). Amortised O(1).

    rising from a minimum m:  y = y(m) + F(u, m)        falling from a maximum M:  y = y(M) − F(M, u)

Inputs beyond the saturation range [u₋, u₊] are saturated. Knows no time and no physics.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smarig.errors import DataError, UsageError
from smarig.preisach.everett import Everett
from smarig.preisach.fod_surface import FodSurface
from smarig.preisach.fod_table import FodTable
from smarig.preisach.relay_measure import RelayMeasure


@dataclass(frozen=True, slots=True)
class State:
    """The memory: remembered extrema, oldest first, with the output at each, and the present point.

    ``extrema[0]`` is the base: u₋ for a history that began in negative saturation, or the centre ℓ of
    the diagonal boundary B_ℓ = {α = 2ℓ − β} (``diagonal`` true; ℓ = 0 is the anhysteretic state B*).
    """

    extrema: tuple[float, ...]
    outputs: tuple[float, ...]
    u: float
    y: float
    diagonal: bool = False


Initial = Literal["negative", "positive", "anhysteretic"] | State


class Preisach:
    """Preisach operator y = Γ[u] for a FOD surface, a FOD table or a measure of relays.

    >>> from smarig.preisach.gorbet_1997 import surface
    >>> wire = Preisach.from_surface(surface("one_c"))
    >>> y = wire.simulate([80.0, 40.0, 60.0, 40.0])       # a minor loop closes: wiping-out
    >>> bool(y[1] == y[3])
    True
    """

    def __init__(self, hysteresis: Everett, initial: Initial = "negative") -> None:
        self.hysteresis = hysteresis
        self._F = hysteresis.everett
        self.reset(initial)

    @classmethod
    def from_surface(cls, surface: FodSurface) -> "Preisach":
        """Operator of an analytic FOD surface (5.5)."""
        return cls(surface)

    @classmethod
    def from_table(cls, alpha: ArrayLike, beta: ArrayLike, y: ArrayLike) -> "Preisach":
        """Operator of a FOD table y[i, j] = y(α_i, β_j), NaN where β_j > α_i; bilinear, exact at nodes."""
        return cls(FodTable.from_arrays(alpha, beta, y))

    @classmethod
    def from_measure(cls, alpha: ArrayLike, beta: ArrayLike, mass: ArrayLike) -> "Preisach":
        """Operator of relays (α_k, β_k) with signed mass: y = Σ mass_k γ_k, γ = ±1."""
        return cls(RelayMeasure.from_arrays(alpha, beta, mass))

    # --- state -----------------------------------------------------------------------------------

    @property
    def state(self) -> State:
        """A frozen copy of the memory."""
        return State(tuple(self._u), tuple(self._y), self.u, self.y, self._diagonal)

    def reset(self, initial: Initial = "negative") -> float:
        """Go to a state: "negative" or "positive" saturation, "anhysteretic" (B*), or a State. Returns y."""
        h = self.hysteresis
        if isinstance(initial, State):
            self._u, self._y = list(initial.extrema), list(initial.outputs)
            self.u, self.y, self._diagonal = initial.u, initial.y, initial.diagonal
        elif initial == "anhysteretic":
            self.go_to_diagonal(0.0)
        elif initial in ("negative", "positive"):
            self._saturate(h.lower if initial == "negative" else h.upper)
        else:
            raise UsageError(f"Initial state '{initial}' is not negative, positive, anhysteretic or a State.")
        return self.y

    def go_to_diagonal(self, centre: float) -> float:
        """Go to B_ℓ = {α = 2ℓ − β} (§8.3), ℓ = centre clipped to the range; returns ψ(ℓ) = r(B_ℓ)."""
        h = self.hysteresis
        centre = min(max(centre, h.lower), h.upper)
        # F alone does not reach B_ℓ, so ψ is built from below: what is on in B_ℓ is what a fall to u₋
        # would switch off.
        y = h.y_lower + h.fall_from_diagonal(centre, h.lower)
        self._u, self._y, self.u, self.y, self._diagonal = [centre], [y], centre, y, True
        return y

    def _saturate(self, u: float) -> float:
        h = self.hysteresis
        self._u, self._y, self._diagonal = [h.lower], [h.y_lower], False
        self.u = u
        self.y = h.y_lower if u <= h.lower else h.y_lower + self._F(u, h.lower)
        return self.y

    # --- motion ----------------------------------------------------------------------------------

    def step(self, u: float) -> float:
        """Move monotonically from the present input to u; returns the output there."""
        if u > self.u:
            return self._rise(u)
        if u < self.u:
            return self._fall(u)
        if u != u:
            raise DataError("The Preisach operator was given NaN as its input.")
        return self.y

    def _rise(self, u: float) -> float:
        if u >= self.hysteresis.upper:
            return self._saturate(self.hysteresis.upper)
        us, ys = self._u, self._y
        if self.u < us[-1]:
            us.append(self.u)
            ys.append(self.y)
        while len(us) > 2 and u >= us[-2]:
            del us[-2:], ys[-2:]
        if self._diagonal:
            if len(us) == 2 and u >= 2 * us[0] - us[1]:
                del us[1:], ys[1:]
            if len(us) == 1:
                self.u = u
                self.y = ys[0] + self._from_diagonal(u)
                return self.y
        self.u = u
        self.y = ys[-1] + self._F(u, us[-1])
        return self.y

    def _fall(self, u: float) -> float:
        if u <= self.hysteresis.lower:
            return self._saturate(self.hysteresis.lower)
        us, ys = self._u, self._y
        if self.u > us[-1]:
            us.append(self.u)
            ys.append(self.y)
        while len(us) > 2 and u <= us[-2]:
            del us[-2:], ys[-2:]
        if self._diagonal:
            if len(us) == 2 and u <= 2 * us[0] - us[1]:
                del us[1:], ys[1:]
            if len(us) == 1:
                self.u = u
                self.y = ys[0] + self._from_diagonal(u)
                return self.y
        self.u = u
        self.y = ys[-1] - self._F(us[-1], u)
        return self.y

    def _from_diagonal(self, u: float) -> float:
        centre = self._u[0]
        if u >= centre:
            return self.hysteresis.rise_from_diagonal(centre, u)
        return -self.hysteresis.fall_from_diagonal(centre, u)

    def simulate(self, u: Sequence[float] | ArrayLike, initial: Initial = "negative") -> NDArray[np.float64]:
        """Outputs for inputs u, shape (n,), from an initial state; moves are monotone between samples."""
        inputs = np.asarray(u, dtype=float)
        if inputs.ndim != 1:
            raise UsageError(f"simulate takes a one-dimensional input, got shape {inputs.shape}.")
        self.reset(initial)
        step = self.step
        return np.fromiter((step(v) for v in inputs.tolist()), dtype=float, count=inputs.size)

    def peek(self, u: float) -> float:
        """Output that step(u) would give; the memory stays as it is."""
        here = self.state
        try:
            return self.step(u)
        finally:
            self.reset(here)

    def inverse(self, y_target: float, state: State | None = None) -> float:
        """Input u that reaches y_target from the state (default: the present one) by one monotone move.

        By bisection, so it needs output monotone in input (strip sums ≥ 0, theory.md §1). Raises
        DataError when the target lies outside what saturation gives. Leaves the operator's memory as it was.
        """
        here = self.state
        try:
            start = state or here
            self.reset(start)
            h = self.hysteresis
            end = h.upper if y_target > start.y else h.lower
            reach = self.peek(end)
            rounding = 1e-12 * abs(self._F(h.upper, h.lower))  # saturation itself must count as reachable
            if not min(start.y, reach) - rounding <= y_target <= max(start.y, reach) + rounding:
                raise DataError(f"Output {y_target:g} cannot be reached: the range ends at {reach:g}.")
            near, far = start.u, end
            for _ in range(200):
                middle = 0.5 * (near + far)
                if middle in (near, far):
                    break
                if (self.peek(middle) < y_target) == (y_target > start.y):
                    near = middle
                else:
                    far = middle
            return far if y_target != start.y else start.u
        finally:
            self.reset(here)

    def __repr__(self) -> str:
        h = self.hysteresis
        depth = len(self._u) - 1
        return (
            f"Preisach({type(h).__name__}, range [{h.lower:g}, {h.upper:g}], "
            f"u={self.u:g}, y={self.y:g}, {depth} remembered extrema)"
        )
