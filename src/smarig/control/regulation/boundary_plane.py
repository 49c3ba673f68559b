"""The triangle P_r of one hysteresis as its state space: B_ℓ, states and their distance inside [u₋, u₊].

``preisach.state_space`` defines boundaries on |u| ≤ û. A one-wire rig covers [0, 174.1]: on the larger triangle its
states would differ where there are no relays and the wire cannot go. Here the input is shifted by the middle of its
range, so û is half the range and 2û² is the area of P_r itself: for one wire a quarter of 2·174.1², the stricter
measure.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from smarig.core import Array
from smarig.preisach import Everett, Preisach, RelayMeasure, State
from smarig.theory import Boundary, boundary_of, diagonal, distance


@dataclass(frozen=True)
class BoundaryPlane:
    """Boundaries over [``lower``, ``upper``], with the input counted from the middle.

    >>> plane = BoundaryPlane(0.0, 10.0)
    >>> plane.area, plane.points(plane.target_boundary(3.0))
    (50.0, ((0.0, 10.0), (0.0, 6.0), (3.0, 3.0)))
    """

    lower: float
    upper: float

    @classmethod
    def of(cls, hysteresis: Everett) -> "BoundaryPlane":
        """The plane of a hysteresis."""
        return cls(hysteresis.lower, hysteresis.upper)

    @property
    def bound(self) -> float:
        """û, half the range."""
        return 0.5 * (self.upper - self.lower)

    @property
    def middle(self) -> float:
        """The middle of the range, which counts as 0."""
        return 0.5 * (self.lower + self.upper)

    @property
    def area(self) -> float:
        """2û², the area of P_r and the largest distance there is (§6.5.3)."""
        return 2 * self.bound**2

    @cached_property
    def _empty_measure(self) -> RelayMeasure:
        return RelayMeasure.zero(-self.bound, self.bound)

    def target_boundary(self, ell: float) -> Boundary:
        """B_ℓ."""
        return diagonal(self.bound, min(max(ell - self.middle, -self.bound), self.bound))

    def boundary_after(self, inputs: ArrayLike, start: State | None = None) -> Boundary:
        """The state after inputs (n,), from a state (default: negative saturation)."""
        memory = self._memory(start)
        u = np.asarray(inputs, dtype=float) - self.middle
        memory.follow(turning_points(u))
        return boundary_of(memory.state, self._empty_measure)

    def state(self, state: State) -> Boundary:
        """The boundary of an operator's memory, cut to this plane."""
        return boundary_of(self._memory(state).state, self._empty_measure)

    def distance(self, boundary: Boundary, ell: float) -> float:
        """d(B, B_ℓ), input units squared."""
        return distance(boundary, self.target_boundary(ell))

    def points(self, boundary: Boundary) -> tuple[tuple[float, float], ...]:
        """The corners (β, α) of a boundary of this plane, in the input's own unit."""
        return tuple((beta + self.middle, alpha + self.middle) for beta, alpha in boundary.points)

    def _memory(self, start: State | None) -> Preisach:
        memory = Preisach(self._empty_measure, compiled=False)
        if start is None:
            return memory
        base, *extrema = start.extrema
        if start.diagonal:
            memory.go_to_diagonal(base - self.middle)
        memory.follow(np.array([*extrema, start.u]) - self.middle)
        return memory


def turning_points(u: Array) -> Array:
    """The inputs at which u (n,) turns back, and its last: all that is remembered of it."""
    moved = np.flatnonzero(np.diff(u)) + 1
    turns = moved[:-1][np.diff(np.sign(u[moved] - u[moved - 1])) != 0]
    return u[np.unique([0, *(turns), u.size - 1])] if u.size else u
