"""Energy in the Preisach model (thesis ch. 7): work, storage, loss, and whether a model is dissipative at all.

Supply rate u ẏ. Knows no wire, no time and no data: energies are output times input units (mm·K, deg·K).
"""

from smarig.preisach.energy.available_storage import AvailableStorage, available_storage
from smarig.preisach.energy.certificate import Certificate, certify
from smarig.preisach.energy.dissipation import EnergyBalance, energy_balance
from smarig.preisach.energy.moments import loop_area
from smarig.preisach.energy.stored import recoverable_energy
from smarig.preisach.energy.sweep import work
from smarig.preisach.energy.violation import Violation, confirm

__all__ = [
    "AvailableStorage",
    "Certificate",
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
