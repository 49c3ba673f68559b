"""What a page says first, in three sentences with a level, and of itself to an index: kind, main sentence, small loop.

The summary is stored in the head of the page as plain text and numbers, never as markup, so that an index can read it
from any file.
"""

import html
import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from smarig.core import Array, UsageError, opened_file
from smarig.identification import ErrorLevel
from smarig.report.components.html import Html, joined, notice, paragraph, plain, tag

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


LEVELS = ("good", "warning", "bad")
_HEAD_BYTES = 60_000
_META = re.compile(r'<meta name="(smarig-[a-z]+|description|generator)" content="([^"]*)">')
_TITLE = re.compile(r"<title>([^<]*)</title>")
_LEAST_POINTS = 2


@dataclass(frozen=True, eq=False)
class PageSummary:
    """``kind`` of page, its main ``sentence``, its ``level`` ("good", "warning", "bad" or "" for none), and a loop.

    ``u`` and ``y`` (k,) are the points of the loop, ``units`` those of input and output; ``label`` marks simulated
    data ("TWIN").
    """

    kind: str
    sentence: str = ""
    level: str = ""
    u: Array = field(default_factory=lambda: np.empty(0))
    y: Array = field(default_factory=lambda: np.empty(0))
    units: tuple[str, str] = ("", "")
    label: str = ""

    def head(self) -> Html:
        """The elements for the head of the page."""
        loop = " ".join(f"{a:.5g},{b:.5g}" for a, b in zip(self.u, self.y))
        items = {
            "smarig-kind": self.kind,
            "description": plain(self.sentence),
            "smarig-level": self.level,
            "smarig-loop": loop,
            "smarig-units": " | ".join(self.units),
            "smarig-label": self.label,
        }
        return joined(tag("meta", name_=name, content=value) for name, value in items.items() if value)


@dataclass(frozen=True, eq=False)
class FoundPage:
    """A page that smarig wrote: its file, title and summary."""

    path: Path
    title: str
    summary: PageSummary


def found_page(path: Path) -> FoundPage | None:
    """The page in a file with its summary; None for any other file and for pages without a kind."""
    try:
        with opened_file(path) as file:
            text = file.read(_HEAD_BYTES).decode("utf-8", errors="replace")
    except (UsageError, OSError):
        return None
    head = text.partition("<style")[0]
    items = {name: html.unescape(value) for name, value in _META.findall(head)}
    title = _TITLE.search(head)
    if items.get("generator") != "smarig" or "smarig-kind" not in items or title is None:
        return None
    u, y = _loop(items.get("smarig-loop", ""))
    units = (items.get("smarig-units", "").split(" | ") + ["", ""])[:2]
    level = items.get("smarig-level", "")
    label = items.get("smarig-label", "")
    name = html.unescape(title[1]).removeprefix(f"{label} · ")
    return FoundPage(
        path,
        name,
        PageSummary(
            kind=items["smarig-kind"],
            sentence=items.get("description", ""),
            level=level if level in LEVELS else "",
            u=u,
            y=y,
            units=(units[0], units[1]),
            label=label,
        ),
    )


def _loop(text: str) -> tuple[Array, Array]:
    """Points of a loop; none if the text is not pairs of numbers."""
    try:
        points = np.array([[float(value) for value in pair.split(",")] for pair in text.split()], dtype=float)
    except ValueError:
        points = np.empty((0, 2))
    if (
        points.ndim != 2
        or points.shape[1:] != (2,)
        or len(points) < _LEAST_POINTS
        or not np.isfinite(points).all()
    ):
        points = np.empty((0, 2))
    return points[:, 0], points[:, 1]
