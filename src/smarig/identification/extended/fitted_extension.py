"""The input and the result of the identification of an extension."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from smarig.core import DataError
from smarig.identification.interval_estimate import Estimate
from smarig.identification.noise_floor import noise_floor
from smarig.preisach import Everett
from smarig.record import Run


@dataclass(frozen=True, eq=False)
class ExtensionData:
    """Runs, and the classical hysteresis identified from them."""

    runs: Sequence[Run]
    hysteresis: Everett
    unit: str

    @property
    def noise(self) -> float:
        """Standard deviation of one settled output; DataError if the runs do not determine it."""
        value = noise_floor(self.runs).value
        if not value:
            raise DataError("The noise of a settled point is unknown. Repeat some memory states first.")
        return value


@dataclass(frozen=True, eq=False)
class FittedExtension:
    """An identified extension.

    ``parameters`` have 95 % intervals. ``p_value`` is that of the classical model. ``values`` are stored in the
    model file and read by ``replay.extended_model``.
    """

    adds: str
    parameters: dict[str, Estimate]
    p_value: float
    values: dict[str, Any]

    def to_json(self) -> dict[str, Any]:
        """Plain values, without those of the model file."""
        return {
            "adds": self.adds,
            "p_value": self.p_value,
            "parameters": {name: estimate.to_json() for name, estimate in self.parameters.items()},
        }
