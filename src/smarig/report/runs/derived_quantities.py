"""What a page and its JSON state of a run beyond its record: the stress of two wires, and the electrical energy."""

from dataclasses import dataclass
from typing import Any

from smarig.core import SmarigError
from smarig.plant import Actuator
from smarig.record import AnyRun
from smarig.replay import ElectricalEnergy, StressRange, electrical_energy, recorded_actuator, stress_over_run


@dataclass(frozen=True)
class DerivedQuantities:
    """Stress over a run of two wires, and its energy beside that of the heating model; None where not known."""

    stress: StressRange | None
    energy: ElectricalEnergy | None

    def to_json(self) -> dict[str, Any]:
        """{"stress", "energy"}, without those not known."""
        found = {"stress": self.stress, "energy": self.energy}
        return {key: value.to_json() for key, value in found.items() if value is not None}


def derived_quantities(run: AnyRun) -> DerivedQuantities:
    """The quantities of a run; one pass over its samples each."""
    try:
        actuator = recorded_actuator(run)
    except SmarigError:
        actuator = None
    if actuator is None:
        return DerivedQuantities(None, None)
    return DerivedQuantities(_stress(run, actuator), electrical_energy(run, actuator))


def _stress(run: AnyRun, actuator: Actuator) -> StressRange | None:
    """The stress over a run of two wires; None for thermomechanical ones, which have a balance of their own."""
    if actuator.file.thermomechanical is not None:
        return None
    try:
        return stress_over_run(run, actuator)
    except SmarigError:
        return None
