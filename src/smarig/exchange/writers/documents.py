"""Writes a run as documents of bluesky's event model, one per line: [name, document], for databroker and Tiled.

Stream ``primary`` holds the samples, in pages; ``steps`` and ``events`` the tables of the run.
"""

import json
import math
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path
from typing import Any
from uuid import NAMESPACE_URL, uuid5

from smarig.exchange.export_columns import (
    ExportColumn,
    event_columns,
    label,
    sample_columns,
    step_columns,
    title,
)
from smarig.exchange.run_clock import zero_epoch
from smarig.record import AnyRun
from smarig.replay import file_hash

_PAGE_ROWS = 5000
_Document = tuple[str, dict[str, Any]]


def documents(run: AnyRun, path: Path) -> None:
    """Documents of bluesky's event model as JSON lines: start, descriptors, event pages, stop."""
    with path.open("w", encoding="utf-8") as file:
        for name, document in _documents(run):
            file.write(json.dumps([name, document], ensure_ascii=False, allow_nan=False) + "\n")


def _documents(run: AnyRun) -> Iterator[_Document]:
    start_s = zero_epoch(run) or 0.0
    identity = _identity(run, "start")
    times = run.extremes("t_s") or (0.0, 0.0)
    yield "start", _start(run, identity, start_s + times[0])
    streams = {
        "primary": (sample_columns(run), "t_s"),
        "steps": (step_columns(run), "t_end_s"),
        "events": (event_columns(run), "t_s"),
    }
    counts = {}
    for stream, (columns, clock) in streams.items():
        rows = columns[0].values.size if columns else 0
        counts[stream] = rows
        descriptor = _identity(run, stream)
        yield "descriptor", _descriptor(columns, stream, descriptor, identity, start_s)
        yield from _pages(columns, clock, descriptor, start_s)
    yield (
        "stop",
        {
            "uid": _identity(run, "stop"),
            "run_start": identity,
            "time": start_s + times[1],
            "exit_status": "success" if run.complete and run.cause == "done" else "fail",
            "reason": run.cause,
            "num_events": counts,
        },
    )


def _identity(run: AnyRun, part: str) -> str:
    """An identity that is the same for every export of the same file."""
    return str(uuid5(NAMESPACE_URL, f"smarig:{file_hash(run)}:{part}"))


def _start(run: AnyRun, identity: str, began: float) -> dict[str, Any]:
    return {
        "uid": identity,
        "time": began,
        "plan_name": run.info.protocol or "unknown",
        "sample": run.info.wire or "",
        "hints": {"dimensions": [[["input"], "primary"]] if run.has("input") else []},
        "smarig": {
            "version": version("smarig"),
            "title": title(run),
            "data": label(run),
            "file": run.path.name,
            "description": json.dumps(run.meta, ensure_ascii=False),
        },
    }


def _descriptor(
    columns: list[ExportColumn], stream: str, identity: str, start: str, began: float
) -> dict[str, Any]:
    keys = {
        column.name: {
            "source": f"smarig:{column.what}",
            "dtype": "string" if column.text else "number",
            "shape": [],
            "units": column.unit,
        }
        for column in columns
    }
    return {
        "uid": identity,
        "run_start": start,
        "time": began,
        "name": stream,
        "data_keys": keys,
        "object_keys": {"run": list(keys)},
        "configuration": {},
        "hints": {"run": {"fields": [n for n in ("input", "position") if n in keys]}},
    }


def _pages(columns: list[ExportColumn], clock: str, descriptor: str, start_s: float) -> Iterator[_Document]:
    values = {column.name: [_plain(v) for v in column.values.tolist()] for column in columns}
    rows = len(next(iter(values.values()), []))
    known = values.get(clock) or [None] * rows
    times = [start_s + (k if at is None else at) for k, at in enumerate(known)]
    for begin in range(0, rows, _PAGE_ROWS):
        part = slice(begin, min(begin + _PAGE_ROWS, rows))
        numbers = list(range(part.start + 1, part.stop + 1))
        data = {name: column[part] for name, column in values.items()}
        yield (
            "event_page",
            {
                "descriptor": descriptor,
                "uid": [_identity_of_row(descriptor, n) for n in numbers],
                "seq_num": numbers,
                "time": times[part],
                "data": data,
                "timestamps": dict.fromkeys(data, times[part]),
                "filled": {},
            },
        )


def _identity_of_row(descriptor: str, number: int) -> str:
    return str(uuid5(NAMESPACE_URL, f"{descriptor}:{number}"))


def _plain(value: Any) -> Any:
    """JSON has no NaN: an unknown value is null."""
    return None if isinstance(value, float) and not math.isfinite(value) else value
