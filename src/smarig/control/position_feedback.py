"""Position feedback around the operator and its heating lag: what a storage function certifies.

    u_k = φ(e_k),  e_k = r − y_k,      V = S(B) + Φ(e),   Φ(e) = ∫₀^e φ

For a gain that is switched by the error itself (its sign or size, as by Grant & Hayward) φ(e) = k(e) e is a function of
e, and Φ is its potential. With constant r, Σ u_k Δy_k = −Σ φ(e_k) Δe_k. S increases by at most u_k Δy_k
(``velocity.loop``, with or without a lag). If φ increases, Φ increases by at most −u_k Δy_k, because a convex function
lies above its tangents, jumps of φ included. So V does not increase. This needs a gain that is a function of e alone
and no delay: schedules by time or with a memory add (k' − k) e²/2 to V when they switch, and a tick of delay
invalidates the sum. V bounds the motion; it does not prove that y converges to r
(docs/explanation/control_findings.md). Integral action does (``regulation.integral_gain``).
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from smarig.control.lagged_operator import LaggedOperator
from smarig.control.velocity.velocity_controller import positive
from smarig.core import Array, DataError, UsageError
from smarig.preisach import Everett, Initial
from smarig.theory import recoverable_energy

ControlLaw = Callable[[int, float], float]


@dataclass(frozen=True)
class SwitchedGain:
    """φ(e) = k e, k = ``inner`` for |e| ≤ ``width`` and ``outer`` beyond, each times ``below`` for e < 0.

    >>> by_size = SwitchedGain(20.0, 60.0, width=0.5)
    >>> by_size(0, 0.4), by_size(0, -1.0), by_size.potential(1.0)
    (8.0, -60.0, 25.0)
    """

    inner: float
    outer: float
    width: float
    below: float = 1.0

    def __post_init__(self) -> None:
        for name in ("inner", "outer", "width", "below"):
            positive(name, getattr(self, name))

    def __call__(self, sample: int, error: float) -> float:
        """φ(e), independent of the sample."""
        del sample
        gain = self.inner if abs(error) <= self.width else self.outer
        return gain * error * (self.below if error < 0 else 1.0)

    @property
    def increasing(self) -> bool:
        """Whether φ never decreases, so that Φ is convex and V cannot increase from sample to sample."""
        return self.outer >= self.inner

    def potential(self, error: float) -> float:
        """Φ(e)."""
        size, scale = abs(error), self.below if error < 0 else 1.0
        inside = min(size, self.width)
        return scale * (self.inner * inside**2 + self.outer * (size**2 - inside**2)) / 2


@dataclass(frozen=True, eq=False)
class PositionLoop:
    """Signals (n,): reference r, error e = r − y, input u, output y; ``stored`` Q_r of the state at each sample."""

    reference: Array
    error: Array
    u: Array
    y: Array
    stored: Array

    def certificate(self, potential: Callable[[float], float]) -> Array:
        """V at each sample."""
        return self.stored + np.array([potential(e) for e in self.error.tolist()])

    def late_travel(self) -> float:
        """Σ|Δy| over the second half; 0 for a loop at rest."""
        return float(np.abs(np.diff(self.y[self.y.size // 2 :])).sum())


def position_loop(
    hysteresis: Everett,
    law: ControlLaw,
    reference: ArrayLike,
    *,
    dt_s: float = 0.1,
    initial: Initial = "anhysteretic",
    lag_s: float = 0.0,
    delayed: bool = False,
) -> PositionLoop:
    """Close u_k = law(k, e_k) for references (n,); ``delayed`` uses the error of the previous sample, as on a rig.

    Raises DataError for references that are empty or not finite.
    """
    references = np.asarray(reference, dtype=float)
    if references.ndim != 1 or not references.size or not np.isfinite(references).all():
        raise DataError("A position loop needs finite references of shape (n,).")
    if not callable(law):
        raise UsageError("A position loop needs a function law: (sample, error) → input.")
    plant = LaggedOperator(hysteresis, initial, dt_s, lag_s)
    signals = np.empty((4, references.size))
    for k, r in enumerate(references.tolist()):

        def command(y: float, k: int = k, r: float = r) -> float:
            return law(k, r - y)

        u = command(plant.y) if delayed else plant.solve(command, jumps=True)
        y = plant.step(u)
        signals[:, k] = r - y, u, y, recoverable_energy(hysteresis, plant.operator.state)
    error, u, y, stored = signals
    return PositionLoop(references, error, u, y, stored)
