"""Rich display of runs, models and diagnoses in a notebook.

The drawing code is imported by name and only on use, so that these low-level classes do not depend on it. A lazy import
would break the layers, and patching the classes from above works only after an import.
"""

import html
import importlib
from typing import Any

DISPLAY_MODULE = "smarig.report.notebook"


class NotebookDisplay:
    """Base class that adds ``plot()`` and a notebook's rich display."""

    __slots__ = ()

    def plot(self, *more: Any, **options: Any) -> Any:
        """A figure of this object, as from ``smarig.plot``; ``ax=…`` draws it on axes of Matplotlib."""
        return importlib.import_module(DISPLAY_MODULE).plot(self, *more, **options)

    def _repr_html_(self) -> str:
        """A few kilobytes of HTML: the main facts and a drawing, or a sentence if it cannot be drawn.

        It never raises, because a notebook cell that ends in a run must not fail.
        """
        try:
            return importlib.import_module(DISPLAY_MODULE).display_html(self)
        except Exception as error:
            words = f"This {type(self).__name__} cannot be drawn ({type(error).__name__}: {error})."
            return f"<p>{html.escape(words)}</p>"
