"""Draws the panels of figures as vector graphics (SVG, PDF) with Matplotlib.

Panels are in Plotly's schema, which the interactive view also reads; this package draws the part of it that pages use.
"""

import logging
from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.report.drawing.drawing import NARROW_PX as NARROW_PX
    from smarig.report.drawing.drawing import WIDE_PX as WIDE_PX
    from smarig.report.drawing.drawing import WIDTH_PX as WIDTH_PX
    from smarig.report.drawing.drawing import draw_on as draw_on
    from smarig.report.drawing.drawing import save_figure as save_figure
    from smarig.report.drawing.drawing import svg_of as svg_of
    from smarig.report.drawing.saved_figures import figures_saved_in as figures_saved_in
    from smarig.report.drawing.saved_figures import save_if_active as save_if_active
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)

_FOLDER_WORDS = ("mkdir -p failed", "is not a writable directory", "temporary cache directory")


def _is_of_other_matter(record: logging.LogRecord) -> bool:
    return not any(words in record.getMessage() for words in _FOLDER_WORDS)


# Where the home folder cannot be written, Matplotlib uses a temporary one, and logs that when it is imported.
logging.getLogger("matplotlib").addFilter(_is_of_other_matter)
