"""How a run ended, in words and as good news or bad, from its file."""

from contextlib import suppress
from pathlib import Path
from typing import Any

from smarig.console.web.run_words import ENDED
from smarig.core import Severity, SmarigError
from smarig.record import stored_run


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
