"""What can go wrong on a bench, as values: kind, device, when it begins and ends. Read from a TOML file.

    [[fault]]
    kind = "garbled"
    device = "amplifier"
    share = 0.01
    seed = 1
    from_s = 10
    to_s = 60

Times are seconds of device time since power-up; exchanges are requests that the device's line carried, counted from 1.
Refuses to know how a fault is brought about: line_troubles.py (bytes), reading_troubles.py (what is measured),
world.py (power).
"""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from smarig.core import Number, TomlTable, load_toml

DeviceName = Literal["amplifier", "encoder_daq"]


class SimulatedFault(TomlTable):
    """Any fault: from a time or an exchange on, until a time or before an exchange; for ever where no end is given."""

    device: DeviceName
    from_s: Number = Field(default=0, ge=0)
    to_s: Number | None = None
    from_exchange: int = Field(default=0, ge=0)
    to_exchange: int | None = None

    def active(self, time_s: float, exchange: int) -> bool:
        """Whether it is there now."""
        return (
            time_s >= self.from_s
            and exchange >= self.from_exchange
            and (self.to_s is None or time_s < self.to_s)
            and (self.to_exchange is None or exchange < self.to_exchange)
        )


class _RandomFault(SimulatedFault):
    share: Number = Field(default=1, ge=0, le=1)
    seed: int = 0


class _DirectedFault(_RandomFault):
    direction: Literal["request", "reply"] = "reply"


class Dropped(_DirectedFault):
    """Nothing arrives."""

    kind: Literal["dropped"]


class GarbledBytes(_DirectedFault):
    """One bit of what arrives is another."""

    kind: Literal["garbled"]


class Repeated(_DirectedFault):
    """It arrives twice."""

    kind: Literal["repeated"]


class Delayed(_RandomFault):
    """The reply is late, by wall time, and so are those after it until then: what it answers has been done at once."""

    kind: Literal["delayed"]
    delay_s: Number = Field(gt=0, le=60)


class ForeignBytes(_RandomFault):
    """Noise before a reply."""

    kind: Literal["foreign_bytes"]
    bytes: int = Field(default=3, ge=1, le=1000)


class DeadLine(SimulatedFault):
    """The line carries nothing either way; the port stays open."""

    kind: Literal["dead_line"]


class Unplugged(SimulatedFault):
    """The port itself is gone, and back at the end under the same name."""

    kind: Literal["unplugged"]


class Reboot(SimulatedFault):
    """The device begins anew, once."""

    kind: Literal["reboot"]


class BrownOut(SimulatedFault):
    """No power: no output, no answers, no ticks; the device boots at the end."""

    kind: Literal["brown_out"]


class ClockDrift(SimulatedFault):
    """The device's clock is faster than the bench's by so many parts in a million."""

    kind: Literal["clock_drift"]
    ppm: Number = Field(ge=-500_000, le=500_000)


class _EncoderFault(SimulatedFault):
    device: Literal["encoder_daq"] = "encoder_daq"


class StuckEncoder(_EncoderFault):
    """The counts stay where they were; at the end they are true again."""

    kind: Literal["stuck_encoder"]


class SlippingEncoder(_EncoderFault):
    """A share of every movement is lost, for good."""

    kind: Literal["slipping_encoder"]
    share: Number = Field(gt=0, le=1)


class JumpingEncoder(_EncoderFault):
    """The counts jump once, for good."""

    kind: Literal["jumping_encoder"]
    counts: int = Field(ge=-1_000_000, le=1_000_000)


class _AmplifierFault(SimulatedFault):
    device: Literal["amplifier"] = "amplifier"


class OpenWire(_AmplifierFault):
    """No current flows, and the supply's whole voltage stands where the wire was."""

    kind: Literal["open_wire"]
    supply_V: Number = Field(default=12.0, ge=0, le=1000)


class DriftingShunt(_AmplifierFault):
    """The measured current is too large, by a share that grows from the beginning on."""

    kind: Literal["drifting_shunt"]
    gain_per_s: Number = Field(ge=-1, le=1)


AnyFault = Annotated[
    Dropped
    | GarbledBytes
    | Repeated
    | Delayed
    | ForeignBytes
    | DeadLine
    | Unplugged
    | Reboot
    | BrownOut
    | ClockDrift
    | StuckEncoder
    | SlippingEncoder
    | JumpingEncoder
    | OpenWire
    | DriftingShunt,
    Field(discriminator="kind"),
]


class _FaultsFile(TomlTable):
    fault: tuple[AnyFault, ...] = ()


def load_faults(path: Path) -> tuple[SimulatedFault, ...]:
    """The faults of a file; ConfigError names what is wrong in it."""
    return load_toml(_FaultsFile, path).fault
