"""Reads a table through a mapping file: columns are renamed, converted, unfolded and checked, but not repaired."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, DataError, Quality, shown, spaced
from smarig.exchange.checks.channel_faults import quantum, unused_findings
from smarig.exchange.checks.clipped_output import clipped_findings, clipped_output
from smarig.exchange.checks.findings import (
    duplicate_columns,
    record_findings,
    repeated_rows,
    saturation_marks,
)
from smarig.exchange.checks.frozen_readings import without_frozen
from smarig.exchange.checks.loop_faults import LoopRecord, loop_findings
from smarig.exchange.checks.time_axis import (
    check_time,
    counter_findings,
    joined_clock,
    merge_repeats,
    time_findings,
    unwrapped,
)
from smarig.exchange.checks.value_bounds import (
    check_bounds,
    check_size,
    check_strain,
    plausible,
    without_codes,
)
from smarig.exchange.mappings.mapping import MappingFile, require_columns
from smarig.exchange.runs.channel_readings import channel_readings, scaled
from smarig.exchange.runs.reader_result import RunDraft, directions, step_row
from smarig.exchange.tables.lost_rows import without_lost_rows
from smarig.exchange.tables.table_file import read_table
from smarig.exchange.tables.text_table import Table, TableLayout
from smarig.exchange.units.unit_conversion import convert
from smarig.exchange.units.units import spelled
from smarig.record import OWN_ZERO, ImportFinding, remarks


def read_mapped_csv(path: Path, mapping: MappingFile) -> RunDraft:
    """Read a text table as its mapping describes; DataError, ConfigError or UsageError with line and column."""
    f = mapping.file
    layout = TableLayout(
        known=tuple(mapping.used()) if not f.names else (),
        names=f.names,
        delimiter=f.delimiter,
        decimal=f.decimal,
        header_starts=f.header_starts,
        table=f.table,
        tables=f.tables,
        thousands=f.thousands,
        header_line=f.header_line,
        units_rows=f.units_rows,
        interruptions=f.interruptions,
        no_reading=f.no_reading,
        clock=mapping.time.column if mapping.time and mapping.time.written == "clock" else "",
        text=tuple(mapping.ignore),
    )
    table = without_lost_rows(read_table(path, layout))
    require_columns(mapping, list(table.columns), path)
    return mapped_draft(path, table, mapping)


def mapped_draft(path: Path, table: Table, mapping: MappingFile) -> RunDraft:
    """The run of a table that holds every column of its mapping; loops keep their numbers as ``step``."""
    began, (table, part) = _began(table, mapping), _part(path, table, mapping)
    table, clock = _with_time(path, _of_plausible_size(path, table, mapping), mapping)
    columns, line, branch, unfolded = _unfold_branches(path, table, mapping)
    conditions, constant = _conditions(path, table, mapping)
    odd = _compare_sensors(path, table, mapping, columns)
    columns["input"] = columns[mapping.input.channel]
    if "position" in columns and mapping.steps != "rows":
        unit = mapping.unit_of("position")
        columns["position"], stuck = without_frozen(unit, columns["input"], columns["position"], line)
        odd += stuck
    units = {channel: mapping.unit_of(channel) for channel in columns if channel not in ("t_s", "step")}
    columns["quality"] = saturation_marks(columns, units)
    if "position" in columns:
        clipped = clipped_output(columns["input"], columns["position"])
        columns["quality"] = np.fmax(columns["quality"], clipped * float(Quality.SATURATED))
        odd += clipped_findings(units["position"], columns["position"], clipped, line)
    findings = [
        *remarks(*table.notes),
        *part,
        *clock,
        *unfolded,
        *odd,
        *constant,
        *remarks(*duplicate_columns(_without_time(table, mapping))),
    ]
    if mapping.time is None:  # with a clock, equal rows may be rest
        findings += repeated_rows(_without_time(table, mapping), table.line)
    findings += _findings_by_loop(columns, units, line, table.loop)
    for name in mapping.ignore:
        if name in table.columns:
            findings += unused_findings(f"The unused column {shown(name)}", table.columns[name], table.line)
    if mapping.output is None:
        findings += remarks(
            "These data have no position. They show the heating of the wire, but not its hysteresis."
        )
    elif _is_strain(mapping):
        column = mapping.tables()[0][1]["position"].column
        strain = convert(columns["position"], mapping.output.unit, "mm/mm")
        findings += remarks(*check_strain(path, column, strain))
    if table.loop is not None:
        columns["step"] = table.loop.astype(float)
    steps = _reading_steps(columns, branch) if mapping.steps == "rows" else []
    meta = _meta(mapping, columns, conditions, table)
    return RunDraft(columns, meta, tuple(steps), tuple(findings), began)


def _began(table: Table, mapping: MappingFile) -> float | None:
    """When the record of a part began, on the clock of its table, if that goes on over the rows before the part."""
    rows, time = mapping.rows, mapping.time
    if rows is None or time is None or time.restarts == "join" or time.fraction or time.period_s is not None:
        return None
    t = unwrapped(table.columns[time.column])[: rows.first]
    t = t[np.isfinite(t)]
    if t.size < 2 or np.any(np.diff(t) < 0):
        return None
    return float(convert(t[:1], time.unit, "s")[0])


def _part(path: Path, table: Table, mapping: MappingFile) -> tuple[Table, list[ImportFinding]]:
    """The rows of the table that the mapping describes, and a finding on the others; DataError if there are fewer."""
    if mapping.rows is None:
        return table, []
    try:
        part = mapping.rows.of(len(table))
    except ValueError as error:
        raise DataError(f"{path}: {error}. Correct the mapping.") from None
    loop = table.loop[part] if table.loop is not None else None
    columns = {name: x[part] for name, x in table.columns.items()}
    notes = remarks(
        f"Rows {mapping.rows.first} to {mapping.rows.last} of {len(table)} are read, as the mapping says."
    )
    return replace(table, columns=columns, line=table.line[part], loop=loop), notes


def _of_plausible_size(path: Path, table: Table, mapping: MappingFile) -> Table:
    """The table; DataError for a value of a used column that is too large. In unused columns it counts as missing."""
    used = mapping.used()
    for name in used:
        check_size(path, name, table.columns[name], table.line)
    columns = {name: x if name in used else plausible(x) for name, x in table.columns.items()}
    return _replace_rows(table, columns, table.line)


def _findings_by_loop(
    columns: dict[str, Array],
    units: dict[str, str],
    line: NDArray[np.int64],
    number: NDArray[np.int64] | None,
) -> list[ImportFinding]:
    """Findings on channels and on input against output; loop by loop if loops are numbered."""
    if number is not None:
        parts = [(f"Loop {k}: ", number == k) for k in np.unique(number).tolist()]
    else:
        parts = [("", np.ones(line.size, dtype=bool))]
    out = []
    for prefix, rows in parts:
        part, where = {name: x[rows] for name, x in columns.items()}, line[rows]
        found = record_findings(part, units, where)
        if "position" in part:
            loop = LoopRecord(part["input"], part["position"], where, units["input"], units["position"])
            found += loop_findings(loop)
        out += [f.beginning_with(prefix) for f in found]
    return out


def _with_time(path: Path, table: Table, mapping: MappingFile) -> tuple[Table, list[ImportFinding]]:
    """The table with a column 't_s' (NaN without a clock); repeats are treated as the mapping states."""
    time = mapping.time
    if time is None:
        return _replace_rows(table, {**table.columns, "t_s": np.full(len(table), np.nan)}, table.line), []
    messages: list[ImportFinding] = []
    if time.empty == "leave out":
        table, messages = _with_times_only(table, time.column)
    t_s = np.zeros(len(table))
    if time.column:
        written = table.columns[time.column]
        counted = unwrapped(written)
        messages += counter_findings(time.column, written, counted, table.line)
        t_s = t_s + convert(counted, time.unit, "s")
    if time.fraction:
        t_s = t_s + convert(table.columns[time.fraction], time.fraction_unit, "s")
        t_s -= t_s[0] if time.written == "clock" else 0.0
    if time.period_s is not None:
        within = time.period_s if time.column else 0.0
        outside = np.flatnonzero((t_s < 0) | (t_s > within))
        if outside.size:
            raise DataError(
                f"{path}, line {table.line[outside[0]]}, column {shown(time.column)}: {t_s[outside[0]]:g} s lies "
                f"outside the period of {time.period_s:g} s."
            )
        t_s = t_s + np.arange(len(table)) // time.rows_per_period * time.period_s
    check_bounds(path, "t_s", time.column or "time", t_s, table.line)
    if time.restarts == "join":
        t_s, restarted = joined_clock(time.column or "time", t_s, table.line)
        messages += restarted
    check_time(path, time.column or "time", t_s, table.line, time.repeated)
    messages += time_findings(t_s, table.line, time.repeated) if time.period_s is None else []
    if time.period_s is not None:
        messages += remarks(
            f"The file has no clock. The period of {time.period_s:g} s comes from the mapping and is not measured."
        )
    if time.repeated != "mean":
        return _replace_rows(table, {**table.columns, "t_s": t_s}, table.line), messages
    first, merged = merge_repeats(t_s, {**table.columns, "t_s": t_s})
    return _replace_rows(table, merged, table.line[first]), messages


def _with_times_only(table: Table, name: str) -> tuple[Table, list[ImportFinding]]:
    """The rows that have a time, and a finding on the others."""
    known = np.isfinite(table.columns[name])
    if known.all():
        return table, []
    loop = table.loop[known] if table.loop is not None else None
    rows = replace(
        table, columns={k: x[known] for k, x in table.columns.items()}, line=table.line[known], loop=loop
    )
    count = int((~known).sum())
    return rows, remarks(f"{count} of {known.size} rows are left out, because {shown(name)} is empty there.")


def _without_time(table: Table, mapping: MappingFile) -> dict[str, Array]:
    clock = {"t_s", *((mapping.time.column, mapping.time.fraction) if mapping.time else ())}
    return {name: x for name, x in table.columns.items() if name not in clock}


def _replace_rows(table: Table, columns: dict[str, Array], line: NDArray[np.int64]) -> Table:
    return replace(table, columns=columns, line=line)


def _unfold_branches(
    path: Path, table: Table, mapping: MappingFile
) -> tuple[dict[str, Array], NDArray[np.int64], list[str], list[ImportFinding]]:
    """Channels of all branches one after the other, line numbers, direction of each row, and findings."""
    order = _branch_rows(table, mapping)
    read = [_channels(path, table, mapping, columns) for _, columns in mapping.tables()]
    parts = [{name: x[rows] for name, x in part.items()} for (part, _), rows in zip(read, order, strict=True)]
    notes = list(dict.fromkeys(note for _, masked in read for note in masked))
    for k, (before, after) in enumerate(pairwise(parts)):
        if all(before[c][-1] == after[c][0] for c in before if c in after and c != "t_s"):
            notes += remarks(
                f"The last reading of branch {k + 1} and the first of branch {k + 2} are the same in every "
                f"channel: one reading, listed twice. Both are kept."
            )
    names = [name for name in parts[0] if all(name in part for part in parts)]
    columns = {name: np.concatenate([part[name] for part in parts]) for name in names}
    line = np.concatenate([table.line[rows] for rows in order])
    branch: list[str] = [b.direction for b, rows in zip(mapping.branch, order) for _ in rows]
    return columns, line, branch or directions(columns[mapping.input.channel]), notes


def _branch_rows(table: Table, mapping: MappingFile) -> list[NDArray[np.int64]]:
    """The rows of each branch in its order: those with a reading, if the branches share a column."""
    every = np.arange(len(table))
    if not mapping.branch:
        return [every]
    names = [{column.column for column in b.columns.values()} for b in mapping.branch]
    shared = set.intersection(*names)
    found = []
    for branch, used in zip(mapping.branch, names, strict=True):
        own = [np.isfinite(table.columns[name]) for name in used - shared] if shared else []
        rows = every[np.any(own, axis=0)] if own else every
        found.append(rows[::-1] if branch.rows == "backward" else rows)
    return found


def _channels(
    path: Path, table: Table, mapping: MappingFile, columns: dict
) -> tuple[dict[str, Array], list[ImportFinding]]:
    """The channels of a branch, and findings on readings that are masked or continued."""
    out, notes = {"t_s": table.columns["t_s"]}, list[ImportFinding]()
    for channel, column in columns.items():
        strain = channel == "position" and _is_strain(mapping)
        unit = mapping.unit_of(channel)
        values, found = channel_readings(path, table, channel, column, unit, strain=strain)
        notes += found
        if not np.isfinite(values).any():
            raise DataError(f"{path}: column {shown(column.column)} holds no number.")
        out[channel] = np.array(values, dtype=float)
    return out, notes


def _is_strain(mapping: MappingFile) -> bool:
    return mapping.output is not None and mapping.output.quantity == "strain"


def _conditions(path: Path, table: Table, mapping: MappingFile) -> tuple[dict[str, Any], list[ImportFinding]]:
    """Quantities meant to be constant, as mean, min, max; a finding if they were not."""
    out, messages = {}, []
    for name, column in mapping.conditions.items():
        if column.text:
            out[name] = {"text": column.text}
            continue
        if column.value is not None:
            out[name] = {"unit": spelled(column.unit)} | dict.fromkeys(("mean", "min", "max"), column.value)
            continue
        x, codes = without_codes(
            column.column, scaled(table, column), table.columns[column.column], table.line
        )
        messages += codes
        if not np.isfinite(x).any():
            raise DataError(f"{path}: column {shown(column.column)} holds no number.")
        mean, low, high = float(np.nanmean(x)), float(np.nanmin(x)), float(np.nanmax(x))
        out[name] = {"unit": spelled(column.unit), "mean": mean, "min": low, "max": high}
        if low == high:
            messages += remarks(
                f"{name} is exactly {low:g}{spaced(column.unit)} in every row: nominal, not measured."
            )
        elif high - low > 0.1 * abs(mean):
            text = f"{name} was not constant: {low:.4g} … {high:.4g}, mean {mean:.4g}{spaced(column.unit)}."
            messages.append(ImportFinding(text, "varying condition"))
    return out, messages


def _compare_sensors(
    path: Path, table: Table, mapping: MappingFile, columns: dict[str, Array]
) -> list[ImportFinding]:
    """Blank the channels of two sensors of one quantity that disagree; DataError if they disagree in most rows."""
    messages = list[ImportFinding]()
    for compare in mapping.compare:
        a, b = (table.columns[name] for name in compare.columns)
        apart = np.abs(a - b)
        bad = apart > compare.within
        pair = f"'{compare.columns[0]}' and '{compare.columns[1]}'"
        if bad.mean() > 0.5:
            raise DataError(
                f"{path}: columns {pair} disagree by more than {compare.within:g}{spaced(compare.unit)} in "
                f"{int(bad.sum())} of {bad.size} rows; one of the two sensors failed."
            )
        for channel in compare.blames if bad.any() else ():
            columns[channel][bad] = np.nan
        if bad.any():
            text = (
                f"Columns {pair} disagree by up to {np.nanmax(apart):.3g}{spaced(compare.unit)} in {int(bad.sum())} "
                f"rows (lines {table.line[bad].min()}–{table.line[bad].max()}), {100 * bad.mean():.2g} % of all; "
                f"{', '.join(compare.blames) or 'nothing'} is left out there."
            )
            messages.append(ImportFinding(text, "disagreeing sensors" if compare.blames else None))
        usual = float(np.median(apart[~bad]))
        if usual > 0.2 * compare.within:
            messages += remarks(
                f"In the other rows, columns {pair} still differ by {usual:.2g}{spaced(compare.unit)} (median)."
            )
    return messages


def _reading_steps(columns: dict[str, Array], branch: list[str]) -> list[tuple]:
    """One settled step per row, for readings taken one by one."""
    target, position, t_s = columns["input"], columns["position"], columns["t_s"]
    columns["step"] = np.arange(target.size, dtype=float)
    rows = []
    for k in range(target.size):
        known = np.isfinite([target[k], position[k]])
        when = float(t_s[k]) if np.isfinite(t_s[k]) else None
        rows.append(
            step_row(
                k,
                branch=branch[k],
                target=float(target[k]) if known[0] else None,
                span_s=(when, when),
                verdict="settled",
                position=float(position[k]) if known[1] else None,
                n=1,
            )
        )
    return rows


def _meta(mapping: MappingFile, columns: dict[str, Array], conditions: dict, table: Table) -> dict[str, Any]:
    meta: dict[str, Any] = {
        "protocol": mapping.name,
        "input": {"quantity": mapping.input.quantity, "unit": mapping.input.unit},
        "notes": " ".join(x for x in (mapping.summary, mapping.notes, f"Source: {mapping.source}.") if x),
    }
    if mapping.output:
        resolution = quantum(columns["position"])
        meta["output"] = {
            "quantity": mapping.output.quantity,
            "unit": mapping.output.unit,
            "per_count": resolution,
        }
        if mapping.output.zero == "own":
            meta["encoder_zero"] = OWN_ZERO
    if mapping.initial:
        meta["initial"] = mapping.initial
    if conditions:
        meta["conditions"] = conditions
    if table.header:
        meta["header"] = table.header
    return meta
