"""A load cell with amplifier on an analogue input of a LabJack."""

from smarig.config import LinkFile, RigFile
from smarig.core import TomlTable
from smarig.device.drivers._driver_settings import settings_of
from smarig.device.drivers._labjack import AnalogueChannel, LabJack


class LabJackForceSettings(TomlTable):
    """[links.load_cell.settings] of labjack_force."""

    input: AnalogueChannel  # load cell, in N; positive when the wire is pulled


def labjack_force(where: LinkFile, rig: RigFile) -> "LabJackForce":
    """The load cell of a rig file."""
    del rig
    return LabJackForce(where, settings_of(where, LabJackForceSettings).input)


class LabJackForce:
    """F = scale · V + offset."""

    def __init__(self, where: LinkFile, cell: AnalogueChannel) -> None:
        self._input = cell
        self._box = LabJack(where)
        with self._box.let_go_on_failure():
            self._box.configure([cell])
        self.identity = f"{self._box.identity}, AIN{cell.channel}"

    def force_N(self) -> float:
        """The force now; NaN without a reading."""
        return self._box.values(self._input)[0]

    def close(self) -> None:
        """Leave the connection."""
        self._box.close()
