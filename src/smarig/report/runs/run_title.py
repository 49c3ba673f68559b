"""The title of a page of runs: what was done with which wire, under which load, and when, as far as it is known.

The lines of a printed sheet that say what was measured, when, and under which load.
"""

import re
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime

from smarig.core import capitalised, spaced
from smarig.record import AnyRun, Run
from smarig.replay import condition_text, recorded_conditions
from smarig.report.components.html import Html, table
from smarig.report.components.numbers import number
from smarig.report.components.run_description import display_unit, protocol_name, started

_LOADS = re.compile(r"load|stress|force|weight|mass|tension", re.IGNORECASE)


def run_title(run: AnyRun) -> str:
    """The protocol of a run, its wire, load and date."""
    return titled(capitalised(protocol_name(run)), [run])


def titled(what: str, runs: Sequence[AnyRun]) -> str:
    """``what`` with the wire, the load and the date of runs; what differs between them is left out, or is a range."""
    wires = {run.info.wire for run in runs if run.info.wire}
    of_wire = f" of {wires.pop()}" if len(wires) == 1 else ""
    loads = {_load(run) for run in runs}
    load = loads.pop() if len(loads) == 1 else ""
    dates = sorted({started(run, "%Y-%m-%d") for run in runs} - {""})
    when = " to ".join(dict.fromkeys([dates[0], dates[-1]])) if dates else ""
    return ", ".join(part for part in (what + of_wire, load, when) if part)


def _load(run: AnyRun) -> str:
    """The first condition of a run that is a load, with its unit."""
    for name, stored in run.info.conditions.items():
        if _LOADS.search(name) and isinstance(stored, dict) and isinstance(stored.get("mean"), int | float):
            return f"{number(stored['mean'], 3)}{spaced(display_unit(str(stored.get('unit', ''))))}"
    return ""


_NOT_RECORDED = "not recorded"


def sheet_header(runs: Sequence[Run]) -> Html:
    """Wire, load and date of runs; what was not recorded is said, so that it can be filled in by hand."""
    row = (
        _joined(run.info.wire or "" for run in runs),
        _joined(_recorded_loads(run) for run in runs),
        _dates(runs),
        _joined(run.info.rig or "" for run in runs),
    )
    return table(("Wire", "Load", "Measured", "Rig"), [row])


def _joined(values: Iterable[str]) -> str:
    return ", ".join(dict.fromkeys(value for value in values if value)) or _NOT_RECORDED


def _recorded_loads(run: Run) -> str:
    """The recorded load: conditions of the run whose name means a load, else the load of the rig's wire."""
    found = [
        f"{name.replace('_', ' ')} {condition_text(own)}{spaced(display_unit(own.unit))}"
        for name, own in recorded_conditions(run).items()
        if _LOADS.search(name)
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
