"""Groups of an HDF5 file that hold one signal each with the times of its readings, as logs of NeXus: channels that are
joined on time to one record.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from itertools import groupby
from pathlib import PurePosixPath

import numpy as np

from smarig.core import Array
from smarig.exchange.binary.hdf5_process import Hdf5Group
from smarig.exchange.layouts.joined_clocks import joined_clocks, share_times
from smarig.exchange.tables.found_table import FoundColumn
from smarig.exchange.units.unit_conversion import convert, dimension
from smarig.exchange.units.written_units import known_unit

_CLOCK = re.compile(r"times?|timestamps?|t|zeit", re.IGNORECASE)


@dataclass(frozen=True, eq=False)
class JoinedLogs:
    """The record of the ``logs`` below a ``group``: a clock and one column for each, named by its log."""

    group: str
    logs: tuple[str, ...]
    columns: tuple[FoundColumn, ...]
    notes: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class _Log:
    path: PurePosixPath
    clock: FoundColumn
    value: FoundColumn
    start: str


def joined_logs(groups: Sequence[Hdf5Group]) -> list[JoinedLogs]:
    """A record for each top group below which two or more logs have names of one kind and times in common."""
    logs = [log for group in groups if (log := _log(group)) is not None]
    kinds = [(_top(log), log.clock.name, log.value.name) for log in logs]
    order = sorted(range(len(logs)), key=lambda k: (kinds[k], k))
    found = [[logs[k] for k in same] for _, same in groupby(order, key=lambda k: kinds[k])]
    return [record for same in found if len(same) > 1 and (record := _joined(same)) is not None]


def _log(group: Hdf5Group) -> _Log | None:
    """A group of a clock that rises and one signal; None for another one."""
    clocks = [column for column in group.columns if _CLOCK.fullmatch(column.name)]
    signals = [column for column in group.columns if not _CLOCK.fullmatch(column.name)]
    if len(clocks) != 1 or len(signals) != 1 or not (np.diff(clocks[0].values) >= 0).all():
        return None
    return _Log(PurePosixPath(group.name), clocks[0], signals[0], group.starts.get(clocks[0].name, ""))


def _top(log: _Log) -> str:
    """The group below the file in which a log lies; the file itself for a log of its own."""
    return "/".join(log.path.parts[:2]).replace("//", "/") if len(log.path.parts) > 2 else "/"


def _joined(logs: Sequence[_Log]) -> JoinedLogs | None:
    """The logs in common rows; None if nothing says when each began, or if they were not taken at one time."""
    clocks = _clocks(logs)
    if not clocks or not share_times(clocks):
        return None
    joined = joined_clocks(clocks)
    names = _names(logs)
    columns = [FoundColumn(logs[0].clock.name, "s", clocks[joined.base])]
    for k, (log, name) in enumerate(zip(logs, names)):
        columns.append(replace(log.value, name=name, values=joined.in_rows(k, log.value.values)))
    done = (joined.sentence(names[joined.base]),)
    return JoinedLogs(_top(logs[0]), tuple(str(log.path) for log in logs), tuple(columns), done)


def _clocks(logs: Sequence[_Log]) -> list[Array]:
    """The times of each log in seconds from the earliest start; none for units or starts that cannot be compared."""
    units = [known_unit(log.clock.unit) or "s" for log in logs]
    if any(dimension(unit) != "time" for unit in units):
        return []
    seconds = [np.asarray(convert(log.clock.values, unit, "s")) for log, unit in zip(logs, units)]
    if len({log.start for log in logs}) == 1:
        return seconds
    try:
        starts = [datetime.fromisoformat(log.start) for log in logs]
        return [t + (start - min(starts)).total_seconds() for t, start in zip(seconds, starts)]
    except (ValueError, TypeError):  # no date, or only some with a zone
        return []


def _names(logs: Sequence[_Log]) -> list[str]:
    """The names of the logs, with as much of their paths as tells them apart."""
    for parts in range(1, max(len(log.path.parts) for log in logs)):
        names = ["/".join(log.path.parts[-parts:]) for log in logs]
        if len(set(names)) == len(names):
            return names
    return [str(log.path) for log in logs]
