"""The words for a run or a check in progress: its title, conditions and state, for every page that shows it.

How a run ended, in words and as good news or bad, from its file.
"""

import time
from contextlib import suppress
from pathlib import Path
from typing import Any

from smarig.core import Severity, SmarigError, UsageError, printable
from smarig.record import stored_run
from smarig.report import duration
from smarig.running import RunInProgress

ENDED = "The run has ended."
_STOPPING = "Stopping: the current goes to zero."


def run_facts(run: RunInProgress) -> dict[str, Any]:
    """What does not change: key, title, conditions, source, unit and the file that is written."""
    info = {name: _shown(value) for name, value in run.info.items()}
    protocol = str(info["protocol"]).replace("_", " ")
    place = f", {info['place']}" if info.get("place") else ""
    source = "twin" if info["source"] == "twin" else info["source"]
    since = time.strftime("%Y-%m-%d %H:%M", time.localtime(info["start_epoch"]))
    written = "" if run.is_check else f" · writes {info['out']}"
    return {
        "key": run.key,
        "title": f"{protocol[:1].upper()}{protocol[1:]} {'of' if run.is_check else 'on'} {info['rig']}{place}",
        "conditions": f"Wire {info['wire']} · {source} · since {since} · process {info['pid']}{written}",
        "source": info["source"],
        "unit": str(info.get("unit") or ""),
        "input": "T₁ − T₂" if info.get("two_wire") else "temperature above ambient",
        "out": Path(info["out"]).name,
        "file": str(info["out"]),
        "is_check": run.is_check,
    }


def run_card(run: RunInProgress) -> dict[str, Any]:
    """The run on the overview."""
    return {**run_facts(run), **run_state(run)}


def run_state(run: RunInProgress) -> dict[str, Any]:
    """What changes: state, facts and settling in words, share, paused."""
    try:
        status = run.status()
    except UsageError:
        return _only("The check has ended." if run.is_check else ENDED)
    if run.is_check:
        return _only(_STOPPING if status.get("stopping") else "The rig is being checked.")
    if not status:
        return _only("The run is starting.")
    return {
        "state": _state(status, run.info),
        "facts": _facts(status),
        "settling": _settling(status["settling"]),
        "share": status["share"],
        "paused": bool(status["paused"]),
    }


def _only(state: str) -> dict[str, Any]:
    """A state without figures."""
    return {"state": state, "facts": "", "settling": "", "share": None, "paused": False}


def _state(status: dict[str, Any], info: dict[str, Any]) -> str:
    error = status["error"]
    if status["ending"] and status["ending"]["text"]:
        return f"{status['ending']['word']}: {status['ending']['text']}"
    if error:
        return f"Error: {error['text']}"
    if status["stopping"]:
        return _STOPPING
    if status["paused"]:
        return "Paused: the current stays and sampling continues."
    target = f" at {status['target_K']:.1f} K" if status["target_K"] is not None else ""
    branch = f": {status['branch']}{target}" if status["branch"] else target
    return f"Step {status['step_number']} of {info.get('steps', '?')}{branch}"


def _facts(status: dict[str, Any]) -> str:
    factor = status["speed_factor"] or 1.0
    left = f"{duration(status['left_s'])} of rig time left"
    if abs(factor - 1) > 0.2:  # a twin that is faster than real time
        left += f", {duration(status['left_s'] / factor)} on the clock"
    since = "since it was resumed" if status.get("resumed") else "elapsed"
    return f"{duration(status['elapsed_s'])} {since}, {left}"


def _settling(progress: dict[str, Any] | None) -> str:
    if progress is None:
        return ""
    share = f"{100 * progress['share']:.0f} % of the window"
    if progress["band_counts"] is None:
        return f"Fixed hold: {share}, {duration(progress['min_time_left_s'])} left."
    spread = progress["spread_counts"]
    moved = f"spread {spread:.2f} of {progress['band_counts']:g} counts, " if spread is not None else ""
    return (
        f"{share}, {moved}at least {duration(progress['min_time_left_s'])} left, "
        f"time-out in {duration(progress['timeout_s'])}."
    )


def _shown(value: Any) -> Any:
    """A value as a page can hold it: names of files and rigs may hold anything."""
    return printable(value) if isinstance(value, str) else value


def run_outcome(file: Path) -> dict[str, Any]:
    """The sentence, and "good", "warning" (stopped) or "bad" (tripped, a fault, killed); "" if it is not known."""
    with suppress(SmarigError, OSError, ValueError), stored_run(file, verify=False) as run:
        if not run.complete:
            return {
                "state": "The process of this run ended without finishing. Resume it with smarig resume.",
                "level": "bad",
            }
        if run.cause == "done":
            return {"state": "Ended: done.", "level": "good"}
        severity = max(
            (e.severity for e in run.events if e.kind == "end"), key=_is_bad, default=Severity.MINOR
        )
        requester = f" Requested by {run.stopped_by.text}." if run.stopped_by else ""
        return {
            "state": f"Ended: {run.cause.rstrip('.')}.{requester}",
            "level": "bad" if _is_bad(severity) else "warning",
        }
    return {"state": ENDED, "level": ""}


def _is_bad(severity: Severity) -> bool:
    return severity.reaches(Severity.MAJOR)
