"""A stub of the package nidaqmx: the calls that the drivers use, on one device with a resistor of 5 ohm.

``test_stub.py`` compares its signatures with those of the real package, where that is installed.
"""

import enum
import time
from types import SimpleNamespace
from typing import Any, NamedTuple

OHM, A_PER_V, DEGC = 5.0, 0.25, 21.5


class Error(Exception):
    """Base class of its errors."""


class DaqError(Error):
    """An error of the driver."""


class DaqNotFoundError(Error):
    """The driver is not installed."""


class World:
    """The device Dev1. ``fault``: message of every further call; ``has_watchdog``: whether it has that task."""

    def __init__(self) -> None:
        self.ao_V, self.counts, self.fault = 0.0, 0, ""
        self.has_watchdog, self.installed, self.stuck = True, True, False
        self.fed_s, self.timeout_s, self.open_tasks = 0.0, 0.0, 0
        self.expired = False
        self.watching = False
        self.pulses: dict[str, tuple[float, float]] = {}  # running clocks by terminal: start, frequency
        self.path: Any = None  # counts by number of the edge, of a moving encoder

    def edges(self, terminal: str) -> int:
        """The pulses so far at a terminal."""
        if terminal not in self.pulses:
            return 0
        since_s, frequency = self.pulses[terminal]
        return int((time.monotonic() - since_s) * SPEED[0] * frequency)

    def check(self, name: str = "Dev1") -> None:
        """Raise what the driver would raise, and let the watchdog act."""
        if not self.installed:
            raise DaqNotFoundError("Could not find an installation of NI-DAQmx. Please ensure that …")
        if self.fault:
            raise DaqError(f"{self.fault}\n\nStatus Code: -200000")
        if name.split("/")[0] != "Dev1":
            raise DaqError("Device identifier is invalid.\n\nStatus Code: -200220")
        if self.watching and time.monotonic() - self.fed_s > self.timeout_s:
            self.expired, self.ao_V = True, 0.0

    def ai(self, channel: str) -> float:
        """Voltage at an input: shunt of 1 ohm, wire, laser of 1 V, load cell of 2 V."""
        current_A = A_PER_V * self.ao_V
        known = {"ai0": current_A, "ai1": OHM * current_A, "ai2": 1.0, "ai3": 2.0}
        return known[channel.split("/")[1]]


WORLD = World()


class TerminalConfiguration(enum.Enum):
    DEFAULT, RSE, NRSE, DIFF = range(4)


class EncoderType(enum.Enum):
    X_4 = 1


class AngleUnits(enum.Enum):
    TICKS = 1


class AcquisitionType(enum.Enum):
    FINITE, CONTINUOUS = range(2)


class TemperatureUnits(enum.Enum):
    DEG_C = 1


class ThermocoupleType(enum.Enum):
    E, J, K, R, S, T = range(6)


class CJCSource(enum.Enum):
    BUILT_IN = 1


class WatchdogAOExpirState(enum.Enum):
    VOLTAGE = 1


class AOExpirationState(NamedTuple):
    """State of an output after the watchdog has acted."""

    physical_channel: str
    expiration_state: float
    output_type: WatchdogAOExpirState


class AOChannelCollection:
    """Outputs of a task."""

    def __init__(self, task: "Task") -> None:
        self.task = task

    def add_ao_voltage_chan(
        self, physical_channel: str, *, min_val: float = -10.0, max_val: float = 10.0
    ) -> None:
        WORLD.check(physical_channel)
        assert -10 <= min_val < max_val <= 10
        self.task.channels.append(("ao", physical_channel))


class AIChannelCollection:
    """Inputs of a task."""

    def __init__(self, task: "Task") -> None:
        self.task = task

    def add_ai_voltage_chan(
        self,
        physical_channel: str,
        *,
        terminal_config: TerminalConfiguration = TerminalConfiguration.DEFAULT,
        min_val: float = -5.0,
        max_val: float = 5.0,
    ) -> None:
        WORLD.check(physical_channel)
        assert isinstance(terminal_config, TerminalConfiguration)
        assert min_val < max_val
        self.task.channels.append(("ai", physical_channel))

    def add_ai_thrmcpl_chan(
        self,
        physical_channel: str,
        *,
        min_val: float = 0.0,
        max_val: float = 100.0,
        units: TemperatureUnits = TemperatureUnits.DEG_C,
        thermocouple_type: ThermocoupleType = ThermocoupleType.J,
        cjc_source: CJCSource = CJCSource.BUILT_IN,
    ) -> None:
        WORLD.check(physical_channel)
        assert min_val < max_val
        assert (type(units), type(thermocouple_type), type(cjc_source)) == (
            TemperatureUnits,
            ThermocoupleType,
            CJCSource,
        )
        self.task.channels.append(("degC", physical_channel))


class CIChannelCollection:
    """Counters of a task."""

    def __init__(self, task: "Task") -> None:
        self.task = task

    def add_ci_ang_encoder_chan(
        self,
        counter: str,
        *,
        decoding_type: EncoderType = EncoderType.X_4,
        units: AngleUnits = AngleUnits.TICKS,
    ) -> None:
        WORLD.check(counter)
        assert (decoding_type, units) == (EncoderType.X_4, AngleUnits.TICKS)
        self.task.channels.append(("ctr", counter))
        self.task.zero = WORLD.counts


class COChannelCollection:
    """Pulses of a task."""

    def __init__(self, task: "Task") -> None:
        self.task = task

    def add_co_pulse_chan_freq(self, counter: str, *, freq: float = 1.0) -> None:
        WORLD.check(counter)
        device, name = counter.split("/")
        self.task.pulse = (f"/{device}/{name.capitalize()}InternalOutput", freq)


class Timing:
    """The sample clock of a task."""

    def __init__(self, task: "Task") -> None:
        self.task = task

    def cfg_samp_clk_timing(
        self,
        rate: float,
        source: str = "",
        *,
        sample_mode: AcquisitionType = AcquisitionType.FINITE,
        samps_per_chan: int = 1000,
    ) -> None:
        assert rate > 0
        assert sample_mode is AcquisitionType.CONTINUOUS
        self.task.source, self.task.buffer = source, samps_per_chan

    def cfg_implicit_timing(self, sample_mode: AcquisitionType = AcquisitionType.FINITE) -> None:
        assert sample_mode is AcquisitionType.CONTINUOUS
        assert self.task.pulse


class Task:
    """Software-timed, or by the pulses of another; a counter must be started."""

    def __init__(self) -> None:
        WORLD.check()
        WORLD.open_tasks += 1
        self.channels: list[tuple[str, str]] = []
        self.ao_channels, self.ai_channels = AOChannelCollection(self), AIChannelCollection(self)
        self.ci_channels, self.co_channels = CIChannelCollection(self), COChannelCollection(self)
        self.timing, self.source, self.buffer, self.taken = Timing(self), "", 0, 0
        self.pulse: tuple[str, float] | None = None
        self.started = self.closed = False
        self.zero = 0

    def start(self) -> None:
        WORLD.check()
        self.started = True
        if self.pulse:
            assert self.pulse[0] not in WORLD.pulses
            WORLD.pulses[self.pulse[0]] = (time.monotonic(), self.pulse[1])

    def read(self, number_of_samples_per_channel: int | None = None) -> Any:
        WORLD.check()
        if self.source:
            assert number_of_samples_per_channel == READ_ALL_AVAILABLE
            return self._sampled()
        if self.closed:
            raise DaqError("Task specified is invalid or does not exist.\n\nStatus Code: -200088")
        found = [self._value(kind, channel) for kind, channel in self.channels]
        return found if len(found) > 1 else found[0]

    def _sampled(self) -> list[float]:
        """One value for each edge since the last call."""
        assert self.started
        edges, first = WORLD.edges(self.source), self.taken
        if edges - first > self.buffer:
            raise DaqError("Attempted to read samples that are no longer available.\n\nStatus Code: -200279")
        self.taken = edges
        path = WORLD.path or (lambda _edge: WORLD.counts)
        return [float(path(k) - self.zero) for k in range(first, edges)]

    def _value(self, kind: str, channel: str) -> float:
        match kind:
            case "ai":
                return WORLD.ai(channel)
            case "degC":
                return DEGC
        assert kind == "ctr"
        assert self.started
        return WORLD.counts - self.zero

    def write(self, data: float, *, auto_start: bool = False) -> None:
        WORLD.check()
        assert auto_start
        if not WORLD.expired and not WORLD.stuck:
            WORLD.ao_V = data

    def close(self) -> None:
        if not self.closed:
            WORLD.open_tasks -= 1
            WORLD.pulses.pop(self.pulse[0] if self.pulse else "", None)
        self.closed = True


class WatchdogTask:
    """The watchdog of a device that has one."""

    def __init__(self, device_name: str, *, timeout: float = 10) -> None:
        WORLD.check(device_name)
        if not WORLD.has_watchdog:
            raise DaqError("Watchdog timer is not supported by the device.\n\nStatus Code: -200670")
        WORLD.open_tasks += 1
        self.timeout, self.states = timeout, list[AOExpirationState]()

    @property
    def expired(self) -> bool:
        WORLD.check()
        return WORLD.expired

    def cfg_watchdog_ao_expir_states(self, expiration_states: list[AOExpirationState]) -> None:
        self.states = expiration_states

    def start(self) -> None:
        assert [(s.physical_channel, s.expiration_state) for s in self.states] == [("Dev1/ao0", 0.0)]
        WORLD.timeout_s, WORLD.fed_s, WORLD.watching = self.timeout / SPEED[0], time.monotonic(), True

    def reset_timer(self) -> None:
        WORLD.check()
        WORLD.fed_s = time.monotonic()

    def clear_expiration(self) -> None:
        WORLD.expired = WORLD.watching = False

    def close(self) -> None:
        WORLD.open_tasks -= 1
        WORLD.watching = False


SPEED = [1.0]  # device seconds per second
READ_ALL_AVAILABLE = -1


class Device:
    """A device by its name."""

    def __init__(self, name: str) -> None:
        WORLD.check(name)
        self.product_type, self.serial_num = "USB-6001", 0x1A2B3C


constants = SimpleNamespace(
    TerminalConfiguration=TerminalConfiguration,
    EncoderType=EncoderType,
    AngleUnits=AngleUnits,
    AcquisitionType=AcquisitionType,
    READ_ALL_AVAILABLE=READ_ALL_AVAILABLE,
    TemperatureUnits=TemperatureUnits,
    ThermocoupleType=ThermocoupleType,
    CJCSource=CJCSource,
    WatchdogAOExpirState=WatchdogAOExpirState,
)
errors = SimpleNamespace(Error=Error, DaqError=DaqError, DaqNotFoundError=DaqNotFoundError)
system = SimpleNamespace(WatchdogTask=WatchdogTask, Device=Device)
types = SimpleNamespace(AOExpirationState=AOExpirationState)
PACKAGE = SimpleNamespace(Task=Task, constants=constants, errors=errors, system=system, types=types)
