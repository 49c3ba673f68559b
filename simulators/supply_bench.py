"""``python -m simulators.supply_bench --rig RIG``: a laboratory supply and the meters of a rig file on the twin's wire.

Prints their VISA addresses as one line of JSON, for each role of the rig file. Runs until standard input ends; its time
is the clock's, times ``--speed``.
"""

import json
import os
import sys
import threading
import time

import click

from simulators.meter import SimulatedMeter
from simulators.supply import SimulatedSupply
from simulators.supply_dialects import DIALECTS
from simulators.wire_quantities import WireQuantities
from smarig.config import LinkFile, RigFile, load_rig, with_load
from smarig.core import SmarigError, UsageError
from smarig.plant import effects_from_arguments
from smarig.rig import TwinSettings

MAKE = "keysight_n6700"
IDLE_s = 0.02  # at most, between two looks at the clock
QUANTITIES = {
    "encoder_daq": "position",
    "thermometer": "temperature",
    "room_thermometer": "temperature",
    "load_cell": "force",
}


class SupplyBench:
    """A supply, its wire, and a meter for each further link with the driver ``visa_meter``."""

    def __init__(
        self, file: RigFile, settings: TwinSettings, make: str = MAKE, speed: float = 1.0, honest: bool = True
    ) -> None:
        if file.links is None:
            raise UsageError(f"Rig '{file.name}' has no table [links].")
        self.wire, self._speed, self._begin_s = WireQuantities(file, settings), speed, time.monotonic()
        self._current_A, self.largest_A, self._tick = 0.0, 0.0, 0
        self._lock = threading.Lock()
        self.supply = SimulatedSupply(make, speed, honest, self._drive, self._ohm)
        self.meters = {
            name: self._meter(link, quantity)
            for name, quantity in QUANTITIES.items()
            if (link := getattr(file.links, name)) is not None and link.driver == "visa_meter"
        }
        threading.Thread(target=self._pass_time, daemon=True).start()

    @property
    def urls(self) -> dict[str, str]:
        """The addresses by link of the rig file."""
        return {"amplifier": self.supply.url, **{name: meter.url for name, meter in self.meters.items()}}

    def close(self) -> None:
        """Listen no longer."""
        for server in (self.supply, *self.meters.values()):
            server.close()

    def advance(self) -> None:
        """Let the time until now act on the wire."""
        with self._lock:
            due = int((time.monotonic() - self._begin_s) * self._speed / self.wire.file.period_s)
            for _ in range(self._tick, due):
                self.wire.advance(self._current_A)
            self._tick = max(self._tick, due)

    def _drive(self, current_A: float) -> None:
        self.advance()
        self._current_A = current_A
        self.largest_A = max(self.largest_A, abs(current_A))

    def _ohm(self) -> float:
        return self.wire.specimen.plant.resistance_ohm(self._current_A)

    def _meter(self, link: LinkFile, quantity: str) -> SimulatedMeter:
        scale, offset = link.settings.get("scale", 1.0), link.settings.get("offset", 0.0)

        def value() -> float:
            self.advance()
            return (self.wire.quantity(quantity) - offset) / scale

        return SimulatedMeter(link.settings.get("query", "READ?"), value, f"smarig,meter of {quantity},1,0")

    def _pass_time(self) -> None:
        """Time also passes without requests."""
        while not self.supply.over.wait(min(IDLE_s, self.wire.file.period_s / self._speed)):
            self.advance()


@click.command()
@click.option("--rig", required=True, help="Rig file, by name or path.")
@click.option("--seed", type=click.IntRange(0, 2**63 - 1), default=0, show_default=True)
@click.option("--effect", "effects", multiple=True, metavar="NAME=STRENGTH", help="Effect of the twin.")
@click.option("--load", default="", help="Force on the wire, as in smarig run.")
@click.option("--speed", type=click.FloatRange(min=1e-3, max=1e3), default=1.0, help="Real time × SPEED.")
@click.option("--make", type=click.Choice(list(DIALECTS)), default=MAKE, show_default=True)
def main(rig: str, seed: int, effects: tuple[str, ...], load: str, speed: float, make: str) -> None:
    """Simulate a laboratory supply, its meters and the wire of a rig."""
    try:
        file = with_load(load_rig(rig), load) if load else load_rig(rig)
        settings = TwinSettings(seed=seed, effects=effects_from_arguments(effects))
        bench = SupplyBench(file, settings, make, speed)
    except SmarigError as error:
        click.echo(f"Error: {error}", err=True)
        sys.exit(error.exit_status)
    addresses = {name: {"url": url} for name, url in bench.urls.items()}
    click.echo(json.dumps({**addresses, "pid": os.getpid()}))
    sys.stdin.read()
    bench.close()


if __name__ == "__main__":
    main()
