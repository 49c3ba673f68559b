"""Which face a running experiment shows on stderr: the panel at a terminal, lines elsewhere, JSON, or none."""

from collections.abc import Iterator
from contextlib import contextmanager

from smarig.cli._drawing import Drawing
from smarig.cli._events import JsonLines, Lines
from smarig.cli._output import json_wanted
from smarig.cli._situation import About, Situation
from smarig.cli._terminal import Terminal
from smarig.runner.control import Control
from smarig.runner.listener import Listener

STREAMS = (
    'With --json, stderr carries one JSON object a line while it runs, {"event": …} and {"step": …} '
    "(other lines do not begin with a brace), and stdout the one object at the end."
)


@contextmanager
def progress(
    about: About, control: Control | None = None, *, quiet: bool = False, keys: bool = False
) -> Iterator[Listener]:
    """Within: hand the listener to the runner. ``keys``: whether keys are listened to."""
    now = Situation(about, control, keys=keys)
    if quiet:
        yield now
        return
    terminal = Terminal()
    face = JsonLines if json_wanted() else Drawing if terminal.draws else Lines
    with face(now, terminal) as listener:
        yield listener
