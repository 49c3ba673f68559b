"""Saves the figures of a page as SVG and PDF files while the page is made."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from pathlib import Path

from smarig.core import atomic_file
from smarig.report.components.figure import Figure, Panel
from smarig.report.drawing.drawing import save_figure

FORMATS = (".svg", ".pdf")
PAPER_PX = 482  # 170 mm: the width of a journal's page
_LONGEST_NAME = 60


@dataclass
class _Folder:
    """Where the figures go, and those that are there."""

    path: Path
    force: bool
    figures: int = 0
    files: list[Path] = field(default_factory=list)


_ACTIVE: ContextVar[_Folder | None] = ContextVar("folder of figures", default=None)


@contextmanager
def figures_saved_in(folder: Path, force: bool = False) -> Iterator[list[Path]]:
    """Within this block, every figure that becomes part of a page is also saved in a folder; yields the files.

    A panel is saved as SVG and as PDF, at most as wide as the page of a journal. Its name is the number and title of
    the figure on the page, and what the panel shows: "01-measured-loops-and-the-model--measured-model". Raises the
    errors of ``atomic_file``.
    """
    active = _Folder(folder, force)
    token = _ACTIVE.set(active)
    try:
        yield active.files
    finally:
        _ACTIVE.reset(token)


def save_if_active(figure: Figure, width_px: list[int]) -> None:
    """Save the panels of a figure, with one width each, if a folder was named."""
    active = _ACTIVE.get()
    if active is None:
        return
    active.figures += 1
    stem = f"{active.figures:02d}-{_slug(figure.title)}"
    names = _panel_names(figure)
    for k, panel in enumerate(figure.panels):
        for end in FORMATS:
            file = active.path / f"{stem}{names[k]}{end}"
            with atomic_file(file, force=active.force) as part:
                save_figure(panel, part, end, figure.label, min(width_px[k], PAPER_PX))
            active.files.append(file)


def _panel_names(figure: Figure) -> list[str]:
    """What distinguishes each panel of a figure: the title of its ordinate, or of its abscissa, or its number."""
    if len(figure.panels) == 1:
        return [""]
    axes = [[_axis_words(panel, axis) for axis in ("yaxis", "xaxis")] for panel in figure.panels]
    for names in ([y for y, _ in axes], [x and f"against-{x}" for _, x in axes]):
        if all(names) and len(set(names)) == len(names):
            return [f"--{name}" for name in names]
    return [f"--panel-{k}" for k in range(1, len(axes) + 1)]


def _axis_words(panel: Panel, axis: str) -> str:
    """The title of an axis without its unit, as part of a file name; "" if it has none."""
    title = panel.layout.get(axis, {}).get("title") or ""
    text = title.get("text", "") if isinstance(title, dict) else str(title)
    return _slug(re.sub(r"<[^>]*>|\([^)]*\)$", "", text)) if text else ""


def _slug(title: str) -> str:
    """A file name from a title: "hysteresis-of-the-validation-run"."""
    words = re.sub(r"[^a-z0-9]+", "-", title.lower().replace("μ", "mu").replace("ψ", "psi")).strip("-")
    if len(words) > _LONGEST_NAME:  # whole words only
        words = words[:_LONGEST_NAME].rpartition("-")[0]
    return words or "figure"
