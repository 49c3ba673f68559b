"""Energy in the Preisach model (thesis ch. 7): work, storage, loss, and dissipativity.

The supply rate is u ẏ. Energies are in output times input units (mm·K, deg·K).
"""

from smarig.theory.energy.available_storage import AvailableStorage, available_storage
from smarig.theory.energy.dissipation import EnergyBalance, energy_balance, recoverable_energy
from smarig.theory.energy.dissipativity import DissipativityCertificate, certify
from smarig.theory.energy.moments import loop_area
from smarig.theory.energy.sweep_work import work
from smarig.theory.energy.violation import Violation, confirm

__all__ = [
    "AvailableStorage",
    "DissipativityCertificate",
    "EnergyBalance",
    "Violation",
    "available_storage",
    "certify",
    "confirm",
    "energy_balance",
    "loop_area",
    "recoverable_energy",
    "work",
]
