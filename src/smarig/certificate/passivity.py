"""Passivity along a run (thesis Thm 8.1): the supplied energy ⟨u, ẏ⟩_T, its lower bound, and the basis of the bound.

    ⟨u, ẏ⟩_T = ∫ u dy ≥ −Q_r(B₀)        for μ ∈ M_P with g ≥ 0;   Q_r(B₀) = 0 when u(0) = 0

∫ u dy of each move is exact (``preisach.energy.sweep``). The monotone return to u = 0 attains the bound. Models
outside M_P have a bound if they are dissipative (``storage_bound``); for others ``counterexample`` gives an input that
exceeds any bound. A run above the bound does not prove passivity; only the hypotheses do.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from smarig.certificate.certificate_units import Units, with_unit
from smarig.certificate.hypothesis import Hypothesis, failing
from smarig.certificate.hysteresis_analysis import HysteresisAnalysis
from smarig.certificate.storage_bound import BoundBasis, storage_bound
from smarig.core import Array, UsageError
from smarig.preisach import Everett, Initial, Preisach, State
from smarig.theory import Violation, confirm, energy_balance


@dataclass(frozen=True, eq=False)
class Passivity:
    """The supplied energy at each sample, ``supplied`` (n,), and its lower bound, ``bound``.

    ``bound`` is −inf for a model that is not dissipative, NaN if not decided; ``proven`` states whether it is a theorem
    or a computed limit. ``rounding`` is the largest error of an energy. Output times input units.
    """

    supplied: Array
    bound: float
    proven: bool
    basis: BoundBasis
    hypotheses: tuple[Hypothesis, ...]
    rounding: float
    unit: str = ""

    @property
    def least_supplied(self) -> tuple[float, int]:
        """The smallest supplied energy and its sample."""
        where = int(np.argmin(self.supplied))
        return float(self.supplied[where]), where

    @property
    def passive(self) -> bool | None:
        """Thm 8.1 as printed: no bias. None if the bound is undecided or not proved."""
        if math.isnan(self.bound) or not self.proven:
            return None
        return self.bound >= 0.0

    @property
    def within(self) -> bool:
        """Whether this run stayed above the bound, except for rounding; False for an undecided bound."""
        return bool(self.least_supplied[0] >= self.bound - self.rounding)

    @property
    def failing(self) -> tuple[Hypothesis, ...]:
        """The hypotheses of Thm 8.1 that do not hold."""
        return failing(self.hypotheses)

    @property
    def text(self) -> str:
        """A few sentences for a report: verdict, failing hypotheses, the run."""
        least, where = self.least_supplied
        run = f"Its minimum along this run is {self._energy(least)} (sample {where})."
        return " ".join([self._verdict(), *(h.text for h in self.failing), run])

    def _verdict(self) -> str:
        if self.basis == "undecided":
            return "No bound of the supplied energy is known."
        if self.basis == "none":
            return "Not passive with any bias: some input makes the supplied energy fall below every bound."
        how = {
            "positive": "Thm 8.1",
            "recoverable": "Q_r is a storage function, although μ or g is negative somewhere",
            "dissipative": "dissipative by its loop areas",
        }[self.basis]
        if self.bound == 0.0 and self.proven:
            return f"Passive: the supplied energy is never negative ({how})."
        kind = "never" if self.proven else "not, as far as was computed,"
        return f"Passive with bias: the supplied energy is {kind} below {self._energy(self.bound)} ({how})."

    def _energy(self, value: float) -> str:
        return with_unit(0.0 if abs(value) <= self.rounding else value, self.unit)


def passivity(
    hysteresis: Everett | HysteresisAnalysis, u: ArrayLike, initial: Initial = "negative"
) -> Passivity:
    """⟨u, ẏ⟩_T along inputs u (n,), monotone between samples, from an initial state, with its lower bound.

    A given HysteresisAnalysis is used as it is.

    Raises DataError for an input that is empty or not finite, UsageError for one of another shape.

    >>> from smarig.preisach import thesis_surface
    >>> found = passivity(thesis_surface("two_c"), [150.0, -80.0, 30.0], "anhysteretic")
    >>> found.passive, found.within, found.bound
    (True, True, 0.0)
    >>> [h.name for h in passivity(thesis_surface("two_e"), [10.0], "positive").failing]
    ['ν ≥ 0', 'u(0) = 0']
    """
    hysteresis_analysis = (
        hysteresis if isinstance(hysteresis, HysteresisAnalysis) else HysteresisAnalysis.of(hysteresis)
    )
    start = Preisach(hysteresis_analysis.hysteresis, initial).state
    balance = energy_balance(hysteresis_analysis.hysteresis, u, initial)
    found = storage_bound(hysteresis_analysis, start)
    return Passivity(
        supplied=balance.supplied,
        bound=0.0 - found.energy,
        proven=found.proven,
        basis=found.basis,
        hypotheses=(*found.hypotheses, _zero_start(start, hysteresis_analysis.units)),
        rounding=balance.rounding,
        unit=found.unit,
    )


def _zero_start(start: State, units: Units) -> Hypothesis:
    if start.u == 0.0:
        return Hypothesis("u(0) = 0", True, "the input begins at zero")
    where = with_unit(start.u, units.input)
    return Hypothesis("u(0) = 0", False, f"the input begins at {where}, so energy may be stored")


@dataclass(frozen=True)
class PassivityCounterexample:
    """An input that extracts any amount of energy from a model: repeated cycles of a loop of negative area.

    ``violation`` is the response of the forward model until the energy of the approach is repaid (``energy.confirm``).
    """

    violation: Violation

    def supplied_after(self, cycles: int) -> float:
        """⟨u, ẏ⟩ after a number of cycles; wiping-out makes all cycles equal."""
        return self.violation.approach + cycles * self.violation.per_cycle

    def cycles_below(self, energy: float) -> int:
        """The smallest number of cycles after which the supplied energy is below −``energy``."""
        return max(0, math.floor((self.violation.approach + energy) / -self.violation.per_cycle) + 1)

    def inputs(self, cycles: int) -> Array:
        """The turning points of the input, shape (3 + 2·cycles,)."""
        _, low, high = self.violation.turning_points
        return np.concatenate([self.violation.turning_points, np.tile([low, high], cycles)])


def counterexample(
    hysteresis: Everett | HysteresisAnalysis, initial: Initial = "negative"
) -> PassivityCounterexample:
    """The loop that violates passivity, from an initial state. Raises UsageError for a model that has none.

    A given HysteresisAnalysis is used as it is.

    >>> from smarig.preisach import thesis_surface
    >>> two_p = counterexample(thesis_surface("two_p"), "anhysteretic")
    >>> n = two_p.cycles_below(1000.0)
    >>> two_p.supplied_after(n) < -1000.0 <= two_p.supplied_after(n - 1)
    True
    """
    hysteresis_analysis = (
        hysteresis if isinstance(hysteresis, HysteresisAnalysis) else HysteresisAnalysis.of(hysteresis)
    )
    found = hysteresis_analysis.dissipativity
    if found is None or found.dissipative is not False:
        why = found.text if found else hysteresis_analysis.undecided
        raise UsageError(f"No input is known that violates the passivity of this model. {why}")
    return PassivityCounterexample(confirm(hysteresis_analysis.hysteresis, found.at, initial))
