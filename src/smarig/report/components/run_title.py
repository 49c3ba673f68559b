"""The title of a page of runs: what was done with which wire, under which load, and when, as far as it is known."""

import re
from collections.abc import Sequence
from datetime import UTC, datetime

from smarig.core import capitalised, spaced
from smarig.record import AnyRun
from smarig.report.components.numbers import number
from smarig.report.components.run_description import display_unit, protocol_name

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
    dates = sorted({_date(run) for run in runs} - {""})
    when = " to ".join(dict.fromkeys([dates[0], dates[-1]])) if dates else ""
    return ", ".join(part for part in (what + of_wire, load, when) if part)


def _load(run: AnyRun) -> str:
    """The first condition of a run that is a load, with its unit."""
    for name, stored in run.info.conditions.items():
        if _LOADS.search(name) and isinstance(stored, dict) and isinstance(stored.get("mean"), int | float):
            return f"{number(stored['mean'], 3)}{spaced(display_unit(str(stored.get('unit', ''))))}"
    return ""


def _date(run: AnyRun) -> str:
    epoch = run.info.start_epoch
    return f"{datetime.fromtimestamp(epoch, UTC):%Y-%m-%d}" if epoch else ""
