"""A thread that draws the panel a few times per second, so that a slow or stopped terminal does not delay the run.

Rich's own Live refreshes under a lock for which its stop waits: a terminal stopped by Ctrl-S would delay the next run
of a campaign.

At the end one line remains. After a fault the panel remains too, since it shows the last state of the rig.
"""

import contextlib
import threading
from types import TracebackType

from rich.console import Console, ConsoleDimensions, RenderableType
from rich.live import Live

from smarig.cli.panel.panel_layout import panel, summary
from smarig.cli.panel.terminal import CLOSE_TIMEOUT_S, Terminal
from smarig.core import at_forced_end
from smarig.running import RunStatus

REDRAW_S = 0.25


class PanelThread:
    """Draws the panel: ``with PanelThread(status, terminal) as listener``."""

    def __init__(self, status: RunStatus, terminal: Terminal) -> None:
        self._status, self._terminal = status, terminal
        self._finished = threading.Event()
        self._forced = contextlib.ExitStack()
        self._thread = threading.Thread(target=self._draw, name="panel", daemon=True)

    def __enter__(self) -> RunStatus:
        self._thread.start()
        self._forced.enter_context(at_forced_end(self._stop))
        return self._status

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._forced.close()
        self._status.end(error)
        self._stop()

    def _stop(self) -> str:
        """End the drawing, which shows the cursor again."""
        self._finished.set()
        self._thread.join(CLOSE_TIMEOUT_S)
        return ""

    def _draw(self) -> None:
        plain = self._terminal.plain
        console = Console(file=self._terminal, force_terminal=True, soft_wrap=False)  # pyrefly: ignore [bad-argument-type]

        def rendered() -> RenderableType:
            console.size = ConsoleDimensions(*self._terminal.size())  # the terminal may have been resized
            return panel(self._status, console.width, console.height, plain=plain)

        live = Live(
            console=console,
            auto_refresh=False,
            transient=True,
            redirect_stdout=False,
            redirect_stderr=False,
            get_renderable=rendered,
        )
        with contextlib.suppress(OSError):  # the terminal is closed
            with live:
                live.refresh()
                while not self._finished.wait(REDRAW_S):
                    live.refresh()
                ending = self._status.ending
                live.transient = not (ending and ending.kind == "fault")
            console.print(summary(self._status, plain=plain), soft_wrap=True, highlight=False)
        self._terminal.close()
