"""A run that is announced in this process, without a rig."""

from contextlib import AbstractContextManager
from pathlib import Path

from smarig.core import NAN, Sample
from smarig.runner import Listener, RunControl
from smarig.running import PanelRunInfo, RunStatus, announced

INFO = PanelRunInfo(
    "validation", "one_wire_twin", "w", "twin", False, "mm", 0.1, 42, 2800.0, Path("v.run.sqlite")
)


def sample(number: int, **changed) -> Sample:
    """The sample of a number; its readings follow from it."""
    readings = {
        "tick": number,
        "t_s": number / 10,
        "current_command_A": 0.5,
        "current_A": number * 1e-3,
        "voltage_V": number * 2e-3,
        "temperature_degC": NAN,
        "counts": -number,
        "position": number * 3e-3,
        "ambient_degC": 22.0,
        "quality": 4,
    }
    return Sample(**{**readings, **changed})


def made(
    control: RunControl | None = None, status: RunStatus | None = None
) -> AbstractContextManager[Listener]:
    """The announcement of a run."""
    control = control or RunControl()
    return announced(INFO, control, status or RunStatus(INFO, control))


def feed(listener: Listener, first: int, last: int) -> None:
    """Samples ``first`` to ``last``."""
    for number in range(first, last + 1):
        listener.sample(sample(number), 3, 50.0 + number)
