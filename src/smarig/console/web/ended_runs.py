"""Runs and checks whose processes ended without finishing them: shown on the overview until somebody dismisses them.

``smarig.running`` reports each of them once, so they are kept in a file of the folder, which a later console reads.
Only those of the console are taken. The file may have come with the folder: what it says is shown as text, and the
command that continues a run is made here, for a file inside of the folder.
"""

import json
import shlex
import threading
import time
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from smarig.console.web.console_scope import ConsoleScope
from smarig.core import SmarigError, atomic_file, file_bytes, printable
from smarig.running import EndedRun, collect_ended

FILE = "console.ended_runs.json"
_MOST = 100  # the oldest are dropped first


@dataclass(frozen=True)
class UnfinishedRun:
    """A run without an end: what happened in one sentence, and its file; "" for a check of a rig."""

    key: str
    sentence: str
    file: str

    @property
    def command(self) -> str:
        """The command that continues it."""
        return f"smarig resume {shlex.quote(self.file)}"


class EndedRuns:
    """``found()`` collects and returns those that were not dismissed, oldest first."""

    def __init__(self, scope: ConsoleScope) -> None:
        self._scope, self._path = scope, scope.folder / FILE
        self._lock = threading.Lock()
        self._not_stored: list[UnfinishedRun] = []  # because the disk is full

    def found(self) -> list[UnfinishedRun]:
        """All that are to be shown."""
        with self._lock:
            new = [_described(run) for run in collect_ended(self._scope.has)]
            if new or self._not_stored:
                self._store([*self._stored(), *self._not_stored, *new])
            return [*self._stored(), *self._not_stored]

    def dismiss(self, key: str) -> None:
        """Show a run no more."""
        with self._lock:
            self._store([run for run in [*self._stored(), *self._not_stored] if run.key != key])

    def _stored(self) -> list[UnfinishedRun]:
        try:
            content = json.loads(file_bytes(self._path))
            found = [_read(each) for each in content if isinstance(each, dict)]
            return [run for run in found if run is not None and self._may_show(run)]
        except (SmarigError, OSError, ValueError, TypeError, RuntimeError):
            return []  # missing, or written by somebody else

    def _may_show(self, run: UnfinishedRun) -> bool:
        return not run.file or Path(run.file).resolve().is_relative_to(self._scope.folder)

    def _store(self, runs: list[UnfinishedRun]) -> None:
        kept = runs[-_MOST:]
        try:
            with atomic_file(self._path, force=True) as part:
                part.write_text(json.dumps([asdict(run) for run in kept], indent=1), encoding="utf-8")
            self._not_stored = []
        except (SmarigError, OSError):
            stored = self._stored()
            self._not_stored = [run for run in kept if run not in stored]


def _described(ended: EndedRun) -> UnfinishedRun:
    info = ended.info
    key = f"{info['pid']}-{info['start_epoch']:.3f}"
    if ended.is_check:
        began = time.strftime("%Y-%m-%d %H:%M", time.localtime(info["start_epoch"]))
        return UnfinishedRun(key, f"{ended.clause}; it began at {began}.", "")
    protocol, rig, file = (printable(str(info[name])) for name in ("protocol", "rig", "out"))
    when = time.strftime(
        "%Y-%m-%d %H:%M", time.localtime(_last_written(Path(info["out"]), info["start_epoch"]))
    )
    what = f"{protocol[:1].upper()}{protocol[1:].replace('_', ' ')} on {rig}"
    sentence = f"{what} (process {info['pid']}), which wrote {file}, ended at about {when} without finishing."
    return UnfinishedRun(key, sentence, file)


def _last_written(file: Path, otherwise: float) -> float:
    """When the run last wrote, which is at most a few seconds before its process ended."""
    times = [otherwise]
    for path in (file, Path(f"{file}-wal")):
        with suppress(OSError, ValueError):
            times.append(path.stat().st_mtime)
    return max(times)


def _read(content: dict[str, Any]) -> UnfinishedRun | None:
    """One as it was stored; None for anything else."""
    texts: list[Any] = [content.get(name) for name in UnfinishedRun.__dataclass_fields__]
    return UnfinishedRun(*texts) if all(isinstance(text, str) for text in texts) else None
