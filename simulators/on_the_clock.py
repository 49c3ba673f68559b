"""Simulated instruments whose time is the clock's: the options of their commands, and serving until the host ends."""

import json
import os
import sys
from collections.abc import Callable
from typing import Any, Protocol

import click

from simulators.starting import starting
from smarig.config import RigFile, load_rig, with_load
from smarig.plant import effects_from_arguments
from smarig.rig import TwinSettings

_OPTIONS = (
    click.option("--rig", required=True, help="Rig file, by name or path."),
    click.option("--seed", type=click.IntRange(0, 2**63 - 1), default=0, show_default=True),
    click.option("--effect", "effects", multiple=True, metavar="NAME=STRENGTH", help="Effect of the twin."),
    click.option("--load", default="", help="Force on the wire, as in smarig run."),
    click.option(
        "--speed",
        type=click.FloatRange(min=1e-3, max=1e3),
        help="Real time × SPEED (default: simulator.speed of the rig file, else 1).",
    ),
)
Start = Callable[[RigFile, TwinSettings, float], "Instruments"]


class Instruments(Protocol):
    """Instruments that listen."""

    @property
    def urls(self) -> dict[str, str]:
        """Their addresses by link of the rig file."""
        ...

    def close(self) -> None:
        """Listen no longer."""
        ...


def wire_options(command: Callable[..., None]) -> Callable[..., None]:
    """Add the options of the wire, and of the time."""
    for option in reversed(_OPTIONS):
        command = option(command)
    return command


def serve(
    start: Start, *, rig: str, seed: int, effects: tuple[str, ...], load: str, speed: float | None
) -> None:
    """Print the addresses and the speed as one line of JSON; serve until standard input ends."""
    with starting():
        file = with_load(load_rig(rig), load) if load else load_rig(rig)
        speed = speed or (file.simulator.speed if file.simulator else 0.0) or 1.0
        instruments = start(file, TwinSettings(seed=seed, effects=effects_from_arguments(effects)), speed)
    addresses: dict[str, Any] = {name: {"url": url} for name, url in instruments.urls.items()}
    click.echo(json.dumps({**addresses, "pid": os.getpid(), "speed": speed}))
    sys.stdin.read()
    instruments.close()
