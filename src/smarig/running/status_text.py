"""What a run tells others about itself, as plain values: its description once, its status again and again."""

import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from smarig.core import printable
from smarig.running.run_status import LogEntry, PanelRunInfo, RunStatus

_LONGEST, _LONGEST_NAME = 500, 100  # characters of a sentence, of a name


def description_of(
    run_info: PanelRunInfo, *, pid: int, start_epoch: float, command: Sequence[str]
) -> dict[str, Any]:
    """The facts about a run, with its process and the command up to its first option."""
    values = asdict(run_info)
    words = [printable(word, _LONGEST_NAME) for word in command[:3] if not word.startswith("-")]
    facts = {name: _plain(value, _LONGEST_NAME) for name, value in values.items()}
    out = str(run_info.out.absolute())  # never cut: others open it
    return facts | {"out": out, "pid": pid, "start_epoch": start_epoch, "command": words}


def status_of(status: RunStatus) -> dict[str, Any]:
    """The figures of a run now, as JSON holds them."""
    settling, ending = status.settling, status.ending
    found = {
        "step_number": status.step_number,
        "branch": status.branch,
        "target_K": status.target_K,
        "elapsed_s": status.elapsed_s,
        "left_s": status.left_s,
        "share": status.share,
        "speed_factor": status.speed_factor,
        "paused": status.paused,
        "stopping": status.stopping,
        "severity": str(status.severity.name).lower(),
        "settling": dict(zip(settling._fields, map(_plain, settling))) if settling else None,
        "last_event": _entry(status.last_event),
        "error": _entry(status.error),
        "ending": dict(zip(ending._fields, map(_plain, ending))) if ending else None,
    }
    return {name: _plain(value) for name, value in found.items()}


def _entry(entry: LogEntry | None) -> dict[str, Any] | None:
    if entry is None:
        return None
    return {"t_s": _plain(entry.t_s), "level": entry.level, "kind": entry.kind, "text": _plain(entry.text)}


def _plain(value: Any, longest: int = _LONGEST) -> Any:
    """A value that JSON has: no infinities, no endless texts."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return printable(value, longest) if isinstance(value, str) else value
