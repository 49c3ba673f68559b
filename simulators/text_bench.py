"""``python -m simulators.text_bench --rig RIG``: a box that drives and measures, on the wire of a rig file.

Prints its address as one line of JSON, for both roles of the rig file. Runs until standard input ends; its time is the
clock's, times ``--speed`` or ``simulator.speed`` of the rig file.
"""

from typing import Any

import click

from simulators.on_the_clock import serve, wire_options
from simulators.text_instrument import SimulatedBox
from simulators.wire_by_clock import WireByClock
from smarig.config import RigFile
from smarig.rig import TwinSettings


class TextBench:
    """The box and its wire."""

    def __init__(self, file: RigFile, settings: TwinSettings, speed: float = 1.0) -> None:
        self.wire = WireByClock(file, settings, speed)
        self.box = SimulatedBox(speed, self.wire.drive, self.wire.ohm, lambda: self.wire.quantity("position"))
        self.wire.pass_time_until(self.box.over)

    @property
    def urls(self) -> dict[str, str]:
        """The address by link of the rig file."""
        return dict.fromkeys(("amplifier", "encoder_daq"), self.box.url)

    def close(self) -> None:
        """Listen no longer."""
        self.box.close()


@click.command()
@wire_options
def main(**wire: Any) -> None:
    """Simulate a text instrument and the wire of a rig."""
    serve(TextBench, **wire)


if __name__ == "__main__":
    main()
