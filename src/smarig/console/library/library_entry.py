"""An entry of the library: one file, with what it says of itself and what people wrote about it."""

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from smarig.core import printable

RUN, MODEL, DIAGNOSIS = "run", "model", "diagnosis"
GOOD, WARNING, BAD = "good", "warning", "bad"
RECORDING, UNREADABLE = "recording", "unreadable"
VERDICTS = (UNREADABLE, BAD, WARNING, RECORDING, GOOD, "")  # the most serious first
_LONGEST_NAME = 300


@dataclass(frozen=True)
class Note:
    """What somebody wrote about a run, and when (seconds since 1970)."""

    text: str
    who: str
    epoch: float


@dataclass(frozen=True)
class LibraryFigure:
    """A quantity with its unit, and its 95 % interval if it is known."""

    value: float
    ci95: tuple[float, float] | None
    unit: str


@dataclass(frozen=True)
class Entry:
    """A file of the library.

    ``id`` identifies the entry as long as its content exists somewhere in the folder: it stays the same when a run is
    renamed or moved. ``identity`` is that of the content, which copies share, with their tags and notes. ``kind`` is
    "run", "model", "diagnosis", or the kind of a page ("characterisation", "study", "comparison of runs", …).
    ``place`` is the name in the folder as it can be shown; ``path`` opens the file. ``began`` is in seconds since 1970:
    of a run its first sample, of all others when they were made. ``verdict`` is "good", "warning", "bad", "recording",
    "unreadable", or "" without one; ``sentence`` is the reason. ``error`` says why a file could not be read.

    ``details`` of a run: settings, seed, notes, cause, complete, samples, steps, settled, flagged, travel, unit,
    input_unit, axes, effects, severity, ended; of other kinds, some of these. ``figures``: stroke, A_s, A_f, M_s, M_f,
    width, cycles of a run; error_times_noise of a model or a diagnosis.
    """

    id: str
    identity: str
    kind: str
    name: str
    place: str
    path: Path
    began: float | None
    duration_s: float | None
    wire: str
    rig: str
    protocol: str
    label: str
    verdict: str
    sentence: str
    error: str
    size_bytes: int
    modified: float
    details: Mapping[str, Any]
    figures: Mapping[str, LibraryFigure]
    tags: tuple[str, ...]
    notes: tuple[Note, ...]


Numbers = tuple[float, ...]
FigureRow = tuple[float, float | None, float | None, str]  # value, ends of the interval, unit


@dataclass(frozen=True)
class Content:
    """What was read from a file; ``u`` and ``y`` are the points of a small drawing."""

    identity: str
    kind: str
    name: str
    began: float | None = None
    duration_s: float | None = None
    wire: str = ""
    rig: str = ""
    protocol: str = ""
    label: str = ""
    verdict: str = ""
    sentence: str = ""
    error: str = ""
    details: dict[str, Any] = field(default_factory=dict)
    figures: dict[str, FigureRow] = field(default_factory=dict)
    u: Numbers = ()
    y: Numbers = ()


def shown_place(place: bytes) -> str:
    r"""A name on disk as one line of text, whatever bytes it has.

    >>> shown_place(b"a\nb\xff.html")
    'a\\nb\\xff.html'
    """
    return one_line(place.decode("utf-8", "backslashreplace"), _LONGEST_NAME)


def one_line(text: str, longest: int) -> str:
    """A text of unknown origin as one printable line."""
    return printable(text.replace("\n", "\\n").replace("\t", "\\t").replace("\r", "\\r"), longest)


def path_of(folder: Path, place: bytes) -> Path:
    """The path of a place in the folder."""
    return folder / os.fsdecode(place)
