"""ψ(ℓ) = r(B_ℓ), the output of the state B_ℓ = {α = 2ℓ − β}, and its right inverse ψʳ (§8.3, Thm 8.5).

    ψ(ℓ) = y₋ + ∫_{u₋}^{ℓ} ∂_βy(min(2ℓ − β, u₊), β) dβ,      ψʳ(y) = min{ℓ : ψ(ℓ) = y}

ψ leads from y₋ to y₊ for every hysteresis. It is continuous for surfaces and tables. For single relays it jumps at
ℓ = (α + β)/2 by twice the relay's mass and takes no value inside a jump; there ψʳ is the smallest ℓ with at least y,
as in the operator's own inverse. Where μ < 0 it may turn back (one-wire p does), so the smallest ℓ is sought among its
turning points. These are found on a grid of 256 intervals and refined; a narrower hump is not found.
"""

import math
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from smarig.core import Array, UsageError
from smarig.preisach import Everett, bracketed_root

GRID_POINTS = 256
ROUNDING = 1e-12  # relative to the output range


class Psi:
    """ψ of a hysteresis as a function of ℓ, scalar or array, in the units of input and output.

    >>> from smarig.preisach import thesis_surface
    >>> psi = Psi(thesis_surface("two_c"))
    >>> round(psi(0.0), 2), round(psi.right_inverse(2.65), 2), psi.monotone
    (2.65, 0.01, True)
    """

    def __init__(self, hysteresis: Everett) -> None:
        if not hasattr(hysteresis, "fall_from_diagonal"):
            raise UsageError(f"ψ needs a hysteresis, such as a model's, not a {type(hysteresis).__name__}.")
        self.hysteresis = hysteresis
        self.lower, self.upper = hysteresis.lower, hysteresis.upper
        self.y_lower = hysteresis.y_lower
        self.y_upper = self.y_lower + hysteresis.everett(self.upper, self.lower)
        self.continuous = not len(getattr(hysteresis, "steps", ()))

    def __call__(self, ell: ArrayLike) -> float | Array:
        """ψ(ℓ). Raises UsageError for ℓ outside [u₋, u₊], where there is no such state."""
        centres = np.asarray(ell, dtype=float)
        outside = ~((centres >= self.lower) & (centres <= self.upper))
        if np.any(outside):
            raise UsageError(
                f"There is no state B_ℓ for ℓ = {centres[outside].flat[0]:g}. Give ℓ within "
                f"[{self.lower:g}, {self.upper:g}]."
            )
        values = np.array([self._at(centre) for centre in centres.ravel().tolist()])
        return values.reshape(centres.shape) if centres.ndim else float(values[0])

    def right_inverse(self, y: ArrayLike) -> float | Array:
        """ψʳ(y), the smallest ℓ with ψ(ℓ) = y (or, where ψ jumps past y, with at least y).

        Raises UsageError for y outside [y₋, y₊], which no state is certain to have as output.
        """
        outputs = np.asarray(y, dtype=float)
        found = np.array([self._right_inverse(target) for target in outputs.ravel().tolist()])
        return found.reshape(outputs.shape) if outputs.ndim else float(found[0])

    @property
    def monotone(self) -> bool:
        """Whether ψ never decreases, as for μ, g ≥ 0; then its inverse is unique except on level segments."""
        return bool(np.all(np.diff(self._samples[1]) >= -self._slack))

    @cached_property
    def curve(self) -> tuple[Array, Array]:
        """ℓ and ψ(ℓ), both (n,), at all computed points, for drawing."""
        return self._samples

    def _at(self, centre: float) -> float:
        return self.y_lower + self.hysteresis.fall_from_diagonal(centre, self.lower)

    @property
    def _slack(self) -> float:
        return ROUNDING * abs(self.y_upper - self.y_lower)

    @cached_property
    def _samples(self) -> tuple[Array, Array]:
        """Points between which ψ is monotone (or, for relays, constant), and ψ there."""
        grid = np.linspace(self.lower, self.upper, GRID_POINTS + 1)
        centres = self._jumps()
        if centres.size:  # a relay is up in B_ℓ only once ℓ is above its middle
            past = np.minimum(np.nextafter(centres, np.inf), self.upper)
            grid = np.unique(np.concatenate([grid, centres, past]))
            return grid, np.asarray(self(grid))
        grid = np.union1d(grid, np.asarray(getattr(self.hysteresis, "kinks", ())))
        values = np.asarray(self(grid))
        turns = self._turns(grid, values)
        if not turns.size:
            return grid, values
        both = np.concatenate([grid, turns])
        order = np.argsort(both, kind="stable")
        return both[order], np.concatenate([values, np.asarray(self(turns))])[order]

    def _jumps(self) -> Array:
        """Where single relays switch in B_ℓ as ℓ increases; empty without single relays."""
        alpha, beta = (getattr(self.hysteresis, name, None) for name in ("alpha", "beta"))
        if self.continuous or alpha is None or beta is None:
            return np.empty(0)
        return np.unique((np.asarray(alpha) + np.asarray(beta)) / 2)

    def _turns(self, grid: Array, values: Array) -> Array:
        """Turning points of ψ: each one detected on the grid, then refined."""
        from scipy.optimize import minimize_scalar  # imported here: takes half a second

        step = np.diff(values)
        step[np.abs(step) <= self._slack] = 0.0
        turning = np.flatnonzero(step[:-1] * step[1:] < 0) + 1
        width = 1e-12 * (self.upper - self.lower)
        found = []
        for k in turning.tolist():
            sign = 1.0 if step[k - 1] < 0 else -1.0
            ends = (grid[k - 1], grid[k + 1])
            best = minimize_scalar(
                lambda ell, s=sign: s * self._at(ell), bounds=ends, method="bounded", options={"xatol": width}
            )
            found.append(float(best.x))
        return np.array(found)

    def _right_inverse(self, y: float) -> float:
        if not self.y_lower - self._slack <= y <= self.y_upper + self._slack:
            raise UsageError(
                f"The set-point {y:g} is outside the outputs of this hysteresis, "
                f"[{self.y_lower:g}, {self.y_upper:g}]. Give one inside."
            )
        grid, values = self._samples
        k = int(np.argmax(values >= min(y, float(values.max())) - self._slack))
        if k == 0:
            return self.lower
        near, far = float(grid[k - 1]), float(grid[k])
        if self.continuous:
            return bracketed_root(lambda ell: self._at(ell) - y, near, far)
        return far if self._jumps().size else self._bisected(near, far, y)

    def _bisected(self, near: float, far: float, y: float) -> float:
        """The first ℓ with ψ ≥ y between two points, where the jumps of ψ are not known."""
        while near < (middle := 0.5 * (near + far)) < far and math.isfinite(middle):
            near, far = (near, middle) if self._at(middle) >= y - self._slack else (middle, far)
        return far

    def __repr__(self) -> str:
        turns = "" if self.monotone else ", turns back"
        return f"Psi([{self.lower:g}, {self.upper:g}] → [{self.y_lower:g}, {self.y_upper:g}]{turns})"
