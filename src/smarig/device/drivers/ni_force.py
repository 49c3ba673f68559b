"""A load cell with amplifier on an analogue input of an NI device. Untested on hardware."""

from smarig.config import LinkFile, RigFile
from smarig.core import TomlTable
from smarig.device.drivers._driver_settings import settings_of
from smarig.device.drivers._ni import NiInput, NiInputs, device_name, identity_of


class NiForceSettings(TomlTable):
    """[links.load_cell.settings] of ni_force."""

    input: NiInput  # load cell, in N; positive when the wire is pulled


def ni_force(where: LinkFile, rig: RigFile) -> "NiForce":
    """The load cell of a rig file."""
    del rig
    return NiForce(device_name(where), settings_of(where, NiForceSettings).input)


class NiForce:
    """F = scale · V + offset."""

    def __init__(self, device: str, cell: NiInput) -> None:
        self.identity = f"{identity_of(device)}, {cell.channel}"
        self._inputs = NiInputs(device, [cell])

    def force_N(self) -> float:
        """The force now; NaN without a reading."""
        return self._inputs.values()[0]

    def close(self) -> None:
        """Give the input back."""
        self._inputs.close()
