"""The content of an exported run, independent of the format: columns with units and descriptions."""

import json
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, Quality
from smarig.record import SAMPLE_COLUMNS, AnyRun, Event, Step

FLAGS = {int(q): str(q.name).lower() for q in Quality if q}  # bit: word
_WHOLE = ("tick", "step", "counts", "quality")

# name: (unit, description)
_SAMPLES = {
    "tick": ("", "the device's tick"),
    "t_s": ("s", "device time: tick times period"),
    "step": ("", "number of the current step"),
    "current_command_A": ("A", "commanded current"),
    "current_A": ("A", "measured current"),
    "voltage_V": ("V", "voltage across the wire"),
    "temperature_degC": ("degC", "measured temperature of the wire"),
    "counts": ("count", "encoder counts since the last zero"),
    "ambient_degC": ("degC", "ambient temperature"),
    "quality": ("", "marks on a sample; 0 is good"),
}
_STEPS = {
    "index": ("", "number of the step"),
    "attempt": ("", "number of earlier attempts"),
    "void": ("", "1 if the step does not count"),
    "branch": ("", "segment of the protocol"),
    "target": ("", "target of the step, hysteresis input"),
    "t_start_s": ("s", "start, device time"),
    "t_end_s": ("s", "end, device time"),
    "verdict": ("", "step verdict: settled, timed_out, elapsed, interrupted, suspect"),
    "position": ("", "mean position over the settled window"),
    "n": ("", "number of samples in that window"),
}
_EVENTS = {
    "t_s": ("s", "device time"),
    "level": ("", "info, warning or error"),
    "kind": ("", "kind of event"),
    "text": ("", "text of the event"),
    "data": ("", "figures of the event, JSON"),
    "severity": ("", "none, minor, major or invalid"),
}


@dataclass(frozen=True)
class ExportColumn:
    """A column; ``unit`` is "" if it has none. Its ``values`` are read when they are used, and not kept."""

    name: str
    unit: str
    what: str
    read: Callable[[], NDArray[Any]]
    whole: bool = False
    text: bool = False

    @property
    def values(self) -> NDArray[Any]:
        """The values (n,), NaN or "" if unknown."""
        return self.read()


def integers(values: Array, missing: int) -> NDArray[np.int64]:
    """The values of an integer column, ``missing`` if unknown."""
    return np.where(np.isnan(values), missing, np.nan_to_num(values)).astype(np.int64)


def sample_columns(run: AnyRun) -> list[ExportColumn]:
    """The columns that were measured, and always tick and quality."""
    names = _SAMPLES | {
        "input": (run.input_unit, run.info.input.quantity or "hysteresis input"),
        "position": (run.unit, run.info.output.quantity or "position"),
    }
    return [
        ExportColumn(name, *names[name], partial(run.__getitem__, name), name in _WHOLE)
        for name in SAMPLE_COLUMNS
        if name in ("tick", "quality") or run.has(name)
    ]


def step_columns(run: AnyRun) -> list[ExportColumn]:
    """The table of steps, column by column."""
    units = {"target": run.input_unit, "position": run.unit}
    return [_column(name, units.get(name, unit), what, run.steps) for name, (unit, what) in _STEPS.items()]


def event_columns(run: AnyRun) -> list[ExportColumn]:
    """The table of events, column by column."""
    return [_column(name, unit, what, run.events) for name, (unit, what) in _EVENTS.items()]


def label(run: AnyRun) -> str:
    """The origin of the data: TWIN, BENCH, SIMULATION, IMPORT, or UNKNOWN if it is not recorded."""
    return (run.info.source or "unknown").upper()


def title(run: AnyRun) -> str:
    """One line: what was run on which rig, and the origin of the data."""
    what, rig, wire = (x or "?" for x in (run.info.protocol, run.info.rig, run.info.wire))
    return f"{what} on {rig}, wire {wire} ({label(run)})"


def _column(name: str, unit: str, what: str, rows: Iterable[Step | Event]) -> ExportColumn:
    cells = [getattr(row, name) for row in rows]
    if name == "data":
        cells = [json.dumps(v, ensure_ascii=False) for v in cells]
    text = name in ("branch", "verdict", "level", "kind", "text", "data", "severity")
    values: NDArray[Any] = (
        np.array(
            [str(cell) for cell in cells], dtype=object
        )  # not a dtype of texts: each would take the space of the longest
        if text
        else np.array([np.nan if v is None else v for v in cells], dtype=float)
    )
    whole = name in ("index", "attempt", "void", "n")
    return ExportColumn(name, unit, what, lambda: values, whole, text)
