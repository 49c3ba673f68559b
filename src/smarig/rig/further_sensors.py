"""The sensors of a bench besides its encoder: thermometers of wire and room, and a load cell.

They are queried once for every block of samples; their readings belong to its last sample, and to the following ones
until the next query. A sensor that gives no reading leaves NaN; one whose line fails ends the run as any other device.
"""

import math
from dataclasses import dataclass
from typing import Any

from smarig.core import Sample
from smarig.device import ForceInput, TemperatureInput, number_from


@dataclass(frozen=True)
class FurtherSensors:
    """Each may be absent."""

    wire: TemperatureInput | None = None
    room: TemperatureInput | None = None
    load_cell: ForceInput | None = None

    @property
    def present(self) -> bool:
        """Whether there is any."""
        return bool(self._all())

    def identities(self) -> list[str]:
        """One line for each."""
        return [sensor.identity for sensor in self._all()]

    def added_to(self, samples: tuple[Sample, ...]) -> tuple[Sample, ...]:
        """The samples with the temperatures measured now."""
        values = {
            name: number_from(sensor, "temperature_degC")
            for name, sensor in (("temperature_degC", self.wire), ("ambient_degC", self.room))
            if sensor is not None
        }
        measured: dict[str, Any] = {name: value for name, value in values.items() if math.isfinite(value)}
        return tuple(sample._replace(**measured) for sample in samples) if measured else samples

    def force_N(self) -> float:
        """The measured force now; NaN without a load cell or a reading."""
        return number_from(self.load_cell, "force_N") if self.load_cell is not None else math.nan

    def close(self) -> None:
        """Close all lines."""
        for sensor in self._all():
            sensor.close()

    def _all(self) -> list[TemperatureInput | ForceInput]:
        return [sensor for sensor in (self.wire, self.room, self.load_cell) if sensor is not None]
