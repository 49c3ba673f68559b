"""Configuration files: TOML in, frozen and checked values out, every mistake one sentence with its key.

Knows the schema of actuators and rigs. Refuses to know what is done with them, and never fills in a
physical quantity that the file leaves out.
"""

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, Field, model_validator

from smarig.catalogue import suggestion
from smarig.errors import ConfigError, UsageError
from smarig.resources import shipped
from smarig.toml_file import Number, Section, check, load, read_toml


class Quantity(Section):
    """A physical quantity: value, unit, and where the value comes from."""

    value: Number
    unit: str
    source: str

    def __float__(self) -> float:
        return self.value


def _unit(expected: str):
    def check(q: Quantity) -> Quantity:
        if q.unit != expected:
            raise ValueError(f"unit is '{q.unit}', expected '{expected}'")
        if q.value <= 0:
            raise ValueError(f"value {q.value:g} must be positive")
        return q

    return AfterValidator(check)


Millimetres = Annotated[Quantity, _unit("mm")]
Ohms = Annotated[Quantity, _unit("ohm")]
Kelvin = Annotated[Quantity, _unit("K")]
Amperes = Annotated[Quantity, _unit("A")]
Density = Annotated[Quantity, _unit("kg/m^3")]
SpecificHeat = Annotated[Quantity, _unit("J/(kg K)")]


class Wire(Section):
    """The wire itself; lengths of one active wire."""

    material: str
    diameter: Millimetres
    active_length: Millimetres
    density: Density
    specific_heat: SpecificHeat


class Heating(Section):
    """What sets the temperature: resistances and one known steady state (5.3)."""

    resistance_martensite: Ohms
    resistance_austenite: Ohms
    reference_current: Amperes
    reference_temperature: Kelvin


class Transmission(Section):
    """How contraction becomes encoder angle and the rig's unit of position."""

    unit: Literal["mm", "deg"]
    radius: Millimetres


class Hysteresis(Section):
    """The operator a twin uses: a surface of Table 5.1 or a model file."""

    surface: str
    initial: Literal["negative", "anhysteretic"]


class ActuatorFile(Section):
    """configs/actuators/NAME.toml"""

    name: str
    arrangement: Literal["one_wire", "two_wire"]
    source: str
    wire: Wire
    heating: Heating
    transmission: Transmission
    hysteresis: Hysteresis
    notes: str = ""


class LimitsFile(Section):
    """[limits]: checked on every tick, by the host; the device has its own."""

    current_min_A: Number
    current_max_A: Number
    current_rate_A_per_s: Number = Field(gt=0)
    temperature_max_K: Number = Field(gt=0)
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


class AmplifierFile(Section):
    """[amplifier]: saturation and read-back noise (standard deviations)."""

    saturation_A: Number = Field(gt=0)
    current_noise_A: Number = Field(ge=0)
    voltage_noise_V: Number = Field(ge=0)


class EncoderFile(Section):
    """[encoder]: resolution and noise of one sample before quantisation."""

    counts_per_rev: int = Field(gt=0, le=10_000_000)
    noise_counts: Number = Field(ge=0, le=1e6)


class LinkFile(Section):
    """[links.DEVICE]: which driver talks to a device, by which framing, and where it is.

    ``url`` is a serial port or a URL of pyserial's (``socket://``, ``rfc2217://``), ``tcp://HOST:PORT`` for Modbus
    TCP; it may be left out where a simulator says it. ``address`` is Modbus's; 0 means the device's own.
    """

    driver: str
    framing: Literal["lines", "modbus_tcp", "modbus_rtu"]
    url: str = ""
    baud: int = Field(default=115200, ge=300, le=4_000_000)
    address: int = Field(default=0, ge=0, le=247)
    timeout_s: Number = Field(default=0.3, gt=0, le=5)


class LinksFile(Section):
    """[links]: the two devices of a bench."""

    amplifier: LinkFile
    encoder_daq: LinkFile


class ProtectionFile(Section):
    """[protection]: limits that the amplifier keeps by itself, beside those of [limits] and the lease."""

    slew_max_A_per_s: Number = Field(gt=0)
    resistance_min_ohm: Number = Field(ge=0)
    resistance_max_ohm: Number = Field(gt=0)
    heat_max_A2s: Number = Field(gt=0)
    heat_settle_s: Number = Field(gt=0)


class SimulatorFile(Section):
    """[simulator]: the devices are started by the command itself; ``speed`` × real time, 0 for as fast as asked.

    ``faults``: file of what goes wrong; ``library``: the C firmware built for this machine, in place of the devices in
    Python; ``trace``: file for what the wire felt. Without ``start`` they are running already, where the links say.
    """

    start: bool = True
    speed: Number = Field(default=0.0, ge=0, le=1e6)
    faults: str = ""
    library: str = ""
    trace: str = ""


class RigFile(Section):
    """configs/rigs/NAME.toml; ``base`` names another rig file, which holds every key that is not given here."""

    name: str
    kind: Literal["twin", "bench"]
    base: str = ""
    actuator: str
    wire: str = Field(min_length=1, max_length=200)
    period_s: Number = Field(ge=1e-3, le=60)
    ambient_degC: Number = Field(ge=-273.15, le=1000)
    lease_s: Number = Field(ge=0.01, le=60)
    temperature_noise_K: Number = Field(ge=0)
    temperature_noise_time_s: Number = Field(gt=0)
    hidden_effect: bool = False
    limits: LimitsFile
    amplifier: AmplifierFile
    encoder: EncoderFile
    links: LinksFile | None = None
    protection: ProtectionFile | None = None
    simulator: SimulatorFile | None = None

    @model_validator(mode="after")
    def _reaches_something(self) -> "RigFile":
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
    def _reachable(self) -> "RigFile":
        most = max(self.limits.current_max_A, -self.limits.current_min_A)
        if most > self.amplifier.saturation_A:
            raise ValueError(
                f"limits allow {most:g} A but amplifier.saturation_A is {self.amplifier.saturation_A:g}: "
                "what is beyond would be cut off silently; lower the limits"
            )
        return self


class CampaignStep(Section):
    """One protocol of a campaign with its settings."""

    protocol: str
    name: str = ""
    purpose: Literal["prepare", "test", "train", "held_out"] = "train"
    set: dict[str, Any] = Field(default_factory=dict)

    @property
    def label(self) -> str:
        """What its run is called: its name, or its protocol's."""
        return self.name or self.protocol


class CampaignFile(Section):
    """configs/campaigns/NAME.toml: protocols in order."""

    name: str
    summary: str
    step: tuple[CampaignStep, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _told_apart(self) -> "CampaignFile":
        labels = [step.label for step in self.step]
        twice = next((label for label in labels if labels.count(label) > 1), None)
        if twice:
            raise ValueError(f"two steps are called '{twice}'; give each a name of its own (name = \"…\")")
        return self

    def run_files(self, folder: Path) -> list[Path]:
        """Where the runs of its steps go, in order."""
        return [folder / f"{k:02d}_{step.label}.run.sqlite" for k, step in enumerate(self.step, start=1)]


_FOLDERS: dict[str, type[BaseModel]] = {"rigs": RigFile, "actuators": ActuatorFile, "campaigns": CampaignFile}


def listed(folder: str) -> list[str]:
    """Names shipped in a folder of configs/.

    >>> listed("actuators")
    ['gorbet_one_wire', 'gorbet_two_wire']
    """
    return sorted(p.stem for p in (shipped("configs") / folder).glob("*.toml"))


def locate(folder: str, name: str) -> Path:
    """Path of a named or given configuration file; UsageError with the nearest name otherwise."""
    path = Path(name)
    if path.suffix == ".toml" or path.is_file():
        if not path.is_file():
            raise UsageError(f"There is no file {path}.")
        return path
    if name in listed(folder):
        return shipped("configs") / folder / f"{name}.toml"
    raise UsageError(f"No {folder.rstrip('s')} '{name}'{suggestion(name, listed(folder))}.")


def load_actuator(name: str) -> ActuatorFile:
    """An actuator by name or path."""
    return load(ActuatorFile, locate("actuators", name))


def load_rig(name: str) -> RigFile:
    """A rig by name or path."""
    files = _rig_files(name)
    raw: dict[str, Any] = {}
    for _, table in files:
        raw = _over(table, raw)
    return check(RigFile, raw, str(files[0][0]))


def _over(base: dict[str, Any], mine: dict[str, Any]) -> dict[str, Any]:
    """Tables key by key; anything else as a whole."""
    both = {
        key: _over(base[key], mine[key]) for key in base.keys() & mine.keys() if _tables(base[key], mine[key])
    }
    return base | mine | both


def _tables(*values: Any) -> bool:
    return all(isinstance(value, dict) for value in values)


def rig_text(name: str) -> str:
    """The files that a rig is made of, as they are."""
    return "\n".join(path.read_text(encoding="utf-8") for path, _ in _rig_files(name))


def _rig_files(name: str) -> list[tuple[Path, dict[str, Any]]]:
    """A rig's file, that of its base, and so on."""
    found: list[tuple[Path, dict[str, Any]]] = []
    while name:
        path = locate("rigs", name)
        if path in (known for known, _ in found):
            raise ConfigError(f"{path} is its own base.")
        raw = read_toml(path)
        found.append((path, raw))
        name = raw.get("base", "")
        if not isinstance(name, str):
            raise ConfigError(f"{path}: base: name another rig file.")
    return found


def load_campaign(name: str) -> CampaignFile:
    """A campaign by name or path."""
    return load(CampaignFile, locate("campaigns", name))
