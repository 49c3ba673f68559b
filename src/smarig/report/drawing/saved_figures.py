"""Saves the figures of a page as SVG and PDF files while the page is made."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from pathlib import Path

from smarig.core import atomic_file
from smarig.report.components.figure import Figure
from smarig.report.drawing.drawing import save_figure

FORMATS = (".svg", ".pdf")
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

    A panel is saved as SVG and as PDF. Its name begins with the number of the figure on the page. Raises the errors of
    ``atomic_file``.
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
    for k, panel in enumerate(figure.panels):
        letter = f"-{chr(ord('a') + k % 26)}" if len(figure.panels) > 1 else ""
        for end in FORMATS:
            file = active.path / f"{stem}{letter}{end}"
            with atomic_file(file, force=active.force) as part:
                save_figure(panel, part, end, figure.label, width_px[k])
            active.files.append(file)


def _slug(title: str) -> str:
    """A file name from a title: "hysteresis-of-the-validation-run"."""
    words = re.sub(r"[^a-z0-9]+", "-", title.lower().replace("μ", "mu").replace("ψ", "psi")).strip("-")
    return words[:_LONGEST_NAME].rstrip("-") or "figure"
