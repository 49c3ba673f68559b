"""Which runs and checks a console is responsible for: those of its folder, and those on a wire that it has opened.

Everybody who works under one account of a computer sees the runs of all the others. A console lists, stops and tells of
the end of its own; the others have a page apart, which only shows them.
"""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from smarig.config import RigFile
from smarig.running import RunInProgress


class ConsoleScope:
    """The scope of a console. A rig is opened by the command that starts the console, or by a check from its pages."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.opened: set[str] = set()  # rigs of which a person has opened what lies outside of the folder
        self._wires: set[str] = set()

    def open_rig(self, file: RigFile | None) -> None:
        """From now on, whatever drives the wire of this bench belongs to the console. Twins have a wire each."""
        if file is not None and file.kind == "bench":
            self._wires.add(file.wire)

    def has(self, info: Mapping[str, Any]) -> bool:
        """Whether a run or a check with this description belongs to the console."""
        on_own_wire = drives_bench(info) and info.get("wire") in self._wires
        return on_own_wire or self._is_inside(folder_of(info))

    def own(self, runs: Iterable[RunInProgress]) -> list[RunInProgress]:
        """Those that belong to the console."""
        return [run for run in runs if self.has(run.info)]

    def others(self, runs: Iterable[RunInProgress]) -> list[RunInProgress]:
        """Those that do not."""
        return [run for run in runs if not self.has(run.info)]

    def _is_inside(self, folder: str) -> bool:
        try:
            return Path(folder).resolve().is_relative_to(self.folder)
        except (OSError, ValueError, RuntimeError):  # no name of a folder
            return False


def folder_of(info: Mapping[str, Any]) -> str:
    """The folder that a run or a check belongs to. Versions that did not announce it announced the file of the run."""
    return str(info.get("folder") or Path(str(info.get("out"))).parent)


def drives_bench(info: Mapping[str, Any]) -> bool:
    """Whether a run or a check has devices, real or simulated: their wire is one, whoever drives it."""
    return (info.get("rig_kind") or info.get("source")) == "bench"
