"""Stress in two wires that pull against each other, from the temperature of each (force balance of thesis §5.5.1).

    ε₁(σ) + ε₂(σ) = ε_t,        ε(σ) = (1 − ξ) ε_m(σ) + ξ σ/E_a

Both wires have one stress σ, and their strains add up to the total. ε_m is the bilinear martensite curve. Parts of a
wire in different phases are in series, so their strains add up by share. The stress rises when *both* wires are hot,
which T₁ − T₂ does not show: cold 242 MPa, one wire hot 261 MPa, both hot 1078 MPa.

Stress raises the transformation temperatures, which this balance leaves out: its stress is an upper bound.
"""

from dataclasses import dataclass

from smarig.plant.stress import StressStrain


@dataclass(frozen=True)
class TransformationTemperatures:
    """A_s, A_f, M_s, M_f without stress, in °C: typical of NiTi with 49.5 % Ni (thesis §2.4.1)."""

    austenite_start: float = 53.0
    austenite_finish: float = 80.0
    martensite_start: float = 47.0
    martensite_finish: float = 19.0


class AntagonistStress:
    """``step(wire_K)`` returns the stress in MPa at the temperatures of both wires above ambient.

    >>> wires = AntagonistStress(ambient_degC=22.0)
    >>> [round(wires.step(k)) for k in ((0.0, 0.0), (100.0, 0.0), (100.0, 100.0))]
    [242, 261, 1078]
    """

    def __init__(
        self,
        ambient_degC: float,
        curve: StressStrain | None = None,
        temperatures: TransformationTemperatures | None = None,
    ) -> None:
        t = temperatures or TransformationTemperatures()
        self._curve = curve or StressStrain()
        self._heating = t.austenite_start - ambient_degC, t.austenite_finish - ambient_degC
        self._cooling = t.martensite_finish - ambient_degC, t.martensite_start - ambient_degC
        self.austenite = [0.0, 0.0]

    def start(self, wire_K: tuple[float, float] | list[float]) -> None:
        """Start with wires that may be this hot: as much austenite as any history leaves."""
        self.austenite = [self._phase(1.0, hot_K) for hot_K in wire_K]

    def step(self, wire_K: tuple[float, float] | list[float]) -> float:
        """Advance both phases to these temperatures and return the stress."""
        for k in (0, 1):
            self.austenite[k] = self._phase(self.austenite[k], wire_K[k])
        return self.stress_MPa(self.austenite[0] + self.austenite[1])

    def stress_at(self, wire_K: tuple[float, float] | list[float]) -> float:
        """The stress that these temperatures would cause, without a change of state."""
        return self.stress_MPa(
            sum(self._phase(before, hot_K) for before, hot_K in zip(self.austenite, wire_K))
        )

    def _phase(self, before: float, wire_K: float) -> float:
        """The austenite of a wire: rises along A_s…A_f, falls along M_s…M_f, and stays in between."""
        least, most = _share(wire_K, *self._heating), _share(wire_K, *self._cooling)
        return min(max(before, least), max(most, least))

    def stress_MPa(self, austenite: float) -> float:
        """The stress at the sum of both austenite fractions, 0 to 2."""
        return stress_of_phases_MPa(austenite, self._curve)


def stress_of_phases_MPa(austenite: float, curve: StressStrain | None = None) -> float:
    """The stress in MPa at the sum of both austenite fractions, 0 to 2. At one stress both wires have equal curves.

    >>> [round(stress_of_phases_MPa(x)) for x in (0.0, 1.0, 2.0)]
    [242, 261, 1078]
    """
    c, martensite = curve or StressStrain(), 2.0 - austenite
    elastic = c.total_strain / (martensite / c.martensite_MPa + austenite / c.austenite_MPa)
    yielding = c.martensite_MPa * c.plateau_from
    if elastic <= yielding:
        return elastic
    # ε_m = ε_k + (σ − σ_k)/E_p above the knee
    compliance = martensite / c.plateau_MPa + austenite / c.austenite_MPa
    return (c.total_strain - martensite * (c.plateau_from - yielding / c.plateau_MPa)) / compliance


def _share(x: float, low: float, high: float) -> float:
    return min(max((x - low) / (high - low), 0.0), 1.0)
