"""Reads CSV with smarig's own columns: ``time_s``, a current, one position, and optional columns.

Any other column is an error. Without the column ``step``, steps are found from the current.
"""

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, DataError, UsageError, shown
from smarig.exchange.checks.channel_faults import quantum
from smarig.exchange.checks.findings import duplicate_columns, record_findings, saturation_marks
from smarig.exchange.checks.loop_faults import LoopRecord, loop_findings
from smarig.exchange.checks.time_axis import check_time, time_findings
from smarig.exchange.checks.value_bounds import check_bounds, check_size
from smarig.exchange.runs.hold_steps import COMMAND_A, Recording, found_steps, holds, tolerance
from smarig.exchange.runs.reader_result import RunDraft
from smarig.exchange.runs.rig_constants import RigConstants
from smarig.exchange.runs.with_heating_model import input_description
from smarig.exchange.tables.table_file import read_table
from smarig.exchange.tables.text_table import Table, TableLayout
from smarig.record import ImportFinding, remarks

CURRENTS = ("current_command_A", "current_A")
POSITIONS = {"position_counts": "count", "position_mm": "mm", "position_deg": "deg"}
QUANTITIES = {"mm": "displacement", "deg": "shaft angle"}
OPTIONAL = ("voltage_V", "ambient_degC", "temperature_degC", "step", "flags")
EXPORTED = ("tick", "counts", "input_K", "input_A")  # additional columns of smarig's exports
UNITS = {
    "current_A": "A",
    "voltage_V": "V",
    "temperature_degC": "degC",
    "ambient_degC": "degC",
}


def read_own_csv(path: Path, rig: RigConstants | None = None) -> RunDraft:
    """Read a CSV file with smarig's columns; DataError or UsageError with line and column."""
    known = ("time_s", *CURRENTS, *POSITIONS, *OPTIONAL)
    table = read_table(path, TableLayout(known=(*known, *EXPORTED)))
    _check_columns(path, table, known)
    line, t_s = table.line, table.columns["time_s"]
    for name, values in table.columns.items():
        check_size(path, name, values, line)
    check_bounds(path, "t_s", "time_s", t_s, line)
    check_time(path, "time_s", t_s, line, "refuse")
    columns: dict[str, Array] = {"t_s": t_s}
    for name in (*CURRENTS, *UNITS):
        if name in table.columns:
            check_bounds(path, name, name, table.columns[name], line)
            columns[name] = table.columns[name]
    unit, resolution = _position(path, table, rig, columns)
    drive = _drive(path, table, columns)
    input_meta, target = _input(table, rig, columns, drive)
    ranges = (
        _step_ranges(table.columns["step"]) if "step" in table.columns else holds(drive, _band(table, drive))
    )
    rows, columns["step"], notes = found_steps(
        Recording(t_s, columns["position"], resolution), ranges, target
    )
    measured = {**UNITS, "position": unit}
    columns["quality"] = np.fmax(_flags(path, table), saturation_marks(columns, measured))
    findings = [
        *remarks(*table.notes),
        *time_findings(t_s, line, "refuse"),
        *remarks(*duplicate_columns({k: x for k, x in table.columns.items() if k in (*POSITIONS, *UNITS)})),
        *record_findings(columns, measured, line),
        *_loop(rows, columns["step"], line, input_meta["unit"], unit),
        *remarks(*(notes if "step" not in table.columns else [])),
    ]
    output_meta = {"quantity": QUANTITIES[unit], "unit": unit, "per_count": resolution}
    meta = {"protocol": "imported", "input": input_meta, "output": output_meta}
    return RunDraft(columns, meta, tuple(rows), tuple(findings))


def _drive(path: Path, table: Table, columns: dict[str, Array]) -> Array:
    drive = next(columns[name] for name in CURRENTS if name in columns)
    if not np.isfinite(drive).all():
        line = table.line[int(np.argmin(np.isfinite(drive)))]
        raise DataError(f"{path}, line {line}: the current is empty or NaN. Every row needs a current.")
    return drive


def _loop(
    rows: list[tuple], step: Array, line: NDArray[np.int64], input_unit: str, unit: str
) -> list[ImportFinding]:
    """Findings on the loop of the ends of the steps; between them the wire is moving."""
    target, position = (np.array([row[k] for row in rows], dtype=float) for k in (4, 8))
    begins = np.concatenate([[0], np.flatnonzero(np.diff(np.nan_to_num(step, nan=-1.0))) + 1])
    first = line[[begins[int(np.argmax(step[begins] == row[0]))] for row in rows]] if rows else line[:0]
    return loop_findings(LoopRecord(target, position, first, input_unit, unit), designed=True)


def _check_columns(path: Path, table: Table, known: tuple[str, ...]) -> None:
    names = list(table.columns)
    allowed = {*known, *(EXPORTED if "tick" in names else ())}
    unknown = [name for name in names if name not in allowed]
    if unknown:
        raise DataError(
            f"{path}: column {shown(unknown[0])} is not one of {', '.join(known)}. "
            f"Rename it, or describe it in a mapping file (--map)."
        )
    if "time_s" not in names:
        raise DataError(
            f"{path} has no column 'time_s'. Data without time need a mapping file (--map) without [time]."
        )
    if not set(CURRENTS) & set(names):
        raise DataError(f"{path} has no current. A column 'current_command_A' or 'current_A' is needed.")
    positions = [name for name in POSITIONS if name in names]
    if len(positions) != 1:
        found = f"has {' and '.join(positions)}" if positions else "has no position"
        raise DataError(f"{path} {found}; exactly one of {', '.join(POSITIONS)} is needed.")


def _position(
    path: Path, table: Table, rig: RigConstants | None, columns: dict[str, Array]
) -> tuple[str, float | None]:
    name = next(n for n in POSITIONS if n in table.columns)
    values = table.columns[name]
    if not np.isfinite(values).any():
        raise DataError(f"{path}: column {shown(name)} holds no number.")
    if name != "position_counts":
        columns["position"] = values
        if rig and rig.actuator.unit != POSITIONS[name]:
            raise UsageError(
                f"{path} has {shown(name)}, but rig {rig.file.name} measures {rig.actuator.unit}."
            )
        if "counts" in table.columns:
            columns["counts"] = table.columns["counts"]
        return POSITIONS[name], rig.per_count if rig else quantum(values)
    if rig is None:
        raise UsageError(f"{path} gives positions in encoder counts. Name the rig with --rig.")
    columns["counts"], columns["position"] = values, values * rig.per_count
    return rig.actuator.unit, rig.per_count


def _input(
    table: Table, rig: RigConstants | None, columns: dict[str, Array], drive: Array
) -> tuple[dict[str, str], Callable[[int, int], float]]:
    """Fill in the input; returns its description and the target of a hold of samples a…b."""
    if rig is None:
        columns["input"] = table.columns.get("input_A", drive)
        return {"quantity": "current", "unit": "A"}, lambda a, b: float(np.mean(drive[a:b]))
    measured = columns.get("current_A", drive)
    along = rig.input_along(columns["t_s"], np.where(np.isfinite(measured), measured, drive))
    columns["input"] = table.columns.get("input_K", along)
    source = "the file" if "input_K" in table.columns else "heating model along the current, from a cold wire"
    meta = input_description(rig, source)
    return meta, lambda a, b: rig.actuator.input_for(float(np.mean(drive[a:b])))


def _band(table: Table, drive: Array) -> float:
    return COMMAND_A if "current_command_A" in table.columns else tolerance(drive)


def _step_ranges(step: Array) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.nan_to_num(step, nan=-1.0))) + 1
    bounds = [0, *edges.tolist(), step.size]
    return [(a, b) for a, b in pairwise(bounds) if np.isfinite(step[a])]


def _flags(path: Path, table: Table) -> Array:
    flags = table.columns.get("flags", np.zeros(len(table)))
    bad = np.flatnonzero(np.isfinite(flags) & ((flags < 0) | (flags != np.round(flags))))
    if bad.size:
        raise DataError(
            f"{path}, line {table.line[bad[0]]}, column 'flags': {flags[bad[0]]:g} is not a whole number ≥ 0."
        )
    return np.nan_to_num(flags)
