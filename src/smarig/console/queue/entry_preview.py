"""Checks and previews an entry as the command line would: its command runs with ``--dry-run`` in its own process."""

import contextlib
import json
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from smarig.config import load_rig
from smarig.console.command_process import run_command
from smarig.console.queue.entry_request import EntryRequest, entry_command
from smarig.core import UsageError

_LONGEST_S = 600.0  # a preview computes 100,000 ticks a second


@dataclass(frozen=True)
class EntryPreview:
    """Predicted time of the runs, and the time that they are expected to take on the clock.

    ``runs``: the previews of its runs, with the keys of ``smarig run --dry-run --json``.
    """

    duration_s: float
    expected_s: float
    runs: tuple[dict[str, Any], ...] = ()


Previewer = Callable[[EntryRequest, Path], EntryPreview]


def preview_entry(request: EntryRequest, folder: Path) -> EntryPreview:
    """The preview of an entry. Raises UsageError with the sentence of the command line."""
    started = time.monotonic()
    done = run_command([*entry_command(request), "--dry-run", "--json"], folder, _LONGEST_S)
    took_s = time.monotonic() - started
    found = _object(done.stdout)
    if done.returncode or "preview" not in found:
        last = (done.stderr.strip().splitlines() or [f"exit status {done.returncode}"])[-1]
        raise UsageError(str(found.get("error") or f"The preview failed: {last}"))
    duration_s = sum(run["duration_s"] for run in found["preview"])
    pace = _pace(request, folder)
    return EntryPreview(duration_s, duration_s / pace if pace else took_s, tuple(found["preview"]))


def _pace(request: EntryRequest, folder: Path) -> float | None:
    """Seconds of a run per second of the clock; None for a twin as fast as possible, as in its preview."""
    rig = load_rig(str(folder / request.rig) if request.rig.endswith(".toml") else request.rig)
    if rig.kind == "twin":
        return request.speed
    return (request.speed or rig.simulator.speed) if rig.simulator is not None else 1.0


def _object(text: str) -> dict[str, Any]:
    with contextlib.suppress(ValueError):
        found = json.loads(text)
        if isinstance(found, dict):
            return found
    return {}
