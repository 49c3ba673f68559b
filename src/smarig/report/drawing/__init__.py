"""Draws the panels of figures as vector graphics (SVG, PDF) with Matplotlib.

Panels are in Plotly's schema, which the interactive view also reads; this package draws the part of it that pages use.
"""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports
from smarig.report.drawing.matplotlib_messages import hide_folder_messages

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

hide_folder_messages()
