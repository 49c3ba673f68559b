"""Small rigs for tests of the boxes: two wires of round numbers, few relays, a short staircase."""

from functools import cache

import numpy as np

from benchmarks.boxes.hold_plan import PlannedHold
from benchmarks.boxes.relays import RelayHysteresis
from benchmarks.boxes.wire import BoxWire

WIRES = {
    "one_wire": BoxWire("one_wire", 0.3, 380.0, 840.0, 4.75, 1.0, 174.0, 15.0),
    "two_wire": BoxWire("two_wire", 0.3, 150.0, 840.0, 2.0, 1.0, 185.0, 3.0),
}
_ONE = (0, 70, 90, 110, 174, 120, 90, 70, 50, 0, 85, 100, 65, 80, 95, 70, 60, 80, 100, 130, 75, 85, 75, 85, 0)
HOLDS = {
    "one_wire": [PlannedHold(float(u), "") for u in _ONE],
    "two_wire": [
        PlannedHold(float(u), "") for u in (-185, 0, 40, 90, 185, 60, -30, -90, 20, 60, -10, -60, 185, 0)
    ],
}


@cache
def few_relays(rig: str, n: int = 1500, seed: int = 1) -> RelayHysteresis:
    """A bump of relays, its output between ± half the stroke."""
    rng = np.random.default_rng(seed)
    middle, width = (0.0, 70.0) if rig == "two_wire" else (80.0, 20.0)
    middles = rng.normal(middle, 8.0, n)
    widths = width * np.exp(0.25 * rng.standard_normal(n))
    return RelayHysteresis(
        middles + widths / 2, middles - widths / 2, rng.integers(500, 1500, n) * 1.0, 12.0, -6.0
    )
