"""The wire of a rig file, tick by tick, and its quantities in the units in which instruments read them."""

from smarig.config import RigFile
from smarig.device import load_register_map
from smarig.plant import Actuator, load_of
from smarig.rig import RawReading, Specimen, TwinSettings


class WireQuantities:
    """``reading`` and ``counts`` are those of the last tick."""

    def __init__(self, file: RigFile, settings: TwinSettings) -> None:
        self.file = file
        actuator = Actuator.named(file.actuator)
        self.specimen = Specimen(file, actuator, settings)
        self._load = load_of(file, actuator)
        self._per_A, self._per_V = (
            next(f for f in load_register_map("amplifier")["ring"].field if f.name == name).per_unit
            for name in ("current", "voltage")
        )
        self._per_degC = next(
            f for f in load_register_map("encoder_daq")["ring"].field if f.name == "ambient"
        ).per_unit
        self.counts = self.specimen.counts_now()
        self.reading = RawReading(0, 0, self.counts, round(file.ambient_degC * self._per_degC), 0, False)

    def advance(self, current_A: float) -> None:
        """One tick with this current."""
        self.reading = self.specimen.advance(current_A)
        self.counts = self.reading.counts

    def quantity(self, name: str) -> float:
        """``current`` (A), ``voltage`` (V), ``position`` (mm, deg), ``force`` (N), ``temperature`` of the room (°C)."""
        match name:
            case "current":
                return self.reading.current / self._per_A
            case "voltage":
                return self.reading.voltage / self._per_V
            case "position":
                return self.counts * self.specimen.position_per_count
            case "force":
                force = self._load.force() if self._load else None
                return force(self.specimen.tick * self.file.period_s) if force else 0.0
        return self.reading.ambient / self._per_degC
