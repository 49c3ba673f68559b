"""Recoverable stored energy (thesis (7.1)): what a monotone return to zero input gives back.

    Q_r(B) = 2∬_{Q₁∩P₊} μβ dα dβ − 2∬_{Q₃∩P₋} μα dα dβ                                          (7.1)

A boundary at u > 0 leaves Q₃ empty of off relays, and a fall from u to 0 sweeps exactly Q₁ ∩ P₊; at u < 0 a
rise to 0 sweeps Q₃ ∩ P₋. So Q_r(B) = −∫ u dy of that one move, which is how it is computed, for staircases
and for diagonal boundaries. The reversible part comes with it: read (7.1) with dν = 2μ dα dβ + g δ(α − β),
so g stores ∫₀^u v g(v) dv, all of it recoverable. For g ≥ 0 that only adds to Q_r ≥ 0.
Refuses to know how the state was reached.
"""

from smarig.preisach.everett import Everett
from smarig.preisach.operator import State
from smarig.theory.energy.sweep_work import work


def recoverable_energy(hysteresis: Everett, state: State) -> float:
    """Q_r(B) of a state, output times input units; zero at u = 0 (Prop. 7.1), ≥ 0 for μ ≥ 0 and g ≥ 0.

    >>> from smarig.preisach.hysteresis.gorbet_1997 import surface
    >>> from smarig.preisach.operator import Preisach
    >>> wire = Preisach.from_surface(surface("one_c"))
    >>> _ = wire.step(90.0)
    >>> hot = recoverable_energy(wire.hysteresis, wire.state)
    >>> _ = wire.step(0.0)
    >>> hot > 100.0, recoverable_energy(wire.hysteresis, wire.state)
    (True, 0.0)
    """
    return 0.0 - work(hysteresis, state, 0.0)
