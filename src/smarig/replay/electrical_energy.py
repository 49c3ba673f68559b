"""The electrical energy of a run, from voltage and current, beside the heat that the heating model (5.1) assumes.

    E = ∫ V i dt,      Q = ∫ R̄ i² dt,   R̄ = (R_M + R_A)/2

The thesis heats a wire with the constant R̄; its voltage is i R(ξ). So E and Q differ by up to (R_M − R_A)/(2 R̄), by
which a martensitic wire takes up more, and an austenitic one less, than the model assumes.
"""

from dataclasses import asdict, dataclass

import numpy as np

from smarig.plant import Actuator
from smarig.record import AnyRun

_COLUMNS = ("tick", "current_A", "voltage_V")


@dataclass(frozen=True)
class ElectricalEnergy:
    """Electrical energy ∫ V i dt of a run, and the heat ∫ R̄ i² dt of the heating model, in joules."""

    electrical_J: float
    mean_resistance_J: float

    @property
    def difference_percent(self) -> float:
        """By how much the electrical energy exceeds the heat of the model."""
        return 100 * (self.electrical_J / self.mean_resistance_J - 1)

    def to_json(self) -> dict[str, float]:
        """As a JSON object."""
        return {
            key: float(f"{x:.6g}")
            for key, x in (asdict(self) | {"difference_percent": self.difference_percent}).items()
        }


def electrical_energy(run: AnyRun, actuator: Actuator) -> ElectricalEnergy | None:
    """The energies of a run with ticks, from the samples that have voltage and current; None without any, or without
    a current."""
    period_s = run.info.period_s
    if not period_s or not run.has("current_A") or not run.has("voltage_V"):
        return None
    electrical_W = square = 0.0
    last = None
    for block in run.blocks(_COLUMNS):
        ticks = block["tick"].astype(float)
        passed = np.diff(ticks, prepend=ticks[:1] - 1 if last is None else last)
        current_A, voltage_V = block["current_A"], block["voltage_V"]
        known = np.isfinite(current_A) & np.isfinite(voltage_V) & (passed > 0)
        last = ticks[-1:] if ticks.size else last
        electrical_W += float(np.sum(passed[known] * current_A[known] * voltage_V[known]))
        square += float(np.sum(passed[known] * current_A[known] ** 2))
    heat_J = square * actuator.resistance_ohm * float(period_s)
    return ElectricalEnergy(electrical_W * float(period_s), heat_J) if heat_J else None
