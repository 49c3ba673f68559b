"""Choice of the progress display on stderr: panel or log lines at a terminal, one line elsewhere, JSON lines, or
nothing."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import TYPE_CHECKING

from smarig.cli.output import json_requested, show_message

if TYPE_CHECKING:
    from smarig.cli.panel.terminal import Terminal
    from smarig.runner import Listener, RunControl
    from smarig.running import PanelRunInfo, RunStatus

STREAMS = (
    'With --json, stderr carries one JSON object per line during the run, {"event": …} or {"step": …}. Other lines '
    "do not begin with a brace. One object is printed to stdout at the end."
)


@contextmanager
def progress(
    run_info: "PanelRunInfo", control: "RunControl", *, quiet: bool = False, keys: bool = False
) -> "Iterator[Listener]":
    """Yield the listener for the runner: the display, and the announcement of the run to other processes.

    ``keys``: whether the terminal accepts keys.
    """
    from smarig.cli.live_options import with_watchers
    from smarig.running import RunStatus, announced

    status = RunStatus(run_info, control, keys=keys)
    with (
        announced(run_info, control, status) as announcement,
        with_watchers(_display(status, quiet=quiet), [announcement]) as listener,
    ):
        yield listener


def _display(status: "RunStatus", *, quiet: bool) -> "AbstractContextManager[Listener]":
    from smarig.cli.panel.terminal import Terminal

    if quiet:
        return nullcontext(status)
    terminal = Terminal()
    return _display_type(terminal)(status, terminal)


def _display_type(
    terminal: "Terminal",
) -> "Callable[[RunStatus, Terminal], AbstractContextManager[Listener]]":
    from smarig.cli.panel.log_lines import JsonLogLines, LogLines, SummaryLine
    from smarig.cli.panel.panel_thread import PanelThread

    if json_requested():
        return JsonLogLines
    if terminal.supports_panel:
        return PanelThread
    return LogLines if terminal.isatty() else SummaryLine


def preview_progress(*, quiet: bool = False) -> Callable[[float], None] | None:
    """What tells the user how far the preview of a long run has come; None for nothing."""
    return None if quiet else _show_previewed


def _show_previewed(reached_s: float) -> None:
    show_message(f"Preview on the twin: {reached_s / 3600:.1f} h of the run so far.")
