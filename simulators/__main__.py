"""``python -m simulators --rig one_wire_twin``: both devices of a rig on ports of this machine.

Prints their addresses as one line of JSON. Serves until standard input ends, then lets the lease expire.
"""

import json
import os
import signal
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import click

from simulators.faults import SimulatedFault, Unplugged, load_faults
from simulators.firmware import FirmwareAmplifier, FirmwareDaq, open_library
from simulators.framed_device import AmplifierStation, DaqStation, PythonAmplifier, PythonDaq
from simulators.framing import ServerFraming
from simulators.line import DeviceLine
from simulators.line_troubles import LineFaults
from simulators.lines import TextFraming
from simulators.modbus import Rtu, Tcp
from simulators.pace import HOST_TIMEOUT_s, LockStep, Pace, RealTime
from simulators.server import Server, TickTrace
from simulators.simulated_bench import AMPLIFIER, DAQ, SimulatedBench
from simulators.starting import starting
from simulators.transports import Port, Pty, TcpPort
from smarig.config import RigFile, load_rig, with_load
from smarig.core import UsageError
from smarig.device import load_register_map
from smarig.plant import Actuator, effects_from_arguments
from smarig.rig import Specimen, TwinSettings

AFTER_LEASE = 5  # ticks in which the trip can be observed after the host has ended
FRAMINGS = ("lines", "modbus_tcp", "modbus_rtu")
FILE = click.Path(path_type=Path, dir_okay=False)
FOLDER = click.Path(path_type=Path, file_okay=False)


@click.command()
@click.option("--rig", required=True, help="Rig file, by name or path.")
@click.option(
    "--framing",
    type=click.Choice(FRAMINGS),
    help="Framing of both devices (default: that of the rig file, or lines).",
)
@click.option("--seed", type=click.IntRange(0, 2**63 - 1), default=0, show_default=True)
@click.option(
    "--effect",
    "effects",
    multiple=True,
    metavar="NAME=STRENGTH",
    help="Effect of the twin, as in smarig run; repeatable.",
)
@click.option("--load", default="", help="Force on the wire, as in smarig run.")
@click.option("--lock-step", is_flag=True, help="Advance the time only when the host requests samples.")
@click.option(
    "--gone-after",
    "host_timeout_s",
    type=click.FloatRange(min=0.1),
    default=HOST_TIMEOUT_s,
    show_default=True,
    help="Lock-step: seconds without a request after which time follows the clock.",
)
@click.option(
    "--speed",
    type=click.FloatRange(min=1e-3, max=1e6),
    help="Real time × SPEED (default: simulator.speed of the rig file, else 1).",
)
@click.option("--faults", "faults_file", type=FILE, help="TOML file of faults, see faults.py.")
@click.option("--folder", type=FOLDER, help="Folder with permanent names for the ptys.")
@click.option("--trace", "trace_file", type=FILE, help="CSV file to write, one row per tick.")
@click.option(
    "--device-library", type=FILE, help="Use this build of the C firmware instead of the Python devices."
)
def main(
    rig: str,
    framing: str | None,
    seed: int,
    effects: tuple[str, ...],
    load: str,
    lock_step: bool,
    host_timeout_s: float,
    speed: float | None,
    faults_file: Path | None,
    folder: Path | None,
    trace_file: Path | None,
    device_library: Path | None,
) -> None:
    """Simulate an amplifier and an encoder DAQ behind real bytes."""
    with starting():
        if lock_step and speed is not None:
            raise UsageError(
                "Give either --lock-step or --speed: time either waits for the host or follows the clock."
            )
        file = with_load(load_rig(rig), load) if load else load_rig(rig)
        speed = speed or (file.simulator.speed if file.simulator else 0.0) or 1.0
        faults = load_faults(faults_file) if faults_file else ()
        framings = {name: _framing(file, name, framing) for name in (AMPLIFIER, DAQ)}
        settings = TwinSettings(seed=seed, effects=effects_from_arguments(effects))
        world = _world(file, settings, faults, *_devices(framings, device_library))
        trace = TickTrace(trace_file) if trace_file else None
        lines = [_line(world, name, faults, folder) for name in framings]

    def tick() -> None:
        world.tick()
        if trace:
            trace.write(world)

    pace: Pace = (
        LockStep(world, tick, host_timeout_s)
        if lock_step
        else RealTime(tick, file.period_s / speed, time.monotonic())
    )
    _serve(world, lines, pace, (file.lease_s + AFTER_LEASE * file.period_s) / speed)


def _framing(file: RigFile, device: str, chosen: str | None) -> ServerFraming:
    link = getattr(file.links, device) if file.links else None
    name = chosen or (link.framing if link else FRAMINGS[0])
    address = (link.address if link else 0) or load_register_map(device).device.default_address
    return {"lines": TextFraming(), "modbus_tcp": Tcp(address), "modbus_rtu": Rtu(address)}[name]


def _devices(framings: dict[str, ServerFraming], library: Path | None) -> tuple[AmplifierStation, DaqStation]:
    if library is None:
        return PythonAmplifier(framings[AMPLIFIER]), PythonDaq(framings[DAQ])
    opened = open_library(library)
    return FirmwareAmplifier(opened, framings[AMPLIFIER]), FirmwareDaq(opened, framings[DAQ])


def _world(
    file: RigFile,
    settings: TwinSettings,
    faults: Sequence[SimulatedFault],
    amplifier: AmplifierStation,
    daq: DaqStation,
) -> SimulatedBench:
    specimen = Specimen(file, Actuator.named(file.actuator), settings)
    return SimulatedBench(specimen, amplifier, daq, file.period_s, file.encoder.counts_per_rev, faults)


def _line(
    world: SimulatedBench, name: str, faults: Sequence[SimulatedFault], folder: Path | None
) -> DeviceLine:
    mine = [f for f in faults if f.device == name]
    framing = world.station(name).framing
    port: Port
    if framing.name == "modbus_tcp":
        port = TcpPort()
    elif folder is None and any(isinstance(f, Unplugged) for f in mine):
        raise UsageError("An unplugged pty returns under another name. Give --folder for a permanent name.")
    elif folder is None:
        port = Pty()
    else:
        folder.mkdir(parents=True, exist_ok=True)
        port = Pty(folder.resolve() / name)
    return DeviceLine(name, port, framing, world, LineFaults(mine))


def _serve(world: SimulatedBench, lines: list[DeviceLine], pace: Pace, afterwards_s: float) -> None:
    server = Server(world, lines, pace, sys.stdin.fileno(), afterwards_s)
    signal.signal(signal.SIGTERM, lambda *_: server.stop())
    where = {line.name: {"url": line.port.url} for line in lines}
    click.echo(json.dumps({**where, "pid": os.getpid()}))
    try:
        server.run()
    finally:
        for line in lines:
            line.port.unplug()


if __name__ == "__main__":
    main()
