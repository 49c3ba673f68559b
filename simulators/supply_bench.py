"""``python -m simulators.supply_bench --rig RIG``: a laboratory supply and the meters of a rig file on the twin's wire.

Prints their VISA addresses as one line of JSON, for each role of the rig file. Runs until standard input ends; its time
is the clock's, times ``--speed`` or ``simulator.speed`` of the rig file.
"""

from typing import Any

import click

from simulators.meter import SimulatedMeter
from simulators.on_the_clock import serve, wire_options
from simulators.supply import SimulatedSupply
from simulators.wire_by_clock import WireByClock
from smarig.config import LinkFile, RigFile
from smarig.core import UsageError
from smarig.rig import TwinSettings

MAKE = "keysight_n6700"
QUANTITIES = {
    "encoder_daq": "position",
    "thermometer": "temperature",
    "room_thermometer": "temperature",
    "load_cell": "force",
}


class SupplyBench:
    """A supply, its wire, and a meter for each further link with the driver ``visa_meter``."""

    def __init__(self, file: RigFile, settings: TwinSettings, make: str = MAKE, speed: float = 1.0) -> None:
        if file.links is None:
            raise UsageError(f"Rig '{file.name}' has no table [links].")
        self.by_clock = WireByClock(file, settings, speed)
        self.wire = self.by_clock.wire
        self.supply = SimulatedSupply(make, speed, self.by_clock.drive, self.by_clock.ohm)
        self.meters = {
            name: self._meter(link, quantity)
            for name, quantity in QUANTITIES.items()
            if (link := getattr(file.links, name)) is not None and link.driver == "visa_meter"
        }
        self.by_clock.pass_time_until(self.supply.over)

    @property
    def urls(self) -> dict[str, str]:
        """The addresses by link of the rig file."""
        return {"amplifier": self.supply.url, **{name: meter.url for name, meter in self.meters.items()}}

    def close(self) -> None:
        """Listen no longer."""
        for server in (self.supply, *self.meters.values()):
            server.close()

    def _meter(self, link: LinkFile, quantity: str) -> SimulatedMeter:
        scale, offset = link.settings.get("scale", 1.0), link.settings.get("offset", 0.0)

        def value() -> float:
            return (self.by_clock.quantity(quantity) - offset) / scale

        return SimulatedMeter(link.settings.get("query", "READ?"), value, f"smarig,meter of {quantity},1,0")


@click.command()
@wire_options
@click.option(
    "--make", default="", help=f"Make of the supply (default: simulator.make of the rig file, else {MAKE})."
)
def main(make: str, **wire: Any) -> None:
    """Simulate a laboratory supply, its meters and the wire of a rig."""

    def start(file: RigFile, settings: TwinSettings, speed: float) -> SupplyBench:
        of_file = file.simulator.make if file.simulator else ""
        return SupplyBench(file, settings, make or of_file or MAKE, speed)

    serve(start, **wire)


if __name__ == "__main__":
    main()
