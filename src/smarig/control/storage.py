"""What a hysteresis can give back from a state, and on what ground: the lower bound of every supplied energy.

    ν ≥ 0                      Q_r(B₀) of (7.1), by Thm 7.4
    Q_r proved a storage       Q_r(B₀) as well, although μ < 0 somewhere (docs/explanation/dissipativity.md)
    dissipative otherwise      the available storage S_a(B₀)
    not dissipative            no bound

Refuses to call a bound proved that is not: S_a is exact for relays, a limit from below for all else.
"""

import math
from dataclasses import dataclass
from typing import Literal

from smarig.control.hypothesis import Hypothesis
from smarig.errors import UsageError
from smarig.preisach.energy import available_storage, certify, recoverable_energy
from smarig.preisach.energy.storage_function import recoverable_energy_is_storage
from smarig.preisach.everett import Everett
from smarig.preisach.properties.classes import Classes, classes
from smarig.preisach.state import State

Ground = Literal["positive", "recoverable", "dissipative", "none", "undecided"]


@dataclass(frozen=True)
class Storage:
    """``energy``: the most a state can give back (inf: no bound, NaN: undecided), output times input units."""

    energy: float
    proved: bool
    ground: Ground
    hypotheses: tuple[Hypothesis, ...]
    unit: str = ""


def storage(hysteresis: Everett, state: State) -> Storage:
    """How much energy a state can give back; nothing is assumed of the hysteresis, everything is checked.

    >>> from smarig.preisach.gorbet_1997 import surface
    >>> from smarig.preisach.operator import Preisach
    >>> wire = Preisach(surface("one_e"))
    >>> found = storage(wire.hysteresis, wire.state)
    >>> found.energy, found.ground, found.proved
    (0.0, 'recoverable', True)
    """
    found = classes(hysteresis)
    sign = _sign(found)
    unit = getattr(hysteresis, "unit", "")
    unit = f"{unit}·K" if unit else ""
    if sign.holds:
        return Storage(recoverable_energy(hysteresis, state), True, "positive", (sign,), unit)
    verdict, why = _dissipative(hysteresis)
    hypotheses = (sign, Hypothesis("dissipative", verdict, why))
    if verdict is None:
        return Storage(math.nan, False, "undecided", hypotheses, unit)
    if not verdict:
        return Storage(math.inf, True, "none", hypotheses, unit)
    if _recoverable_is_storage(hysteresis):
        return Storage(recoverable_energy(hysteresis, state), True, "recoverable", hypotheses, unit)
    found = available_storage(hysteresis, state)
    return Storage(found.value, found.exact, "dissipative", hypotheses, unit)


def _sign(found: Classes) -> Hypothesis:
    least, name = (found.mu_min, "μ") if not found.mu_min.value >= 0 else (found.g_min, "g")
    if found.positive:
        kind = "no relay has a negative mass" if found.atoms else "neither μ nor g is negative anywhere"
        return Hypothesis("ν ≥ 0", True, kind)
    where = f"({least.at[0]:.4g}, {least.at[1]:.4g})"
    return Hypothesis("ν ≥ 0", False, f"{name} is {least.value:.3g} at (α, β) = {where}")


def _dissipative(hysteresis: Everett) -> tuple[bool | None, str]:
    try:
        found = certify(hysteresis)
    except UsageError as error:
        return None, str(error).rstrip(".")
    return found.dissipative, found.text.rstrip(".")


def _recoverable_is_storage(hysteresis: Everett) -> bool:
    try:
        return recoverable_energy_is_storage(hysteresis)
    except UsageError:
        return False
