"""Passivity along a run (thesis Thm 8.1): the supplied energy ⟨u, ẏ⟩_T, its lower bound, and what the bound rests on.

    ⟨u, ẏ⟩_T = ∫ u dy ≥ −Q_r(B₀)        for μ ∈ M_P with g ≥ 0;   Q_r(B₀) = 0 when u(0) = 0

Each move's ∫ u dy is exact (``preisach.energy.sweep``). The bound is attained by the monotone return to u = 0.
Models outside M_P keep a bound where they are dissipative (``storage``); for those that are not, ``breaking``
gives an input that goes below any bound. Refuses to conclude from a run that stayed above the bound that the
model is passive: that is what the hypotheses say.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smarig.control.examined import Examined
from smarig.control.hypothesis import Hypothesis, failing
from smarig.control.storage import Ground, storage
from smarig.control.units import Units, said
from smarig.errors import UsageError
from smarig.preisach.energy import Violation, confirm, energy_balance
from smarig.preisach.everett import Everett
from smarig.preisach.operator import Initial, Preisach
from smarig.preisach.state import State

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Passivity:
    """The supplied energy at each sample, ``supplied`` (n,), and what it can never fall below, ``bound``.

    ``bound`` is −inf for a model that is not dissipative, NaN where that is not decided; ``proved`` says whether it
    is a theorem or a computed limit. ``rounding`` is what an energy may be wrong by. Output times input units.
    """

    supplied: Array
    bound: float
    proved: bool
    ground: Ground
    hypotheses: tuple[Hypothesis, ...]
    rounding: float
    unit: str = ""

    @property
    def smallest(self) -> tuple[float, int]:
        """The least supplied energy and the sample where it is."""
        where = int(np.argmin(self.supplied))
        return float(self.supplied[where]), where

    @property
    def passive(self) -> bool | None:
        """Thm 8.1 as printed: no bias. None where the bound is undecided or not proved."""
        if math.isnan(self.bound) or not self.proved:
            return None
        return self.bound >= 0.0

    @property
    def within(self) -> bool:
        """Whether this run stayed above the bound, rounding apart; False for an undecided bound."""
        return bool(self.smallest[0] >= self.bound - self.rounding)

    @property
    def failing(self) -> tuple[Hypothesis, ...]:
        """The hypotheses of Thm 8.1 that do not hold."""
        return failing(self.hypotheses)

    @property
    def text(self) -> str:
        """A few sentences for a report: verdict, the hypotheses that fail, the run."""
        least, where = self.smallest
        run = f"Along this run it was never below {self._energy(least)} (sample {where})."
        return " ".join([self._verdict(), *(h.text for h in self.failing), run])

    def _verdict(self) -> str:
        if self.ground == "undecided":
            return "No bound of the supplied energy is known."
        if self.ground == "none":
            return "Not passive with any bias: some input makes the supplied energy fall below every bound."
        how = {
            "positive": "Thm 8.1",
            "recoverable": "Q_r is a storage function, although μ or g is negative somewhere",
            "dissipative": "dissipative by its loop areas",
        }[self.ground]
        if self.bound == 0.0 and self.proved:
            return f"Passive: the supplied energy is never negative ({how})."
        kind = "never" if self.proved else "as far as was looked, not"
        return f"Passive with bias: the supplied energy is {kind} below {self._energy(self.bound)} ({how})."

    def _energy(self, value: float) -> str:
        return said(0.0 if abs(value) <= self.rounding else value, self.unit)


def passivity(hysteresis: Everett | Examined, u: ArrayLike, initial: Initial = "negative") -> Passivity:
    """⟨u, ẏ⟩_T along inputs u (n,), monotone between samples, from an initial state, with its lower bound.

    Takes a hysteresis that has been examined as well, and does not look again.

    Raises DataError for an input that is empty or not finite, UsageError for one of another shape.

    >>> from smarig.preisach.gorbet_1997 import surface
    >>> found = passivity(surface("two_c"), [150.0, -80.0, 30.0], "anhysteretic")
    >>> found.passive, found.within, found.bound
    (True, True, 0.0)
    >>> [h.name for h in passivity(surface("two_e"), [10.0], "positive").failing]
    ['ν ≥ 0', 'u(0) = 0']
    """
    examined = hysteresis if isinstance(hysteresis, Examined) else Examined.of(hysteresis)
    start = Preisach(examined.hysteresis, initial).state
    balance = energy_balance(examined.hysteresis, u, initial)
    found = storage(examined, start)
    return Passivity(
        balance.supplied,
        0.0 - found.energy,
        found.proved,
        found.ground,
        (*found.hypotheses, _at_rest(start, examined.units)),
        balance.rounding,
        found.unit,
    )


def _at_rest(start: State, units: Units) -> Hypothesis:
    if start.u == 0.0:
        return Hypothesis("u(0) = 0", True, "the input begins at zero")
    where = said(start.u, units.input)
    return Hypothesis("u(0) = 0", False, f"the input begins at {where}, so energy may be stored")


@dataclass(frozen=True)
class Breaking:
    """An input that takes any amount of energy out of a model: a loop of negative area, driven again and again.

    ``violation`` is what the forward model did until it had repaid its approach (``energy.confirm``).
    """

    violation: Violation

    def supplied_after(self, cycles: int) -> float:
        """⟨u, ẏ⟩ after a number of cycles: every cycle is the same, by wiping-out."""
        return self.violation.approach + cycles * self.violation.per_cycle

    def cycles_below(self, energy: float) -> int:
        """The least number of cycles after which the supplied energy is below −``energy``."""
        return max(0, math.floor((self.violation.approach + energy) / -self.violation.per_cycle) + 1)

    def inputs(self, cycles: int) -> Array:
        """The input by its turning points, shape (3 + 2·cycles,)."""
        _, low, high = self.violation.way
        return np.concatenate([self.violation.way, np.tile([low, high], cycles)])


def breaking(hysteresis: Everett | Examined, initial: Initial = "negative") -> Breaking:
    """The loop that breaks passivity, from an initial state; UsageError for a model that has none.

    Takes a hysteresis that has been examined as well, and does not look again.

    >>> from smarig.preisach.gorbet_1997 import surface
    >>> two_p = breaking(surface("two_p"), "anhysteretic")
    >>> n = two_p.cycles_below(1000.0)
    >>> two_p.supplied_after(n) < -1000.0 <= two_p.supplied_after(n - 1)
    True
    """
    examined = hysteresis if isinstance(hysteresis, Examined) else Examined.of(hysteresis)
    found = examined.dissipativity
    if found is None or found.dissipative is not False:
        why = found.text if found else examined.undecided
        raise UsageError(f"No input is known to break the passivity of this model. {why}")
    return Breaking(confirm(examined.hysteresis, found.at, initial))
