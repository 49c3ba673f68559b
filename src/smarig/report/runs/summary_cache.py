"""Keeps the summaries of the runs of a folder beside its index, so that only runs that changed are read again.

A summary counts as long as the size and the time of its run's file (and of its write-ahead log) are the same. A cache
that cannot be read, or that another version of smarig wrote, is made again.
"""

import dataclasses
import json
import math
import os
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any, get_type_hints

import numpy as np

from smarig.core import SmarigError, UsageError, atomic_file, file_bytes
from smarig.report.runs.run_summary import RunSummary

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
