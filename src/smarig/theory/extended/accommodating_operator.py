"""The accommodation Preisach model: frozen relays drift towards the mean, and minor loops drift with them.

Repeated loops between equal inputs coincide in the classical model (thesis §3.3.3); in some wires they drift to a
limit. In thesis §3.5 a second weight, a function of the output extrema, multiplies μ. Here a relay with β < u < α,
which the input does not determine, has such a weight. It starts at ±1 at the extremum that ended the branch which
last swept the relay, and mixes with all others along the output's path (after Della Torre's accommodation model, IEEE
Trans. Magn. 30, 1994; Vajda & Della Torre, ibid. 30:4371, thesis ref. [59]). The relays that one branch swept last
form one region k:

    y = Γ[u] + (κ/2) Σ_k (q_k − γ_k) ν_k(u),        dq_k/dp = (m − q_k)/l,      q_k = γ_k = ±1 at its extremum
    dp = |dΓ|/(y₊ − y₋),      m = (2Γ − y₋ − y₊)/(y₊ − y₋)

κ ∈ [0, 1] is the amount, and l > 0 the path in strokes after which 1/e of the memory remains. Between fixed inputs the
drift is geometric: each cycle of path p leaves the fraction exp(−p/l). m is linear in p on a branch, so the mixing is
integrated exactly, and intermediate samples change nothing (where Γ's branches are monotone). Both κ = 0 and l = ∞ give
the classical model bit for bit. Neither wiping-out nor congruency holds.
"""

import math
from dataclasses import dataclass

from numpy.typing import ArrayLike

from smarig.core import Array, UsageError
from smarig.preisach import Everett, Initial, Preisach, State
from smarig.theory.extended.operator_base import simulate_steps


@dataclass(frozen=True, slots=True)
class SweptBranch:
    """An extremum at input u that ended a rising (``up``) or falling branch, and the mean state q of its relays."""

    u: float
    up: bool
    q: float


@dataclass(frozen=True, slots=True)
class AccommodationState:
    """The classical memory, and the branches that swept the presently frozen relays, oldest first."""

    memory: State
    swept: tuple[SweptBranch, ...]


class AccommodatingPreisach:
    """Frozen strips relax by ``amount`` κ over ``path`` l strokes of output; see the module.

    >>> from smarig.preisach import thesis_surface
    >>> wire = AccommodatingPreisach(thesis_surface("one_e"), amount=0.5, path=0.1)
    >>> low = wire.simulate([110.0] + [60.0, 75.0] * 20)[2::2]
    >>> bool(low[0] != low[1] and abs(low[-1] - low[-2]) < abs(low[1] - low[0]) / 10)     # drifts, settles
    True
    """

    def __init__(
        self,
        hysteresis: Everett,
        amount: float,
        path: float,
        initial: Initial | AccommodationState = "negative",
    ) -> None:
        if not 0 <= amount <= 1:
            raise UsageError(f"The amount of accommodation must lie between 0 and 1, got {amount:g}.")
        if not path > 0:
            raise UsageError(f"The path of accommodation must be positive (strokes of output), got {path:g}.")
        self.hysteresis, self.amount, self.path = hysteresis, float(amount), float(path)
        self._stroke = hysteresis.everett(hysteresis.upper, hysteresis.lower)
        if not self._stroke > 0:
            raise UsageError(
                "Accommodation is counted in strokes y₊ − y₋ of output, which must be positive; this hysteresis has "
                f"{self._stroke:g}."
            )
        self._memory = Preisach(hysteresis)
        self.reset(initial)

    @property
    def state(self) -> AccommodationState:
        """A frozen copy of the memory."""
        return AccommodationState(self._memory.state, tuple(self._swept))

    def reset(self, initial: Initial | AccommodationState = "negative") -> float:
        """Go to saturation, to a classical state without drift, or to a state of this model. Returns y."""
        if isinstance(initial, AccommodationState):
            self._memory.reset(initial.memory)
            self._swept = list(initial.swept)
        else:
            self._memory.reset(initial)
            if self._memory.state.diagonal:
                raise UsageError(
                    "Accommodation must start from saturation: in the anhysteretic state there is no "
                    "branch that swept last."
                )
            self._swept = [_new_branch(u, k % 2 == 1) for k, u in enumerate(self._memory.state.extrema)]
        return self._read_out()

    def step(self, u: float) -> float:
        """Move monotonically to u. Returns y. The cost grows with the depth of the memory."""
        before = self._memory.state
        self._memory.step(u)
        here, rising = self._memory.u, u > before.u
        if here in (self.hysteresis.lower, self.hysteresis.upper):  # all relays are swept
            self._swept = [_new_branch(self.hysteresis.lower, False)]
        elif here != before.u:
            if (before.u > before.extrema[-1]) != rising and before.u != before.extrema[-1]:
                self._swept.append(_new_branch(before.u, not rising))
            self._mix(before.y, self._memory.y)
            self._swept = [s for s in self._swept if s.up != rising or (s.u > here) == rising]
        return self._read_out()

    def simulate(self, u: ArrayLike, initial: Initial | AccommodationState = "negative") -> Array:
        """Outputs (n,) for inputs u (n,)."""
        return simulate_steps(self, u, initial)

    def _mix(self, before: float, after: float) -> None:
        """Apply dq/dp = (m − q)/l over one branch, on which m changes by ±2 per stroke."""
        path = abs(after - before) / self._stroke / self.path
        if path == 0:
            return
        lag = math.copysign(2 * self.path, after - before)
        start, end = (2 * (y - self.hysteresis.y_lower) / self._stroke - 1 for y in (before, after))
        left, trail = math.exp(-path), lag * math.expm1(-path)
        self._swept = [SweptBranch(s.u, s.up, end + (s.q - start) * left + trail) for s in self._swept]

    def _read_out(self) -> float:
        """Contribution of each branch's frozen relays: those above and below u that no later branch swept."""
        F, lowest, highest = self.hysteresis.everett, self.hysteresis.lower, self.hysteresis.upper
        above = below = self._memory.u
        drift = 0.0
        for s in reversed(self._swept):
            if s.up:
                nu = F(s.u, lowest) - F(above, lowest) - F(s.u, below) + F(above, below)
                drift, above = drift + (s.q - 1.0) * nu, s.u
            else:
                nu = F(highest, s.u) - F(highest, below) - F(above, s.u) + F(above, below)
                drift, below = drift + (s.q + 1.0) * nu, s.u
        return self._memory.y + 0.5 * self.amount * drift


def _new_branch(u: float, up: bool) -> SweptBranch:
    return SweptBranch(u, up, 1.0 if up else -1.0)
