"""A figure with what it means beside it, so that both are seen at once on a wide screen."""

from typing import Any

from smarig.report.components.figure import Figure
from smarig.report.components.html import Html, tag


def figure_with_text(figure: Figure, *parts: Any) -> Html:
    """The figure at the left and the other parts at the right; below each other on narrow screens and on paper."""
    return tag("div", figure.html(), tag("div", *parts), class_="with-text")
