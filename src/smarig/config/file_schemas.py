"""The schemas of actuators, rigs and campaigns: frozen values, every mistake one sentence with its key.

Refuses to know where files are and what is done with them, and never fills in a physical quantity that a file leaves
out. The comment after a key is its text in the reference.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, model_validator

from smarig.core import Number, TomlTable


class Quantity(TomlTable):
    """A physical quantity: value, unit, and where the value comes from."""

    value: Number  # the number
    unit: str  # as the key demands it
    source: str  # where the value comes from: a paper, a data sheet, a calibration

    def __float__(self) -> float:
        return self.value


@dataclass(frozen=True)
class PositiveIn:
    """Demands a positive value in one unit."""

    unit: str

    def __call__(self, q: Quantity) -> Quantity:
        if q.unit != self.unit:
            raise ValueError(f"unit is '{q.unit}', expected '{self.unit}'")
        if q.value <= 0:
            raise ValueError(f"value {q.value:g} must be positive")
        return q


Millimetres = Annotated[Quantity, AfterValidator(PositiveIn("mm"))]
Ohms = Annotated[Quantity, AfterValidator(PositiveIn("ohm"))]
Kelvin = Annotated[Quantity, AfterValidator(PositiveIn("K"))]
Amperes = Annotated[Quantity, AfterValidator(PositiveIn("A"))]
Density = Annotated[Quantity, AfterValidator(PositiveIn("kg/m^3"))]
SpecificHeat = Annotated[Quantity, AfterValidator(PositiveIn("J/(kg K)"))]


class WireSection(TomlTable):
    """The wire itself; lengths of one active wire."""

    material: str  # alloy and make
    diameter: Millimetres  # of the wire
    active_length: Millimetres  # between the clamps, of one wire
    density: Density  # of the alloy
    specific_heat: SpecificHeat  # of the alloy


class HeatingSection(TomlTable):
    """What sets the temperature: resistances and one known steady state (5.3)."""

    resistance_martensite: Ohms  # of the cold wire
    resistance_austenite: Ohms  # of the hot wire
    reference_current: Amperes  # of the known steady state
    reference_temperature: Kelvin  # above ambient, at that current: sets R/hA (5.3)


class TransmissionSection(TomlTable):
    """How contraction becomes encoder angle and the rig's unit of position."""

    unit: Literal["mm", "deg"]  # of position, here and in every file made with this wire
    radius: Millimetres  # of the pulley that the wire turns


class HysteresisSection(TomlTable):
    """The operator a twin uses: a surface of Table 5.1 or a model file."""

    surface: str  # name of a surface of Table 5.1, or path of a model file
    initial: Literal["negative", "anhysteretic"]  # state that a twin's wire starts in


class ActuatorFile(TomlTable):
    """configs/actuators/NAME.toml"""

    name: str  # of the file
    arrangement: Literal["one_wire", "two_wire"]  # two wires pull against each other
    source: str  # where the set of values comes from
    wire: WireSection  # the wire itself
    heating: HeatingSection  # what sets the temperature
    transmission: TransmissionSection  # how contraction becomes position
    hysteresis: HysteresisSection  # what a twin moves by
    notes: str = ""  # a remark


class LimitsFile(TomlTable):
    """[limits]: checked on every tick, by the host; the device has its own."""

    current_min_A: Number  # least current; negative for two wires only
    current_max_A: Number  # largest current
    current_rate_A_per_s: Number = Field(gt=0)  # fastest change
    temperature_max_K: Number = Field(gt=0)  # hottest wire, above ambient, as predicted
    cycles_max: int | None = Field(default=None, strict=True, gt=0)  # of the wire, over all its runs

    @model_validator(mode="after")
    def _ordered(self) -> "LimitsFile":
        if not self.current_min_A <= 0 <= self.current_max_A:
            raise ValueError(
                "current_min_A ≤ 0 ≤ current_max_A is needed: zero current must always be allowed"
            )
        if self.current_min_A == self.current_max_A:
            raise ValueError("current_min_A and current_max_A are both 0: nothing could be driven")
        return self


class AmplifierFile(TomlTable):
    """[amplifier]: saturation and read-back noise (standard deviations)."""

    saturation_A: Number = Field(gt=0)  # no more comes out
    current_noise_A: Number = Field(ge=0)  # of a reading, standard deviation
    voltage_noise_V: Number = Field(ge=0)  # of a reading, standard deviation


class EncoderFile(TomlTable):
    """[encoder]: resolution and noise of one sample before quantisation."""

    counts_per_rev: int = Field(gt=0, le=10_000_000)  # counts of a turn
    noise_counts: Number = Field(ge=0, le=1e6)  # of one sample, before it is rounded


class LinkFile(TomlTable):
    """[links.DEVICE]: which driver talks to a device, by which framing, and where it is.

    ``url`` is a serial port or a URL of pyserial's (``socket://``, ``rfc2217://``), ``tcp://HOST:PORT`` for Modbus
    TCP; it may be left out where a simulator says it. ``address`` is Modbus's; 0 means the device's own.
    """

    driver: str  # file in src/smarig/device/drivers
    framing: Literal["lines", "modbus_tcp", "modbus_rtu"]  # how bytes make messages
    url: str = ""  # port or address of the device; empty where a simulator says it
    baud: int = Field(default=115200, ge=300, le=4_000_000)  # of a serial port
    address: int = Field(default=0, ge=0, le=247)  # Modbus's; 0: the device's own
    timeout_s: Number = Field(default=0.3, gt=0, le=5)  # patience for one answer


class LinksFile(TomlTable):
    """[links]: the two devices of a bench."""

    amplifier: LinkFile  # what drives the current
    encoder_daq: LinkFile  # what reads the position


class ProtectionFile(TomlTable):
    """[protection]: limits that the amplifier keeps by itself, beside those of [limits] and the lease."""

    slew_max_A_per_s: Number = Field(gt=0)  # fastest change of current
    resistance_min_ohm: Number = Field(ge=0)  # less is a short circuit
    resistance_max_ohm: Number = Field(gt=0)  # more is a broken wire or clamp
    heat_max_A2s: Number = Field(gt=0)  # largest i²t integral
    heat_settle_s: Number = Field(gt=0)  # time constant with which the i²t integral forgets


class SimulatorFile(TomlTable):
    """[simulator]: the devices are started by the command itself; ``speed`` × real time, 0 for as fast as asked.

    ``faults``: file of what goes wrong; ``library``: the C firmware built for this machine, in place of the devices in
    Python; ``trace``: file for what the wire felt. Without ``start`` they are running already, where the links say.
    """

    start: bool = True  # false: they are running already, where the links say
    speed: Number = Field(default=0.0, ge=0, le=1e6)  # × real time; 0: as fast as asked
    faults: str = ""  # file of what goes wrong
    library: str = ""  # the C firmware built for this machine, in place of Python
    trace: str = ""  # file for what the wire felt


class RigFile(TomlTable):
    """configs/rigs/NAME.toml; ``base`` names another rig file, which holds every key that is not given here."""

    name: str  # of the file
    kind: Literal["twin", "bench"]  # twin: in this process; bench: over links
    base: str = ""  # another rig file, which holds every key that is not given here
    actuator: str  # file in configs/actuators, or path
    wire: str = Field(min_length=1, max_length=200)  # who the wire is: its history is kept under this name
    period_s: Number = Field(ge=1e-3, le=60)  # a tick
    ambient_degC: Number = Field(ge=-273.15, le=1000)  # of the room
    lease_s: Number = Field(ge=0.01, le=60)  # of silence, after which the amplifier switches off
    temperature_noise_K: Number = Field(ge=0)  # that the hysteresis feels, standard deviation
    temperature_noise_time_s: Number = Field(gt=0)  # how long such noise lasts
    hidden_effect: bool = False  # twin: an effect is drawn from the seed
    limits: LimitsFile  # kept by the host on every tick
    amplifier: AmplifierFile  # what a twin's amplifier does
    encoder: EncoderFile  # what a twin's encoder does
    links: LinksFile | None = None  # bench: the two devices
    protection: ProtectionFile | None = None  # bench: what the amplifier keeps by itself
    simulator: SimulatorFile | None = None  # bench: simulated devices in place of real ones

    @model_validator(mode="after")
    def _links_match_kind(self) -> "RigFile":
        if self.kind == "bench" and (self.links is None or self.protection is None):
            raise ValueError(
                "a bench needs the tables [links.amplifier], [links.encoder_daq] and [protection]"
            )
        if self.kind == "twin" and (self.links or self.simulator):
            raise ValueError('a twin has no links: kind = "bench" has')
        if self.links and self.simulator and self.simulator.start:
            for device in ("amplifier", "encoder_daq"):
                if getattr(self.links, device).url:
                    raise ValueError(
                        f"links.{device}.url says where a device is, but [simulator] starts simulated ones: "
                        "give one of the two, or simulator.start = false"
                    )
        return self

    @model_validator(mode="after")
    def _limits_within_saturation(self) -> "RigFile":
        most = max(self.limits.current_max_A, -self.limits.current_min_A)
        if most > self.amplifier.saturation_A:
            raise ValueError(
                f"limits allow {most:g} A but amplifier.saturation_A is {self.amplifier.saturation_A:g}: "
                "what is beyond would be cut off silently; lower the limits"
            )
        return self


class CampaignStep(TomlTable):
    """One protocol of a campaign with its settings."""

    protocol: str  # which one
    name: str = ""  # of its run, where a protocol comes twice
    purpose: Literal["prepare", "test", "train", "held_out"] = "train"  # what its run is for
    set: dict[str, Any] = Field(default_factory=dict)  # settings of the protocol, as with --set

    @property
    def label(self) -> str:
        """What its run is called: its name, or its protocol's."""
        return self.name or Path(self.protocol).stem


class CampaignFile(TomlTable):
    """configs/campaigns/NAME.toml: protocols in order."""

    name: str  # of the file
    summary: str  # one line, for smarig list
    step: tuple[CampaignStep, ...] = Field(min_length=1)  # the protocols, in order

    @model_validator(mode="after")
    def _labels_unique(self) -> "CampaignFile":
        labels = [step.label for step in self.step]
        twice = next((label for label in labels if labels.count(label) > 1), None)
        if twice:
            raise ValueError(f"two steps are called '{twice}'; give each a name of its own (name = \"…\")")
        return self

    def run_files(self, folder: Path) -> list[Path]:
        """Where the runs of its steps go, in order."""
        return [folder / f"{k:02d}_{step.label}.run.sqlite" for k, step in enumerate(self.step, start=1)]
