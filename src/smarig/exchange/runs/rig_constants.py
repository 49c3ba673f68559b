"""The constants of a rig that an import needs: those of its wire, and the size of one encoder count."""

from dataclasses import dataclass

import numpy as np

from smarig.config import RigFile, load_rig
from smarig.core import Array
from smarig.plant import Actuator, JouleHeating


@dataclass(frozen=True)
class RigConstants:
    """The file of a rig and its actuator."""

    file: RigFile
    actuator: Actuator

    @classmethod
    def named(cls, name: str) -> "RigConstants":
        """The constants of a rig by its name in configs/rigs, or by path."""
        file = load_rig(name)
        return cls(file, Actuator.named(file.actuator))

    @property
    def per_count(self) -> float:
        """Rig units per encoder count."""
        return self.actuator.resolution(self.file.encoder)

    def input_along(self, t_s: Array, current_A: Array) -> Array:
        """Hysteresis input (n,), kelvin above ambient, by (5.1) at any spacing, from a cold wire."""
        dt_s = np.diff(t_s, prepend=t_s[0] - np.median(np.diff(t_s)))
        decay = np.exp(-dt_s / self.actuator.tau_s).tolist()
        heating = JouleHeating(self.actuator, dt_s=1.0)
        out = np.empty(t_s.size)
        for k, current in enumerate(current_A.tolist()):
            heating.decay = decay[k]
            out[k] = heating.step(current)
        return out
