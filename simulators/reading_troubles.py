"""Faults that act on the wire, the shunt, the thermometer and the encoder."""

from collections.abc import Iterable

from simulators.faults import (
    DriftingShunt,
    JumpingEncoder,
    LowShunt,
    OpenWire,
    SimulatedFault,
    SlippingEncoder,
    StuckEncoder,
    Thermometer,
)
from smarig.device import VALUE_RANGES, load_register_map
from smarig.rig import RawReading

_FIELDS = {f.name: f for f in load_register_map("amplifier")["ring"].field}


class WireFaults:
    """An open wire, a drifting shunt, a shunt that reads low, a thermometer that reads high or nothing."""

    def __init__(self, faults: Iterable[SimulatedFault]) -> None:
        self._open = tuple(f for f in faults if isinstance(f, OpenWire))
        self._shunt = tuple(f for f in faults if isinstance(f, DriftingShunt))
        self._low = tuple(f for f in faults if isinstance(f, LowShunt))
        self._thermometers = tuple(f for f in faults if isinstance(f, Thermometer))
        self.has_thermometer = bool(self._thermometers)

    def interrupted(self, time_s: float, exchange: int) -> OpenWire | None:
        """The break in the wire, if there is one now."""
        return next((f for f in self._open if f.active(time_s, exchange)), None)

    def low_factor(self, time_s: float, exchange: int) -> float:
        """The true current over the reading of the shunt."""
        return next((f.factor for f in self._low if f.active(time_s, exchange)), 1.0)

    def temperature(self, wire_K: float, reading: RawReading, time_s: float, exchange: int) -> RawReading:
        """The reading with the temperature of a wire that is so much above ambient, as its thermometer reads it."""
        active = next((f for f in self._thermometers if f.active(time_s, exchange)), None)
        if active is not None and active.excess_K is None:
            return reading
        excess_K = (active.excess_K or 0.0) if active else 0.0
        low, high = VALUE_RANGES[_FIELDS["temperature"].type]
        read = reading.ambient + round((wire_K + excess_K) * _FIELDS["temperature"].per_unit)
        return reading._replace(temperature=min(max(read, low + 1), high))  # the lowest is no reading

    def measured(self, reading: RawReading, output_uA: int, time_s: float, exchange: int) -> RawReading:
        """The reading as the amplifier measures it."""
        broken = self.interrupted(time_s, exchange)
        if broken and output_uA:
            volts = broken.supply_V if output_uA > 0 else -broken.supply_V
            reading = reading._replace(voltage=_FIELDS["voltage"].encode(volts), saturated=True)
        low_factor = self.low_factor(time_s, exchange)
        if low_factor != 1.0:
            reading = reading._replace(current=round(reading.current / low_factor))
        for f in self._shunt:
            if f.active(time_s, exchange):
                gain = 1 + f.gain_per_s * (time_s - f.from_s)
                low, high = VALUE_RANGES[_FIELDS["current"].type]
                reading = reading._replace(current=min(max(round(reading.current * gain), low), high))
        return reading


class EncoderFaults:
    """An encoder that sticks, slips or jumps. Lost counts stay lost."""

    def __init__(self, faults: Iterable[SimulatedFault]) -> None:
        of_encoder = (StuckEncoder, SlippingEncoder, JumpingEncoder)
        self._faults = tuple(f for f in faults if isinstance(f, of_encoder))
        self._jumped: set[int] = set()
        self._lost_counts = 0.0
        self._held: int | None = None
        self._before: int | None = None

    def sample(self, raw_counts: int, time_s: float, exchange: int) -> int:
        """The counts of the faulty encoder at the end of a tick."""
        stuck = False
        moved = 0 if self._before is None else raw_counts - self._before
        for number, f in enumerate(self._faults):
            if not f.active(time_s, exchange):
                continue
            if isinstance(f, StuckEncoder):
                stuck = True
            elif isinstance(f, SlippingEncoder):
                self._lost_counts += f.share * moved
            elif isinstance(f, JumpingEncoder) and number not in self._jumped:
                self._jumped.add(number)
                self._lost_counts -= f.counts
        self._before = raw_counts
        if not stuck:
            self._held = None
        elif self._held is None:
            self._held = self._true(raw_counts)
        return self.now(raw_counts)

    def now(self, raw_counts: int) -> int:
        """The counts between two ticks."""
        return self._true(raw_counts) if self._held is None else self._held

    def _true(self, raw_counts: int) -> int:
        return raw_counts - round(self._lost_counts)
