"""The encoder DAQ of firmware_protocol/encoder_daq.toml, which counts ticks by its own clock."""

from smarig.config import LinkFile, RigFile
from smarig.core import Quality
from smarig.device.drivers._line_device import LineDevice
from smarig.device.encoding.register import load_register_map
from smarig.device.links.link import Link, let_go_on_failure
from smarig.device.links.opening import opened
from smarig.device.roles.ticked import PositionReading


def smarig_encoder_daq(where: LinkFile, rig: RigFile) -> "SmarigEncoderDaq":
    """The encoder of a rig file, after its handshake, with its period written."""
    with let_go_on_failure(opened(where, load_register_map("encoder_daq").device.default_address)) as link:
        return SmarigEncoderDaq(link, rig.period_s)


class SmarigEncoderDaq(LineDevice):
    """The encoder DAQ. The constructor performs the handshake and writes the period."""

    measures_ambient = True

    def __init__(self, link: Link, period_s: float) -> None:
        super().__init__(link, "encoder_daq")
        _, self._ambient, _ = self.map.fields("counts", "ambient", "marks")
        self.talk.handshake()
        self.talk.settings({"period": self.map["period"].value.encode(period_s)})

    def since(self, tick: int, at_most: int) -> list[PositionReading]:
        """Samples of its ring, from a tick on."""
        status = self.talk.command({"ring_next": tick}, at_most)
        first = self.talk.first_tick(status, tick)
        mark = Quality.RETRIED if status.retried else Quality.GOOD
        return [
            PositionReading(first + k, counts, self._ambient.decode(ambient), mark)
            for k, (counts, ambient, _) in enumerate(status.records)
        ]

    def tick(self) -> int:
        """The last tick of the device."""
        return self.talk.command({}).values["tick"]

    def zero(self) -> None:
        """Set the present position to 0 from the next tick on."""
        order = next(int(code) for code, name in self.map["order"].values.items() if name == "zero")
        self.talk.command({"order": order})

    def close(self) -> None:
        """Close the line."""
        self.talk.link.close()
