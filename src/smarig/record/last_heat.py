"""What is last known of the heat of a wire: stored with its history, and read from the record of a run."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self


@dataclass(frozen=True)
class LastHeat:
    """Temperatures of both wires (kelvin above ambient), and a current that may have flowed on for a time.

    ``device`` and ``tick`` say when, by the clock of the device; ``epoch`` by that of the host (seconds since 1970),
    None if that clock is not known to be right.
    """

    wire_K: tuple[float, float]
    current_A: float = 0.0
    flows_s: float = 0.0
    device: str = ""
    tick: int = 0
    epoch: float | None = None

    @classmethod
    def of(cls, table: Mapping[str, Any]) -> Self:
        """Read a stored table. Raises ValueError or TypeError if it is none."""
        first_K, second_K = map(float, table["wire_K"])
        current_A, flows_s = float(table["current_A"]), float(table["flows_s"])
        epoch = None if table["epoch"] is None else float(table["epoch"])
        finite = all(map(math.isfinite, (first_K, second_K, current_A, flows_s, epoch or 0.0)))
        if not finite or min(first_K, second_K, flows_s) < 0:
            raise ValueError("its heat is not that of a wire")
        return cls((first_K, second_K), current_A, flows_s, str(table["device"]), int(table["tick"]), epoch)
