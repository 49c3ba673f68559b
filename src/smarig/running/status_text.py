"""What a run tells other processes about itself, as plain values: its description once, its status repeatedly."""

import math
from dataclasses import asdict
from typing import Any

from smarig.core import printable
from smarig.running.run_status import LogEntry, PanelRunInfo, RunStatus

_LONGEST = 300  # characters of a text


def description_of(run_info: PanelRunInfo, *, pid: int, start_epoch: float, command: str) -> dict[str, Any]:
    """The facts about a run, its process and its command."""
    facts = {name: _plain(value) for name, value in asdict(run_info).items()}
    out = run_info.out.absolute()
    facts["out"] = "" if run_info.kind == "check" else str(out)  # whole, however long
    facts["folder"] = str((run_info.folder or out.parent).absolute())
    return facts | {"pid": pid, "start_epoch": start_epoch, "command": _plain(command)}


def status_of(status: RunStatus) -> dict[str, Any]:
    """The figures of a run now."""
    found = {
        "step_number": status.step_number,
        "branch": status.branch,
        "target_K": status.target_K,
        "elapsed_s": status.elapsed_s,
        "left_s": status.left_s,
        "share": status.share,
        "speed_factor": status.speed_factor,
        "resumed": status.resumed,
        "paused": status.paused,
        "stopping": status.stopping,
        "severity": str(status.severity),
        "settling": status.settling,
        "last_event": _entry(status.last_event),
        "error": _entry(status.error),
        "ending": status.ending,
    }
    return {name: _plain(value) for name, value in found.items()}


def _entry(entry: LogEntry | None) -> dict[str, Any] | None:
    return {**entry._asdict(), "severity": str(entry.severity)} if entry is not None else None


def _plain(value: Any) -> Any:
    """A value that JSON has: no infinities, no endless texts."""
    if hasattr(value, "_asdict"):
        value = value._asdict()
    if isinstance(value, dict):
        return {name: _plain(part) for name, part in value.items()}
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return printable(value, _LONGEST) if isinstance(value, str) else value
