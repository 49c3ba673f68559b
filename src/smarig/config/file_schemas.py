"""The schemas of rig and campaign files: frozen values. Each error is one sentence that names its key.

Physical quantities have no defaults. The comment after each key is its text in the reference.
"""

import re
from pathlib import Path
from typing import Literal

from pydantic import Field, field_validator, model_validator

from smarig.config.load_file import LoadFile
from smarig.config.named_things import (
    ActuatorName,
    DriverName,
    FaultsPath,
    LibraryPath,
    LinkUrl,
    MakeName,
    ProtocolName,
    Settings,
    TracePath,
)
from smarig.core import CAMPAIGN_FILE, RIG_FILE, Number, TomlTable, passed

_SERIAL_FORMAT = re.compile(r"[5-8][NEOMS](1|1\.5|2)")
_PLAIN_NAME = re.compile(r"[\w .+()-]*")  # no folder: a run is written under this name
LEAST_A, MOST_A = 1e-6, 1e4  # no wire needs less, or more


class LimitsFile(TomlTable):
    """[limits]: checked by the host on every tick. The device has limits of its own."""

    current_min_A: Number = Field(ge=-MOST_A)  # smallest current; negative for two wires only
    current_max_A: Number = Field(le=MOST_A)  # largest current
    current_rate_A_per_s: Number = Field(ge=1e-6, le=1e9)  # largest rate of change
    temperature_max_K: Number = Field(
        ge=1, le=5000
    )  # largest predicted or measured wire temperature above ambient
    resistance_tolerance: Number = Field(
        default=0.1, ge=1e-6, le=1
    )  # share by which V/I may differ from the wire's
    model_tolerance: Number | None = Field(
        default=None, ge=0.01, le=0.9
    )  # share of temperature and stroke by which the wire may differ from its file; else 0.1 if simulated, 0.3
    voltage_max_V: Number | None = Field(
        default=None, ge=1e-6, le=1e9
    )  # across the wire; else what the largest current needs
    stress_max_MPa: Number | None = Field(
        default=None, ge=1e-3, le=1e6
    )  # two wires: largest predicted stress, both wires hot
    cycles_max: int | None = Field(
        default=None, strict=True, gt=0, le=10**15
    )  # cycles of the wire over all its runs

    @model_validator(mode="after")
    def _ordered(self) -> "LimitsFile":
        if not self.current_min_A <= 0 <= self.current_max_A:
            raise ValueError(
                "current_min_A ≤ 0 ≤ current_max_A is required, because zero current must always be allowed"
            )
        if max(-self.current_min_A, self.current_max_A) < LEAST_A:
            raise ValueError(
                f"current_min_A and current_max_A are both 0, or below {LEAST_A:g} A, so no current can be driven"
            )
        return self


class AmplifierFile(TomlTable):
    """[amplifier]: saturation and read-back noise (standard deviations)."""

    saturation_A: Number = Field(gt=0, le=MOST_A)  # largest current that the amplifier delivers
    current_noise_A: Number = Field(ge=0, le=MOST_A)  # standard deviation of one current reading
    voltage_noise_V: Number = Field(ge=0, le=1e6)  # standard deviation of one voltage reading


class EncoderFile(TomlTable):
    """[encoder]: resolution and noise of one sample before quantisation."""

    counts_per_rev: int = Field(gt=0, le=10_000_000)  # counts per revolution
    noise_counts: Number = Field(ge=0, le=1e6)  # standard deviation of one sample before rounding
    resolution: Number | None = Field(
        default=None, ge=1e-9, le=1e3
    )  # mm or deg of one count, in place of counts_per_rev: for sensors of position that are no encoder


class LinkFile(TomlTable):
    """[links.DEVICE]: the driver, framing and address of a device.

    ``url`` is a serial port, ``tcp://HOST:PORT`` (text lines, Modbus RTU or TCP over a socket), or
    ``rfc2217://HOST:PORT``. It may be empty if a simulator supplies it. ``address`` is the Modbus address; 0 means the
    device's default.
    """

    driver: DriverName  # file in src/smarig/device/drivers
    framing: Literal["lines", "modbus_tcp", "modbus_rtu"]  # how bytes form messages
    url: LinkUrl = ""  # port or address of the device; empty if a simulator supplies it
    baud: int = Field(default=115200, ge=300, le=4_000_000)  # baud rate of a serial port
    serial_format: str = "8N1"  # of a serial port: data bits 5-8; parity N, E, O, M, S; stop bits 1, 1.5, 2
    address: int = Field(default=0, ge=0, le=247)  # Modbus address; 0: the device's default
    timeout_s: Number = Field(default=0.3, gt=0, le=5)  # time limit for one reply
    line_end: Literal["\n", "\r\n", "\r"] = "\n"  # ends a line of text; a reply ends with its last character
    settings: Settings = Field(default_factory=dict)  # keys of the driver's own: channels, scales, ranges

    @field_validator("serial_format")
    @classmethod
    def _is_serial_format(cls, text: str) -> str:
        if not _SERIAL_FORMAT.fullmatch(text):
            raise ValueError(
                f'"{text}" is no format of a serial line: write data bits (5 to 8), parity (N, E, O, M or S) and stop '
                'bits (1, 1.5 or 2), such as "7E2"'
            )
        return text

    @field_validator("url")
    @classmethod
    def _writes_no_file(cls, url: str) -> str:
        if url.lower().startswith("spy:") and "file=" in url.lower():
            raise ValueError("spy:// with file= would write a file; leave out file=")
        return url

    @model_validator(mode="after")
    def _lines_end(self) -> "LinkFile":
        if self.line_end != "\n" and self.framing != "lines":
            raise ValueError(f'line_end belongs to framing = "lines"; leave it out with "{self.framing}"')
        return self


class LinksFile(TomlTable):
    """[links]: the devices of a bench. The first two are required; one device may serve several of them."""

    amplifier: LinkFile  # device that drives the current
    encoder_daq: LinkFile  # device that reads the position
    thermometer: LinkFile | None = None  # device that measures the temperature of the wire
    room_thermometer: LinkFile | None = None  # device that measures the temperature of the room
    load_cell: LinkFile | None = None  # device that measures the force on the wire


class ProtectionFile(TomlTable):
    """[protection]: limits that the amplifier enforces, in addition to those of [limits] and the lease."""

    slew_max_A_per_s: Number = Field(ge=1e-6, le=1e9)  # largest rate of change of the current
    resistance_min_ohm: Number = Field(ge=0, le=1e9)  # a smaller value is a short circuit
    resistance_max_ohm: Number = Field(gt=0, le=1e9)  # a larger value is a broken wire or clamp
    heat_max_A2s: Number = Field(ge=1e-9, le=1e12)  # largest i²t integral
    heat_settle_s: Number = Field(ge=1e-3, le=1e9)  # time constant with which the i²t integral decays


class SimulatorFile(TomlTable):
    """[simulator]: the command starts simulated devices. ``speed`` × real time; 0: as fast as possible.

    ``devices``: "text" is the box that ``smarig new driver`` speaks to.
    ``faults``: file with faults to simulate. ``library``: the C firmware built for this computer, in place of the
    devices in Python. ``trace``: file for the true state of the simulated wire, which must not exist yet. With
    ``start = false`` the devices already run at the addresses of the links.
    """

    devices: Literal["reference", "labjack", "supply", "text"] = "reference"  # firmware_protocol's, or others
    make: MakeName = ""  # of a supply, as in makes.toml
    start: bool = True  # false: the devices already run at the addresses of the links
    speed: Number = Field(default=0.0, ge=0, le=1e6)  # × real time; 0: as fast as possible
    faults: FaultsPath = ""  # file with faults to simulate
    library: LibraryPath = ""  # the C firmware built for this computer, in place of Python
    trace: TracePath = ""  # new file for the true state of the wire


class RigFile(TomlTable):
    """configs/rigs/NAME.toml. ``base`` names another rig file, which supplies every key that is missing here."""

    file_kind = RIG_FILE
    name: str  # name of the file
    kind: Literal["twin", "bench"]  # twin: in this process; bench: over links
    base: str = ""  # another rig file, which supplies every key that is missing here
    actuator: ActuatorName  # file in configs/actuators, or path
    wire: str = Field(min_length=1, max_length=200)  # identity of the wire; its history is kept under it
    period_s: Number = Field(ge=1e-3, le=60)  # duration of a tick
    ambient_degC: Number = Field(ge=-273.15, le=1000)  # temperature of the room
    lease_s: Number = Field(ge=0.01, le=60)  # time without commands after which the amplifier switches off
    temperature_noise_K: Number = Field(ge=0, le=1000)  # noise of the hysteresis input, standard deviation
    temperature_noise_time_s: Number = Field(ge=1e-3, le=1e9)  # correlation time of this noise
    hidden_effect: bool = False  # twin: an effect is drawn from the seed
    load: LoadFile | None = None  # force on a single wire; else that of a thermomechanical wire's file
    limits: LimitsFile  # enforced by the host on every tick
    amplifier: AmplifierFile  # the amplifier of a twin
    encoder: EncoderFile  # the encoder of a twin
    links: LinksFile | None = None  # bench: the two devices
    protection: ProtectionFile | None = None  # bench: limits that the amplifier enforces
    simulator: SimulatorFile | None = None  # bench: simulated devices in place of real ones

    @model_validator(mode="after")
    def _links_match_kind(self) -> "RigFile":
        if self.kind == "bench" and (self.links is None or self.protection is None):
            raise ValueError(
                "a bench needs the tables [links.amplifier], [links.encoder_daq] and [protection]"
            )
        if self.kind == "twin" and (self.links or self.simulator):
            raise ValueError('a twin has no links; use kind = "bench"')
        if self.links and self.simulator and self.simulator.start:
            for device in ("amplifier", "encoder_daq"):
                if getattr(self.links, device).url:
                    raise ValueError(
                        f"links.{device}.url gives a device's address, but [simulator] starts simulated devices; "
                        "remove one of them, or set simulator.start = false"
                    )
        return self

    @model_validator(mode="after")
    def _period_fits_lease(self) -> "RigFile":
        """An instrument of an own driver may have no lease; one that has is checked when it is opened."""
        of_own_driver = self.links is not None and self.links.amplifier.driver.endswith(".py")
        if not of_own_driver and (problem := self.period_problem):
            raise ValueError(problem)
        return self

    @property
    def period_problem(self) -> str:
        """Why a tick is too long for the lease; "" if it is not."""
        if 2 * self.period_s <= self.lease_s:
            return ""
        return (
            f"period_s = {self.period_s:g} is too long for lease_s = {self.lease_s:g}: the lease must last for at "
            "least two ticks, or the current stays on for longer than it says"
        )

    @model_validator(mode="after")
    def _limits_within_saturation(self) -> "RigFile":
        most = max(self.limits.current_max_A, -self.limits.current_min_A)
        if most > self.amplifier.saturation_A:
            raise ValueError(
                f"limits allow {most:g} A but amplifier.saturation_A is {self.amplifier.saturation_A:g}; "
                "the amplifier would cut off larger currents without notice; lower the limits, or raise it if the "
                "amplifier delivers more"
            )
        return self


class CampaignStep(TomlTable):
    """One protocol of a campaign with its settings."""

    protocol: ProtocolName  # name of the protocol
    name: str = ""  # name of its run, needed if a protocol occurs twice
    purpose: Literal["prepare", "test", "train", "held_out"] = "train"  # use of its run
    set: Settings = Field(default_factory=dict)  # settings of the protocol, as with --set

    @field_validator("name")
    @classmethod
    def _plain_name(cls, name: str) -> str:
        if len(name) > 100 or name.startswith(".") or not _PLAIN_NAME.fullmatch(name):
            raise ValueError("a name of a run consists of letters, digits, spaces and - _ . + ( )")
        return name

    @property
    def label(self) -> str:
        """The name of its run: the given name, or else that of the protocol."""
        return self.name or Path(passed(self.protocol)).stem


class CampaignFile(TomlTable):
    """configs/campaigns/NAME.toml: protocols in order."""

    file_kind = CAMPAIGN_FILE
    name: str  # name of the file
    summary: str  # one line for smarig list
    step: tuple[CampaignStep, ...] = Field(min_length=1)  # the protocols in order

    @model_validator(mode="after")
    def _labels_unique(self) -> "CampaignFile":
        labels = [step.label for step in self.step]
        twice = next((label for label in labels if labels.count(label) > 1), None)
        if twice:
            raise ValueError(f"two steps are called '{twice}'; give each its own name (name = \"…\")")
        return self

    def run_files(self, folder: Path) -> list[Path]:
        """Paths of the runs of its steps, in order."""
        return [folder / f"{k:02d}_{step.label}.run.sqlite" for k, step in enumerate(self.step, start=1)]
