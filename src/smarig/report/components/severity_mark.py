"""A severity as a word with a colour. The word alone says it too."""

from smarig.core import Severity
from smarig.report.components.html import Html, tag


def severity_mark(severity: Severity) -> Html:
    """The word; its colour comes from the style sheet."""
    return tag("span", str(severity), class_=f"severity {severity}")
