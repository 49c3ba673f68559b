"""Faults of a bench as values: kind, device, start and end. They are read from a TOML file.

    [[fault]]
    kind = "garbled"
    device = "amplifier"
    share = 0.01
    seed = 1
    from_s = 10
    to_s = 60

Times are seconds of device time since power-up. Exchanges are requests on the device's line, counted from 1.
The faults take effect in line_troubles.py (bytes), reading_troubles.py (readings) and simulated_bench.py (power).
"""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from smarig.core import Number, TomlTable, load_toml

DeviceName = Literal["amplifier", "encoder_daq"]


class SimulatedFault(TomlTable):
    """A fault from a time or an exchange on, until a time or before an exchange; without an end it lasts for
    ever."""

    device: DeviceName
    from_s: Number = Field(default=0, ge=0)
    to_s: Number | None = None
    from_exchange: int = Field(default=0, ge=0)
    to_exchange: int | None = None

    def active(self, time_s: float, exchange: int) -> bool:
        """Whether the fault is active."""
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
    """One bit of the message is inverted."""

    kind: Literal["garbled"]


class Repeated(_DirectedFault):
    """The message arrives twice."""

    kind: Literal["repeated"]


class Delayed(_RandomFault):
    """The reply and those after it are late by a wall time. The request has been executed without delay."""

    kind: Literal["delayed"]
    delay_s: Number = Field(gt=0, le=60)


class ForeignBytes(_RandomFault):
    """Noise bytes before a reply."""

    kind: Literal["foreign_bytes"]
    bytes: int = Field(default=3, ge=1, le=1000)


class DeadLine(SimulatedFault):
    """The line carries nothing in either direction; the port stays open."""

    kind: Literal["dead_line"]


class Unplugged(SimulatedFault):
    """The port disappears, and returns at the end under the same name."""

    kind: Literal["unplugged"]


class Reboot(SimulatedFault):
    """The device reboots once."""

    kind: Literal["reboot"]


class BrownOut(SimulatedFault):
    """Power failure: no output, no replies, no ticks. The device boots at the end."""

    kind: Literal["brown_out"]


class ClockDrift(SimulatedFault):
    """The device's clock is faster than the bench's by so many parts per million."""

    kind: Literal["clock_drift"]
    ppm: Number = Field(ge=-500_000, le=500_000)


class _EncoderFault(SimulatedFault):
    device: Literal["encoder_daq"] = "encoder_daq"


class StuckEncoder(_EncoderFault):
    """The counts stay constant; at the end they are correct again."""

    kind: Literal["stuck_encoder"]


class SlippingEncoder(_EncoderFault):
    """A share of every movement is lost permanently."""

    kind: Literal["slipping_encoder"]
    share: Number = Field(gt=0, le=1)


class JumpingEncoder(_EncoderFault):
    """The counts jump once, permanently."""

    kind: Literal["jumping_encoder"]
    counts: int = Field(ge=-1_000_000, le=1_000_000)


class _AmplifierFault(SimulatedFault):
    device: Literal["amplifier"] = "amplifier"


class OpenWire(_AmplifierFault):
    """No current flows, and the voltage is that of the supply."""

    kind: Literal["open_wire"]
    supply_V: Number = Field(default=12.0, ge=0, le=1000)


class DriftingShunt(_AmplifierFault):
    """The measured current is too large by a share that grows from the start of the fault."""

    kind: Literal["drifting_shunt"]
    gain_per_s: Number = Field(ge=-1, le=1)


class LowShunt(_AmplifierFault):
    """The shunt reads low: the amplifier regulates its reading, so ``factor`` times the ordered current flows."""

    kind: Literal["low_shunt"]
    factor: Number = Field(ge=1, le=10)


class Thermometer(_AmplifierFault):
    """The amplifier has a thermometer on the wire. From the start of the fault it reads ``excess_K`` too much; without
    that key it reads nothing any more.
    """

    kind: Literal["thermometer"]
    excess_K: Number | None = Field(default=None, ge=-1000, le=1000)


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
    | DriftingShunt
    | LowShunt
    | Thermometer,
    Field(discriminator="kind"),
]


class _FaultsFile(TomlTable):
    fault: tuple[AnyFault, ...] = ()


def load_faults(path: Path) -> tuple[SimulatedFault, ...]:
    """Read the faults of a file. Raises ConfigError with the reason if an entry is wrong."""
    return load_toml(_FaultsFile, path).fault
