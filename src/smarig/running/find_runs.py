"""Finds the runs in progress of this user on this computer, and what killed runs have left behind."""

import contextlib
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from smarig.core import SmarigError, printable
from smarig.running import memory_layout as layout
from smarig.running.run_in_progress import AnnouncedFile, RunInProgress, opened
from smarig.running.running_folder import SUFFIX, check_own, running_folder

_MOST = 1000  # files that are looked at
_TEXTS = ("command", "protocol", "rig", "wire", "source", "unit", "out", "place")
_NUMBERS = ("start_epoch", "period_s", "duration_s", "steps", "done_steps", "done_s")


class EndedRun(NamedTuple):
    """A run whose process ended without closing it (kill -9, a crash, no memory): description and last status."""

    info: dict[str, Any]
    status: dict[str, Any]

    @property
    def sentence(self) -> str:
        """What happened, in one sentence.

        >>> EndedRun({"protocol": "validation", "rig": "one_wire_twin", "pid": 7, "out": "/a/v.sqlite"}, {}).sentence
        'validation on one_wire_twin (process 7) ended without closing /a/v.sqlite.'
        """
        return f"{self.clause}."

    @property
    def clause(self) -> str:
        """The same without its full stop."""
        info = self.info
        if self.is_check:
            return printable(f"The check of {info['rig']} (process {info['pid']}) ended without finishing")
        what = f"{info['protocol']} on {info['rig']} (process {info['pid']})"
        return printable(f"{what} ended without closing {info['out']}")

    @property
    def is_check(self) -> bool:
        """Whether it was the bring-up of a rig."""
        return self.info.get("kind") == "check"


def runs_in_progress() -> tuple[RunInProgress, ...]:
    """The runs of this user on this computer, oldest first. Whatever else lies in their folder is left out."""
    found = []
    for path in _paths():
        with contextlib.suppress(OSError, SmarigError), opened(path) as file:
            if file.state == layout.RUNNING and (info := _valid_description(file)) and file.is_held():
                found.append(RunInProgress(path.name.removesuffix(SUFFIX), info, path))
    return tuple(sorted(found, key=lambda run: run.info["start_epoch"]))


def collect_ended(
    wanted: Callable[[Mapping[str, Any]], bool] = lambda _info: True, *, older_than_s: float = 0.0
) -> tuple[EndedRun, ...]:
    """The runs whose processes ended without closing them. Each is returned once, to one process; its file is removed.

    ``wanted``: only those with such a description. ``older_than_s``: only those that started so long ago.
    """
    collected = []
    for path in _paths():
        with contextlib.suppress(OSError, SmarigError):
            with opened(path) as file:
                ended = _take(file, wanted, older_than_s)
            if ended is not None:
                collected += [ended] if ended.info else []
                path.unlink(missing_ok=True)
    return tuple(collected)


def _take(
    file: AnnouncedFile, wanted: Callable[[Mapping[str, Any]], bool], older_than_s: float
) -> EndedRun | None:
    """What a dead process left, taken from all others by the state; without a description if it was told before."""
    if file.state not in (layout.RUNNING, layout.ENDED) or file.is_held() or not file.lock_alone():
        return None
    info = _valid_description(file)
    if (
        file.state == layout.ENDED or not info
    ):  # the process, or whoever told of it, could not remove the file
        return EndedRun({}, {})
    if time.time() - info["start_epoch"] < older_than_s or not wanted(info):
        return None
    ended = EndedRun(info, file.status())
    file.write(0, layout.HEAD.pack(layout.ENDED, layout.VERSION, layout.RECORDS))
    return ended


def _paths() -> list[Path]:
    """The files that may announce runs. None if the folder is missing, unreadable or not the user's own."""
    folder = running_folder()
    try:
        check_own(folder)
        return sorted(path for path in folder.iterdir() if path.name.endswith(SUFFIX))[:_MOST]
    except (OSError, SmarigError):
        return []


def _valid_description(file: AnnouncedFile) -> dict[str, Any]:
    """The description, if every fact in it is of its kind; else empty. Process numbers below 2 mean groups or all."""
    info = file.description()
    texts = all(isinstance(info.get(name), str) for name in _TEXTS)
    numbers = all(type(info.get(name)) in (int, float) for name in _NUMBERS)
    pid = type(info.get("pid")) is int and info["pid"] > 1
    return info if texts and numbers and pid and isinstance(info.get("limits"), dict) else {}
