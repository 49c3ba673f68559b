"""One bench: a wire, the amplifier that heats it, the encoder that measures it, and one device time.

``tick`` lets a period pass. ``answer`` carries one request to a device. pace.py decides when ticks happen.
"""

from collections.abc import Sequence
from typing import Protocol

from simulators.amplifier import SATURATED
from simulators.encoder_daq import INDEX
from simulators.faults import BrownOut, ClockDrift, Reboot, SimulatedFault
from simulators.framed_device import AmplifierStation, DaqStation, Station
from simulators.reading_troubles import EncoderFaults, WireFaults
from smarig.device import Exchange, load_register_map
from smarig.rig import RawReading

AMPLIFIER, DAQ = "amplifier", "encoder_daq"


class WireModel(Protocol):
    """The physics: smarig.rig.specimen.Specimen, or a substitute in tests."""

    def advance(self, output_A: float) -> RawReading:
        """Advance one tick with this output."""
        ...

    def counts_now(self) -> int:
        """The present counts of the encoder."""
        ...

    @property
    def wire_K(self) -> Sequence[float]:
        """The temperature of each wire above ambient; a fault that brings a thermometer asks for it."""
        ...


class DevicePower:
    """Reboots, power failures and the clock rate of one device."""

    def __init__(self, faults: Sequence[SimulatedFault], name: str) -> None:
        mine = [f for f in faults if f.device == name]
        self._drifts = tuple(f for f in mine if isinstance(f, ClockDrift))
        self._cuts = tuple(f for f in mine if isinstance(f, BrownOut))
        self._reboots = [f for f in mine if isinstance(f, Reboot)]
        self._phase = 0.0
        self._boots = 1
        self.on = True

    def update(self, station: Station, time_s: float, exchange: int) -> bool:
        """Boot the device when due; returns whether it booted."""
        due = [f for f in self._reboots if f.active(time_s, exchange)]
        self._reboots = [f for f in self._reboots if f not in due]
        was_on = self.on
        self.on = not any(f.active(time_s, exchange) for f in self._cuts)
        booted = bool(due) or (self.on and not was_on)
        if booted:
            self._boots += 1
            station.boot(self._boots)
        return booted

    def ticks(self, time_s: float, exchange: int) -> int:
        """The number of its own periods that the device completes in one period of the bench."""
        if not self.on:
            return 0
        self._phase += 1 + 1e-6 * sum(f.ppm for f in self._drifts if f.active(time_s, exchange))
        whole = int(self._phase + 1e-9)
        self._phase -= whole
        return whole


class SimulatedBench:
    """Both devices on one wire. ``faults`` act on readings and power; faults of bytes belong to the ports."""

    def __init__(
        self,
        wire: WireModel,
        amplifier: AmplifierStation,
        daq: DaqStation,
        period_s: float,
        counts_per_rev: int,
        faults: Sequence[SimulatedFault] = (),
    ) -> None:
        self.amplifier, self.daq = amplifier, daq
        self.period_s, self._counts_per_rev = period_s, counts_per_rev
        self.ticks = 0
        self.exchanges = {AMPLIFIER: 0, DAQ: 0}
        self.flowed_uA = 0
        self.raw_counts = wire.counts_now()
        self._wire = wire
        self._amperes = load_register_map(AMPLIFIER)["output"].value
        self._stations: dict[str, Station] = {AMPLIFIER: amplifier, DAQ: daq}
        self._power = {name: DevicePower(faults, name) for name in self._stations}
        self._wire_faults, self._encoder_faults = WireFaults(faults), EncoderFaults(faults)
        self._update_position()

    @property
    def time_s(self) -> float:
        """Device time since power-up."""
        return self.ticks * self.period_s

    def station(self, name: str) -> Station:
        """The device with this name in the register maps."""
        return self._stations[name]

    def decoded(self, name: str, request: bytes) -> Exchange | None:
        """The exchange of a request to a device, or None."""
        parsed = self._stations[name].framing.decode(request)
        return parsed.requested if parsed and isinstance(parsed.requested, Exchange) else None

    def answer(self, name: str, request: bytes) -> bytes | None:
        """The reply of a device to one request, or None."""
        self._update_power(name)
        return self._stations[name].answer(request) if self._power[name].on else None

    def tick(self) -> None:
        """Let a period pass: the output flows, the wire responds, and both devices measure."""
        for name in self._stations:
            self._update_power(name)
        output_uA = self.amplifier.output_uA if self._power[AMPLIFIER].on else 0
        broken = self._wire_faults.interrupted(*self._now(AMPLIFIER))
        factor = self._wire_faults.low_factor(*self._now(AMPLIFIER))
        self.flowed_uA = 0 if broken else round(output_uA * factor)
        reading = self._wire.advance(self._amperes.decode(self.flowed_uA))
        self._tick_amplifier(reading, output_uA)
        self._tick_daq(reading)
        self.ticks += 1

    def _tick_amplifier(self, reading: RawReading, output_uA: int) -> None:
        moment = self._now(AMPLIFIER)
        amplifier_reading = self._wire_faults.measured(reading, output_uA, *moment)
        if self._wire_faults.has_thermometer:
            hottest_K = max(self._wire.wire_K)
            amplifier_reading = self._wire_faults.temperature(hottest_K, amplifier_reading, *moment)
        for _ in range(self._power[AMPLIFIER].ticks(*moment)):
            hardware = SATURATED if amplifier_reading.saturated else 0
            self.amplifier.tick(
                amplifier_reading.current, amplifier_reading.voltage, amplifier_reading.temperature, hardware
            )

    def _tick_daq(self, reading: RawReading) -> None:
        moment = self._now(DAQ)
        turn = self.raw_counts // self._counts_per_rev
        self.raw_counts = self._encoder_faults.sample(reading.counts, *moment)
        index = INDEX if self.raw_counts // self._counts_per_rev != turn else 0
        for _ in range(self._power[DAQ].ticks(*moment)):
            self.daq.tick(self.raw_counts, reading.ambient, index)
        self._update_position()

    def _update_power(self, name: str) -> None:
        booted = self._power[name].update(self._stations[name], *self._now(name))
        if booted and name == DAQ:
            self._update_position()

    def _update_position(self) -> None:
        self.daq.now(self._encoder_faults.now(self._wire.counts_now()))

    def _now(self, name: str) -> tuple[float, int]:
        return self.time_s, self.exchanges[name]
