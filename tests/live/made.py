"""Runs and rigs for tests of the live view: one short run of the twin, and an output that only stores
primitives."""

from collections.abc import Sequence
from pathlib import Path

from smarig.config import load_rig
from smarig.live.display_info import DisplayInfo, rig_display_info
from smarig.live.primitives import Primitive
from smarig.plant.actuator import Actuator
from smarig.record import Run, load_run
from smarig.runner.session import Session

LEVELS_A = {"one_wire_twin": [0.5, 0.9, 0.6, 0.8, 0.3, 0.0], "two_wire_twin": [0.8, -0.9, 0.6, -0.5, 0.2]}


def recorded(rig: str, folder: Path) -> Run:
    """A few holds of a twin: up, down, a minor loop."""
    settings = {"currents_A": LEVELS_A[rig], "settle.timeout_s": 120.0}
    with Session(rig, seed=1, wire=f"live-{folder.name}") as session:
        return load_run(session.run("step_currents", settings, folder / f"{rig}.run.sqlite"))


def planned_run_info(rig: str = "one_wire_twin") -> DisplayInfo:
    """A rig before its run."""
    file = load_rig(rig)
    return rig_display_info(file, Actuator.named(file.actuator), "twin", {}, "a test")


class RecordingOutput:
    """A screen without a viewer."""

    def __init__(self) -> None:
        self.primitives: list[Primitive] = []

    def show(self, primitives: Sequence[Primitive]) -> None:
        """Keep them."""
        self.primitives += primitives

    def at(self, path: str) -> list:
        """All marks at a path."""
        return [primitive for primitive in self.primitives if primitive.path == path]
