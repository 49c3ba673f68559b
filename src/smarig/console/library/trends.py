"""How the figures of a wire have changed over its runs."""

import json
import sqlite3
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from smarig.console.library.library_entry import MODEL, RUN
from smarig.console.library.result_content import ERROR
from smarig.core import Array

_OF_RUNS = ("stroke", "A_s", "A_f", "M_s", "M_f", "cycles")
QUANTITIES = {**dict.fromkeys(_OF_RUNS, RUN), ERROR: MODEL}


class Trend(NamedTuple):
    """Values (n,) at ``epochs`` (n,), seconds since 1970, with 95 % intervals (n, 2) or None, and the entries' ids."""

    epochs: Array
    values: Array
    intervals: Array | None
    unit: str
    ids: tuple[str, ...]


class _Point(NamedTuple):
    epoch: float
    value: float
    low: float | None
    high: float | None
    unit: str
    id: str


def trends(db: sqlite3.Connection, wire: str) -> dict[str, Trend]:
    """The trends of a wire by quantity: stroke, A_s, A_f, M_s, M_f, error_times_noise (of models), cycles (since the
    first run in the library).

    A quantity in several units has a trend in each: "A_s (degC)". Runs without a time, and copies, are left out.
    """
    points = list(_points(db, wire))
    found: dict[str, Trend] = {}
    for quantity in QUANTITIES:
        own = [point for name, point in points if name == quantity]
        units = list(dict.fromkeys(point.unit for point in own))
        for unit in units:
            name = quantity if len(units) == 1 else f"{quantity} ({unit})"
            found[name] = _trend([point for point in own if point.unit == unit], unit)
    if "cycles" in found:
        found["cycles"] = found["cycles"]._replace(values=np.cumsum(found["cycles"].values))
    return found


def _points(db: sqlite3.Connection, wire: str) -> Iterator[tuple[str, _Point]]:
    query = (
        "SELECT e.kind, e.began, e.id, c.figures FROM entry e JOIN content c ON c.place = e.place "
        "WHERE e.wire = ? AND e.began IS NOT NULL AND e.id = e.identity ORDER BY e.began, e.place"
    )
    for kind, epoch, id, figures in db.execute(query, (wire,)):
        for name, (value, low, high, unit) in json.loads(figures).items():
            if QUANTITIES.get(name) == kind:
                yield name, _Point(epoch, value, low, high, unit, id)


def _trend(points: list[_Point], unit: str) -> Trend:
    intervals = np.array([(p.low, p.high) for p in points], dtype=float)  # None becomes NaN
    return Trend(
        epochs=np.array([p.epoch for p in points]),
        values=np.array([p.value for p in points]),
        intervals=intervals if np.isfinite(intervals).any() else None,
        unit=unit,
        ids=tuple(p.id for p in points),
    )
