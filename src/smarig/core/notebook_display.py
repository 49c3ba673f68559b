"""What shows itself in a notebook: a run, a model, a diagnosis.

They stand far below the pictures, so the pictures are looked up by name, and only when a notebook asks.
Knows no picture and none of those who are shown.
"""

import html
import importlib
from typing import Any

DISPLAY_MODULE = "smarig.report.notebook"


class NotebookDisplay:
    """Gives ``plot()`` and a notebook's rich display to what inherits it."""

    __slots__ = ()

    def plot(self, *more: Any) -> Any:
        """A plotly figure of it, as of ``smarig.plot``."""
        return importlib.import_module(DISPLAY_MODULE).plot(self, *more)

    def _repr_html_(self) -> str:
        """A few kilobytes of HTML: the words that matter, and a drawing; a sentence where it cannot be drawn.

        A cell that only ends in a run must not fail.
        """
        try:
            return importlib.import_module(DISPLAY_MODULE).display_html(self)
        except Exception as error:
            words = f"This {type(self).__name__} cannot be drawn ({type(error).__name__}: {error})."
            return f"<p>{html.escape(words)}</p>"
