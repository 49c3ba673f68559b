"""Writes a run as MCAP, the log format of Foxglove and PlotJuggler: messages in JSON with their schemas.

Topics: /samples, /steps (at the end of each step) and /events. The description of the run is metadata.
"""

import json
from collections.abc import Iterator
from heapq import merge
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from smarig.core import MissingExtra, UsageError
from smarig.exchange.export_columns import ExportColumn, event_columns, sample_columns, step_columns
from smarig.exchange.run_clock import zero_epoch
from smarig.record import AnyRun

_NS = 1_000_000_000
_LONGEST_S = 2**62 / _NS  # of a time in nanoseconds
_Message = tuple[int, int, bytes]  # time in ns, order, content


def mcap(run: AnyRun, path: Path) -> None:
    """MCAP log with samples, steps and events as JSON messages; for Foxglove and PlotJuggler (extra mcap)."""
    try:
        from mcap.writer import Writer
    except ImportError:
        raise MissingExtra("MCAP export", "mcap") from None
    start_s = zero_epoch(run) or 0.0
    topics = {
        "samples": (sample_columns(run), "t_s"),
        "steps": (step_columns(run), "t_end_s"),
        "events": (event_columns(run), "t_s"),
    }
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(profile="", library=f"smarig {version('smarig')}")
        channels = [_channel(writer, name, columns) for name, (columns, _) in topics.items()]
        parts = [
            _messages(run, columns, clock, start_s, order)
            for order, (columns, clock) in enumerate(topics.values())
        ]
        for at, order, data in merge(*parts, key=lambda message: message[:2]):
            writer.add_message(channels[order], at, data, at)
        writer.add_metadata("run", {"description": json.dumps(run.meta, ensure_ascii=False)})
        writer.finish()


def _channel(writer: Any, name: str, columns: list[ExportColumn]) -> int:
    properties = {column.name: _property(column) for column in columns}
    schema = {"type": "object", "title": name, "properties": properties}
    number = writer.register_schema(f"smarig.{name}", "jsonschema", json.dumps(schema).encode())
    return writer.register_channel(f"/{name}", "json", number)


def _property(column: ExportColumn) -> dict[str, str]:
    kind = "string" if column.text else "integer" if column.whole else "number"
    unit = f" ({column.unit})" if column.unit else ""
    return {"type": kind, "description": f"{column.what}{unit}"}


def _messages(
    run: AnyRun, columns: list[ExportColumn], clock: str, start_s: float, order: int
) -> Iterator[_Message]:
    """The rows of a table in the order of time; values that are unknown are left out."""
    values = {column.name: column.values for column in columns}
    times = np.asarray(values.get(clock, np.empty(0)), dtype=float)
    if not times.size:  # data without time: the number of the row stands for seconds
        times = np.arange(
            len(run) if order == 0 else len(values["kind"] if "kind" in values else values["index"])
        )
    times = np.where(np.isfinite(times), times, 0.0) + start_s
    if times.size and np.abs(times).max() > _LONGEST_S:
        raise UsageError("The times of this run are too large for MCAP, which counts nanoseconds.")
    whole = {column.name for column in columns if column.whole}
    rows = zip(*(part.tolist() for part in values.values()))
    ordered = sorted(zip(np.maximum(times, 0.0).tolist(), range(times.size), rows), key=lambda row: row[:2])
    for at, _, row in ordered:
        content = {
            name: int(value) if name in whole else value
            for name, value in zip(values, row)
            if value == value and value not in (float("inf"), float("-inf"))
        }
        yield round(at * _NS), order, json.dumps(content, ensure_ascii=False).encode()
