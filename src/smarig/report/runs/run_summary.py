"""A summary of a run with a small drawing, for lists of runs and notebooks; those of a folder, kept beside its index.

Of the samples, only a thinned loop is kept in memory. A kept summary counts as long as the size and the time of its
run's file (and of its write-ahead log) are the same. A cache that cannot be read, or that another version of smarig
wrote, is made again.
"""

import dataclasses
import json
import math
import os
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any, get_type_hints

import numpy as np

from smarig.core import Array, SmarigError, UsageError, atomic_file, file_bytes, spaced
from smarig.record import AnyRun
from smarig.report.components.decimate import simplified
from smarig.report.components.html import Html
from smarig.report.components.numbers import duration, number, thousands
from smarig.report.components.page_summary import PageSummary
from smarig.report.components.run_description import (
    FLAG_NAMES,
    count_size,
    display_unit,
    duration_s,
    input_title,
    output_title,
    protocol_name,
    quality_counts,
    source_label,
    started,
)
from smarig.report.components.thumbnail import Frame, frame_of, thumbnail
from smarig.report.runs.sample_path import sample_path

_POINTS = 400  # per loop, a few kilobytes
_TOLERANCE = 0.004  # of the ranges: less than a pixel


@dataclass(frozen=True, eq=False)
class RunSummary:
    """A run in a list: identity, size, ending, settings, and its thinned loop u, y (k,)."""

    file: str
    protocol: str
    rig: str
    wire: str
    source: str
    label: str
    began: str
    seed: str
    duration_s: float
    samples: int
    steps: int
    settled: int
    flagged: int
    travel: float
    unit: str
    input_unit: str
    axes: tuple[str, str]
    complete: bool
    cause: str
    notes: str
    settings: str
    u: Array
    y: Array

    @property
    def scale_group(self) -> tuple[str, str, str, str]:
        """The key of runs that share one scale: rig, wire and units."""
        return self.rig, self.wire, self.input_unit, self.unit

    @property
    def words(self) -> str:
        """The text alternative of the drawing."""
        if not self.u.size:
            return f"{self.protocol}: no data to draw."
        n = f"n = {self.steps} steps" if self.steps else f"n = {thousands(self.samples)} samples"
        low, high = number(float(self.u.min())), number(float(self.u.max()))
        return (
            f"Hysteresis of {self.protocol}: {self.axes[1]} over {number(self.travel)}{spaced(self.unit)} against "
            f"{self.axes[0]} from {low} to {high}{spaced(self.input_unit)}, {n}."
        )

    def drawing(self, frame: Frame | None = None) -> Html:
        """The loop as inline SVG, in its own frame or a shared one."""
        return thumbnail(self.u, self.y, self.words, (self.input_unit, self.unit), self.label, frame)

    @property
    def size(self) -> str:
        """Duration and travel in readable units."""
        took = (
            duration(self.duration_s)
            if np.isfinite(self.duration_s)
            else f"{thousands(self.samples)} samples"
        )
        return f"{took}, travel {number(self.travel)}{spaced(self.unit)}"


def summary_of(run: AnyRun) -> RunSummary:
    """The summary of a run."""
    u, y = loop(run, _POINTS)
    m, extremes = quality_counts(run), run.extremes("position")
    seed = run.info.seed
    return RunSummary(
        file=run.path.name,
        protocol=protocol_name(run),
        rig=run.info.rig or "",
        wire=run.info.wire or "",
        source=run.info.source or "",
        label=source_label(run),
        began=started(run),
        seed="" if seed is None else str(seed),
        duration_s=duration_s(run),
        samples=m.samples,
        steps=m.steps,
        settled=m.settled,
        flagged=sum(getattr(m, name) for name in FLAG_NAMES),
        travel=extremes[1] - extremes[0] if extremes else float("nan"),
        unit=display_unit(run.unit),
        input_unit=display_unit(run.input_unit),
        axes=(input_title(run), output_title(run)),
        complete=run.complete,
        cause=run.cause,
        notes=run.info.notes or "",
        settings=", ".join(f"{k}={v}" for k, v in run.info.settings.items()),
        u=u,
        y=y,
    )


def summary_with_loop(kind: str, sentence: str, level: str, run: AnyRun | None) -> PageSummary:
    """The summary of a page, with the loop of one of its runs."""
    if run is None:
        return PageSummary(kind, sentence, level)
    u, y = loop(run, _POINTS)
    units = display_unit(run.input_unit), display_unit(run.unit)
    return PageSummary(kind, sentence, level, u, y, units, source_label(run))


def loop(run: AnyRun, points: int) -> tuple[Array, Array]:
    """Input and output (k,) along the path of the samples, or of the settled points if there are few samples.

    Thinned to a path that a small drawing cannot tell from the whole one.
    """
    u, y = run["input"], run["position"]
    kept = sample_path(u, y, count_size(run))
    if kept.size < len(run.settled):
        u, y = run.points()
        kept = np.arange(u.size)
    kept = kept[simplified(u[kept], y[kept], _TOLERANCE, points)]
    return u[kept], y[kept]


def shared_frames(runs: list[RunSummary]) -> list[Frame | None]:
    """A frame for each run: runs of one ``scale_group`` share the input axis and the length of the output axis.

    Outputs of different sessions have different zeros, so each frame begins at the minimum output of its run.
    """
    spans: dict[tuple[str, str, str, str], list[Frame]] = {}
    for run in runs:
        if run.u.size:
            spans.setdefault(run.scale_group, []).append(frame_of(run.u, run.y))
    return [_shared_frame(run, spans[run.scale_group]) if run.u.size else None for run in runs]


def _shared_frame(run: RunSummary, frames: list[Frame]) -> Frame:
    tallest = max(frame.y[1] - frame.y[0] for frame in frames)
    least = float(run.y.min())
    return Frame((min(f.u[0] for f in frames), max(f.u[1] for f in frames)), (least, least + tallest))


CACHE_FILE = "smarig-index.json"
LAYOUT = 2  # one more whenever the same run has another summary
_ARRAYS = ("u", "y")
_TYPES = {name: kind for name, kind in get_type_hints(RunSummary).items() if name not in (*_ARRAYS, "axes")}


class SummaryCache:
    """The summaries of a folder: ``of`` a run's file if it is known, ``keep``, and ``write`` what was asked for."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._known = _stored_entries(folder / CACHE_FILE)
        self._used: dict[str, Any] = {}

    def of(self, file: Path) -> RunSummary | None:
        """The summary of a run file; None if the file has changed or is new."""
        place = self._place(file)
        entry = self._known.get(place)
        if not isinstance(entry, dict) or entry.get("state") != file_state(file):
            return None
        summary = _summary(entry.get("summary"))
        if summary is not None:
            self._used[place] = entry
        return summary

    def keep(self, file: Path, state: list[int], summary: RunSummary) -> None:
        """Keep a summary of the file as it was in ``state``."""
        self._used[self._place(file)] = {"state": state, "summary": _plain(summary)}

    def write(self) -> None:
        """Write the summaries of the runs that are there; a folder that refuses costs only time."""
        if self._used == self._known:
            return
        content = {**_identity(), "runs": self._used}
        try:
            with atomic_file(self._folder / CACHE_FILE, force=True) as part:
                part.write_text(json.dumps(content), encoding="utf-8")
        except SmarigError:
            return

    def _place(self, file: Path) -> str:
        return Path(os.path.relpath(file, self._folder)).as_posix()


def file_state(file: Path) -> list[int]:
    """Size and time of a run file and of its write-ahead log."""
    found = []
    for path in (file, file.with_name(file.name + "-wal")):
        try:
            about = path.stat()
        except OSError:
            continue
        found += [about.st_size, about.st_mtime_ns]
    return found


def _identity() -> dict[str, Any]:
    return {
        "smarig": version("smarig"),
        "layout": LAYOUT,
        "fields": [field.name for field in dataclasses.fields(RunSummary)],
    }


def _stored_entries(file: Path) -> Mapping[str, Any]:
    """What the cache holds, by place of the run; empty if it is missing, damaged, or of another version."""
    try:
        content = json.loads(file_bytes(file))
    except (UsageError, OSError, ValueError, RecursionError):
        return {}
    if not isinstance(content, dict) or not isinstance(content.get("runs"), dict):
        return {}
    identity = _identity()
    return content["runs"] if {key: content.get(key) for key in identity} == identity else {}


def _plain(summary: RunSummary) -> dict[str, Any]:
    values = {field.name: getattr(summary, field.name) for field in dataclasses.fields(RunSummary)}
    return values | {"axes": list(summary.axes)} | {name: values[name].tolist() for name in _ARRAYS}


def _summary(stored: Any) -> RunSummary | None:
    """The summary of stored values; None if one is missing or of another type."""
    if not isinstance(stored, dict) or any(not isinstance(stored.get(n), kind) for n, kind in _TYPES.items()):
        return None
    axes, arrays = stored.get("axes"), [stored.get(name) for name in _ARRAYS]
    if not (isinstance(axes, list) and len(axes) == 2 and all(isinstance(words, str) for words in axes)):
        return None
    if not all(isinstance(values, list) and all(map(_is_finite, values)) for values in arrays):
        return None
    u, y = (np.array(values, dtype=float) for values in arrays)
    if u.size != y.size:
        return None
    return RunSummary(**(stored | {"axes": (axes[0], axes[1]), "u": u, "y": y}))


def _is_finite(value: Any) -> bool:
    return isinstance(value, float) and math.isfinite(value)
