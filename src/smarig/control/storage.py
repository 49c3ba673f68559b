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

from smarig.control.examined import Examined
from smarig.control.hypothesis import Hypothesis
from smarig.control.units import said
from smarig.preisach.energy import available_storage, recoverable_energy
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


def storage(found: Examined, state: State) -> Storage:
    """How much energy a state can give back; nothing is assumed of the hysteresis, everything is checked.

    >>> from smarig.preisach.gorbet_1997 import surface
    >>> from smarig.preisach.operator import Preisach
    >>> wire = Preisach(surface("one_e"))
    >>> stored = storage(Examined.of(wire.hysteresis), wire.state)
    >>> stored.energy, stored.ground, stored.proved
    (0.0, 'recoverable', True)
    """
    sign, unit = _sign(found), found.units.energy
    if sign.holds:
        return Storage(recoverable_energy(found.hysteresis, state), True, "positive", (sign,), unit)
    verdict, why = _dissipative(found)
    hypotheses = (sign, Hypothesis("dissipative", verdict, why))
    if verdict is None:
        return Storage(math.nan, False, "undecided", hypotheses, unit)
    if not verdict:
        return Storage(math.inf, True, "none", hypotheses, unit)
    if found.recoverable_is_storage:
        return Storage(recoverable_energy(found.hysteresis, state), True, "recoverable", hypotheses, unit)
    available = available_storage(found.hysteresis, state)
    tolerance = found.dissipativity.tolerance if found.dissipativity else 0.0
    energy = 0.0 if abs(available.value) <= tolerance else available.value
    return Storage(energy, available.exact, "dissipative", hypotheses, unit)


def _sign(found: Examined) -> Hypothesis:
    c, units = found.classes, found.units
    if c.positive:
        kind = (
            "no relay has a negative mass"
            if c.atoms
            else "neither the density μ nor the reversible g is negative"
        )
        return Hypothesis("ν ≥ 0", True, kind)
    of_density = not c.mu_min.value >= 0
    least, name = (c.mu_min, "the density μ") if of_density else (c.g_min, "the reversible g")
    unit = units.density if of_density else units.slope
    if c.atoms:
        name, unit = "the mass of a relay", units.output
    where = f"({least.at[0]:.4g}, {least.at[1]:.4g}) {units.input}".rstrip()
    return Hypothesis("ν ≥ 0", False, f"{name} is {said(least.value, unit, 3)} at (α, β) = {where}")


def _dissipative(found: Examined) -> tuple[bool | None, str]:
    decided = found.dissipativity
    if decided is None:
        return None, found.undecided.rstrip(".")
    _, _, why = decided.text.partition(": ")
    return decided.dissipative, why.rstrip(".")
