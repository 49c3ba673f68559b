"""The dissipation inequality along a run (thesis Thm 7.4), sample by sample and without quadrature error.

    slack_k = Q_r(B₀) + ∫_{t₀}^{t_k} u ẏ dt − Q_r(B_k) ≥ 0        for μ ≥ 0 and g ≥ 0

The slack is the energy lost in the hysteresis so far; under these conditions it never decreases. A negative slack shows
that Q_r is not a storage function of this model. Another one may exist; ``certify`` decides this.
"""

from dataclasses import dataclass
from itertools import chain

import numpy as np
from numpy.typing import ArrayLike

from smarig.core import Array, DataError, UsageError
from smarig.preisach import Everett, Initial, Preisach, State
from smarig.theory.energy.moments import rounding
from smarig.theory.energy.sweep_work import MovingBoundary, SweepSegment, work, work_of_segments


@dataclass(frozen=True, eq=False)
class EnergyBalance:
    """Energies along a run, shape (n,) each, in output times input units.

    ``supplied`` is ∫ u dy since the initial state, ``stored`` is Q_r at each sample, ``stored_before`` is Q_r of the
    initial state, ``slack`` is the energy dissipated so far, and ``rounding`` is the possible error.
    """

    supplied: Array
    stored: Array
    stored_before: float
    rounding: float

    @property
    def slack(self) -> Array:
        """Q_r(B₀) + ∫u dy − Q_r(B_k), shape (n,)."""
        return self.stored_before + self.supplied - self.stored

    @property
    def smallest(self) -> tuple[float, int]:
        """The smallest slack and its sample."""
        where = int(np.argmin(self.slack))
        return float(self.slack[where]), where

    @property
    def holds(self) -> bool:
        """Whether the inequality holds at every sample, up to rounding."""
        return self.smallest[0] >= -self.rounding

    def __repr__(self) -> str:
        slack, where = self.smallest
        return (
            f"EnergyBalance({self.supplied.size} samples, supplied {self.supplied[-1]:.6g}, "
            f"stored {self.stored[-1]:.6g}, smallest slack {slack:.3g} at sample {where})"
        )


def energy_balance(hysteresis: Everett, u: ArrayLike, initial: Initial = "negative") -> EnergyBalance:
    """Energies along the inputs u (n,), monotone between samples, from an initial state.

    ∫ u dy of each move is exact (``sweep``). UsageError if the input is not one-dimensional; DataError if it is empty
    or not finite.

    >>> from smarig.preisach import thesis_surface
    >>> energy_balance(thesis_surface("two_c"), [150.0, -80.0, 30.0], "anhysteretic").holds
    True
    """
    inputs = np.asarray(u, dtype=float)
    if inputs.ndim != 1:
        raise UsageError(f"An energy balance needs a one-dimensional input, got shape {inputs.shape}.")
    if not inputs.size or not np.isfinite(inputs).all():
        raise DataError("An energy balance needs at least one input, and all inputs must be finite.")
    start = initial_state(hysteresis, initial)
    memory = MovingBoundary(start, hysteresis.lower, hysteresis.upper)
    moves: list[list[SweepSegment]] = []
    returns: list[list[SweepSegment]] = []
    for value in inputs.tolist():
        moves.append(memory.move(value))
        returns.append(memory.copy().move(0.0))
    supplied = np.cumsum(_per_move(hysteresis, moves))
    stored, before = -_per_move(hysteresis, returns), recoverable_energy(hysteresis, start)
    return EnergyBalance(supplied, stored, before, rounding(hysteresis) * max(1.0, inputs.size / 100))


def initial_state(hysteresis: Everett, initial: Initial) -> State:
    """The initial state of an operator of this hysteresis."""
    return Preisach(hysteresis, initial).state


def _per_move(hysteresis: Everett, moves: list[list[SweepSegment]]) -> Array:
    works = work_of_segments(hysteresis, chain.from_iterable(moves))
    owner = np.repeat(np.arange(len(moves)), [len(m) for m in moves])
    return np.bincount(owner, weights=works, minlength=len(moves)).astype(float)


def recoverable_energy(hysteresis: Everett, state: State) -> float:
    """Q_r(B) of a state in output times input units; zero at u = 0 (Prop. 7.1), ≥ 0 for μ ≥ 0 and g ≥ 0.

    >>> from smarig.preisach import thesis_surface
    >>> from smarig.preisach import Preisach
    >>> wire = Preisach.from_surface(thesis_surface("one_c"))
    >>> _ = wire.step(90.0)
    >>> hot = recoverable_energy(wire.hysteresis, wire.state)
    >>> _ = wire.step(0.0)
    >>> hot > 100.0, recoverable_energy(wire.hysteresis, wire.state)
    (True, 0.0)
    """
    return 0.0 - work(hysteresis, state, 0.0)
