"""Slow-down of an experiment over real bytes: the same run in process and over each link, in lock-step.

The figures are hours of device time per hour of real time, and the time for eight hours. The samples must be
equal.
"""

import tempfile
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from smarig.record import Run, load_run
from smarig.runner import Session

LINKS = ("one_wire_twin", "one_wire_serial", "one_wire_modbus_tcp", "one_wire_modbus_rtu")
COLUMNS = ("tick", "counts", "current_A", "voltage_V", "ambient_degC", "quality", "input")
LONG, SHORT = "first_order_descending", "validation"
DAY_H = 8.0


def run(quick: bool = False) -> dict[str, Any]:
    """Measure the links.

    Returns ``{"protocol", "results": [{"rig", "hours", "seconds", "seconds_for_8_h", "times_twin",
    "equal_to_twin"}]}``.
    """
    protocol, settings = (SHORT, {"points": 3}) if quick else (LONG, {})
    rows: list[dict[str, Any]] = []
    twin: Run | None = None
    with tempfile.TemporaryDirectory() as folder:
        for rig in LINKS:
            started = perf_counter()
            with Session(rig, wire=f"benchmark {rig}") as session:
                record = load_run(session.run(protocol, settings, Path(folder) / f"{rig}.run.sqlite"))
            seconds, hours = perf_counter() - started, float(record["t_s"][-1]) / 3600
            twin = twin or record
            rows.append(
                {
                    "rig": rig,
                    "hours": hours,
                    "seconds": seconds,
                    "seconds_for_8_h": seconds * DAY_H / hours,
                    "times_twin": seconds / (rows[0]["seconds"] if rows else seconds),
                    "equal_to_twin": _same(record, twin),
                }
            )
    return {"protocol": protocol, "results": rows}


def _same(a: Run, b: Run) -> bool:
    return all(np.array_equal(a[c], b[c], equal_nan=True) for c in COLUMNS)
