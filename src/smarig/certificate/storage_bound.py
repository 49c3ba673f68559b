"""The energy that a hysteresis can return from a state, and the basis of this bound of every supplied energy.

    ν ≥ 0                      Q_r(B₀) of (7.1), by Thm 7.4
    Q_r proved a storage       Q_r(B₀) as well, although μ < 0 somewhere (docs/explanation/dissipativity.md)
    dissipative otherwise      the available storage S_a(B₀)
    not dissipative            no bound

S_a is exact for relays. For all others it is a limit from below and not marked as proved.
"""

import math
from dataclasses import dataclass
from typing import Literal

from smarig.certificate.certificate_units import with_unit
from smarig.certificate.hypothesis import Hypothesis
from smarig.certificate.hysteresis_analysis import HysteresisAnalysis
from smarig.preisach import State
from smarig.theory import available_storage, recoverable_energy

BoundBasis = Literal["positive", "recoverable", "dissipative", "none", "undecided"]


@dataclass(frozen=True)
class StorageBound:
    """``energy``: the most that a state can return (inf: no bound, NaN: undecided), output times input units."""

    energy: float
    proven: bool
    basis: BoundBasis
    hypotheses: tuple[Hypothesis, ...]
    unit: str = ""


def storage_bound(analysis: HysteresisAnalysis, state: State) -> StorageBound:
    """The energy that a state can return; all properties of the hysteresis are checked.

    >>> from smarig.preisach import thesis_surface
    >>> from smarig.preisach import Preisach
    >>> wire = Preisach(thesis_surface("one_e"))
    >>> stored = storage_bound(HysteresisAnalysis.of(wire.hysteresis), wire.state)
    >>> stored.energy, stored.basis, stored.proven
    (0.0, 'recoverable', True)
    """
    sign, unit = _sign(analysis), analysis.units.energy
    if sign.holds:
        return StorageBound(recoverable_energy(analysis.hysteresis, state), True, "positive", (sign,), unit)
    verdict, why = _dissipative(analysis)
    hypotheses = (sign, Hypothesis("dissipative", verdict, why))
    if verdict is None:
        return StorageBound(math.nan, False, "undecided", hypotheses, unit)
    if not verdict:
        return StorageBound(math.inf, True, "none", hypotheses, unit)
    if analysis.recoverable_is_storage:
        return StorageBound(
            recoverable_energy(analysis.hysteresis, state), True, "recoverable", hypotheses, unit
        )
    available = available_storage(analysis.hysteresis, state)
    tolerance = analysis.dissipativity.tolerance if analysis.dissipativity else 0.0
    energy = 0.0 if abs(available.value) <= tolerance else available.value
    return StorageBound(energy, available.exact, "dissipative", hypotheses, unit)


def _sign(analysis: HysteresisAnalysis) -> Hypothesis:
    c, units = analysis.classes, analysis.units
    if c.positive:
        reason = (
            "no relay has a negative mass"
            if c.atoms
            else "neither the density μ nor the reversible g is negative"
        )
        return Hypothesis("ν ≥ 0", True, reason)
    negative_density = not c.mu_min.value >= 0
    minimum, name = (c.mu_min, "the density μ") if negative_density else (c.g_min, "the reversible g")
    unit = units.density if negative_density else units.slope
    if c.atoms:
        name, unit = "the mass of a relay", units.output
    where = f"({minimum.at[0]:.4g}, {minimum.at[1]:.4g}) {units.input}".rstrip()
    return Hypothesis("ν ≥ 0", False, f"{name} is {with_unit(minimum.value, unit, 3)} at (α, β) = {where}")


def _dissipative(analysis: HysteresisAnalysis) -> tuple[bool | None, str]:
    decided = analysis.dissipativity
    if decided is None:
        return None, analysis.undecided.rstrip(".")
    return decided.dissipative, decided.reason
