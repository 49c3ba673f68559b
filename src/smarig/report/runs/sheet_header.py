"""The lines of a printed sheet that say what was measured, when, and under which load."""

import re
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime

from smarig.core import spaced
from smarig.record import Run
from smarig.replay import condition_text, recorded_conditions
from smarig.report.components.html import Html, table
from smarig.report.components.numbers import number
from smarig.report.components.run_description import display_unit

_NOT_RECORDED = "not recorded"
_LOAD_WORDS = re.compile(r"load|stress|force|weight|mass|tension", re.IGNORECASE)


def sheet_header(runs: Sequence[Run]) -> Html:
    """Wire, load and date of runs; what was not recorded is said, so that it can be filled in by hand."""
    row = (
        _joined(run.info.wire or "" for run in runs),
        _joined(_load(run) for run in runs),
        _dates(runs),
        _joined(run.info.rig or "" for run in runs),
    )
    return table(("Wire", "Load", "Measured", "Rig"), [row])


def _joined(values: Iterable[str]) -> str:
    return ", ".join(dict.fromkeys(value for value in values if value)) or _NOT_RECORDED


def _load(run: Run) -> str:
    """The recorded load: conditions of the run whose name means a load, else the load of the rig's wire."""
    found = [
        f"{name.replace('_', ' ')} {condition_text(own)}{spaced(display_unit(own.unit))}"
        for name, own in recorded_conditions(run).items()
        if _LOAD_WORDS.search(name)
    ]
    force = run.info.load.get("force_N")
    if not found and isinstance(force, int | float):
        found = [f"force {number(float(force))} N"]
    return ", ".join(found)


def _dates(runs: Sequence[Run]) -> str:
    """The first and the last start of the sessions."""
    starts = sorted(run.info.start_epoch for run in runs if run.info.start_epoch)
    if not starts:
        return _NOT_RECORDED
    first, last = (datetime.fromtimestamp(t, UTC) for t in (starts[0], starts[-1]))
    if first.date() == last.date():
        later = f" to {last:%H:%M}" if f"{last:%H:%M}" != f"{first:%H:%M}" else ""
        return f"{first:%Y-%m-%d %H:%M}{later} UTC"
    return f"{first:%Y-%m-%d} to {last:%Y-%m-%d}"
