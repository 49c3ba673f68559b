"""Which face a running experiment shows on stderr: the panel at a terminal, lines elsewhere, JSON, or none."""

from collections.abc import Iterator
from contextlib import contextmanager

from smarig.cli.output import json_requested
from smarig.cli.panel.log_lines import JsonLogLines, LogLines
from smarig.cli.panel.panel_thread import PanelThread
from smarig.cli.panel.run_status import PanelRunInfo, RunStatus
from smarig.cli.panel.terminal import Terminal
from smarig.runner import Listener, RunControl

STREAMS = (
    'With --json, stderr carries one JSON object a line while it runs, {"event": …} and {"step": …} '
    "(other lines do not begin with a brace), and stdout the one object at the end."
)


@contextmanager
def progress(
    run_info: PanelRunInfo, control: RunControl | None = None, *, quiet: bool = False, keys: bool = False
) -> Iterator[Listener]:
    """Within: hand the listener to the runner. ``keys``: whether keys are listened to."""
    status = RunStatus(run_info, control, keys=keys)
    if quiet:
        yield status
        return
    terminal = Terminal()
    display_type = JsonLogLines if json_requested() else PanelThread if terminal.supports_panel else LogLines
    with display_type(status, terminal) as listener:
        yield listener
