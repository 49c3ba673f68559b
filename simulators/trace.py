"""What the wire felt, tick by tick, as CSV that survives the sudden death of anybody but the disk."""

import time
from pathlib import Path

from simulators.world import SimulatedBench

HEAD = "tick,wall_s,output_uA,state,trip,counts\n"


class TickTrace:
    """Each line is with the system as soon as its tick is over."""

    def __init__(self, path: Path) -> None:
        self._file = path.open("w", encoding="utf-8", buffering=1)
        self._start_s = time.monotonic()
        self._file.write(HEAD)

    def write(self, world: SimulatedBench) -> None:
        """The tick that has just passed: what flowed in it, and what the amplifier made of it."""
        wall_s = time.monotonic() - self._start_s
        state, trip = world.amplifier.state, world.amplifier.trip
        self._file.write(f"{world.ticks},{wall_s:.4f},{world.flowed_uA},{state},{trip},{world.raw_counts}\n")
