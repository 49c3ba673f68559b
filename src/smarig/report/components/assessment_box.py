"""The box that opens a page: what was measured, whether it is good, and what to do, with a level."""

from dataclasses import dataclass

from smarig.identification import ErrorLevel
from smarig.report.components.html import Html, notice, paragraph, tag

_LEVELS = {ErrorLevel.GOOD: "good", ErrorLevel.POOR: "bad"}


@dataclass(frozen=True)
class Assessment:
    """The sentences of a first screen, as text or markup. ``level``: "good", "warning" or "bad"."""

    level: str
    measured: str
    quality: str
    advice: str = ""

    def html(self) -> Html:
        """A box in the colour of the level; the second sentence is the verdict."""
        parts = [paragraph(self.measured), paragraph(tag("b", self.quality))]
        return notice(self.level, *parts, *([paragraph(self.advice)] if self.advice else []))


def box_level(level: ErrorLevel) -> str:
    """The level of a box for that of an error: neither good nor poor is a warning."""
    return _LEVELS.get(level, "warning")
