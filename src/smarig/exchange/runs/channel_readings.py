"""The readings of one channel of a run, from a column of a table: in the unit of the run, NaN where there is none."""

from dataclasses import replace
from pathlib import Path

from smarig.core import Array
from smarig.exchange.checks.dropped_readings import without_dropped
from smarig.exchange.checks.thermometer_codes import without_thermometer_codes
from smarig.exchange.checks.value_bounds import possible, without_codes
from smarig.exchange.checks.wrapped_counts import continued_counts, wrap_findings
from smarig.exchange.mappings.mapping import Column, Condition
from smarig.exchange.tables.text_table import Table
from smarig.exchange.units.unit_conversion import convert, dimension
from smarig.record import ImportFinding

_POSITION, _COUNTS = "position", "raw counts"


def channel_readings(
    path: Path, table: Table, channel: str, column: Column, unit: str, *, strain: bool
) -> tuple[Array, list[ImportFinding]]:
    """The readings (n,) of a channel in ``unit``, and findings on those that are masked or continued."""
    wrapped: list[ImportFinding] = []
    if channel == _POSITION and dimension(column.unit) == _COUNTS:
        counts = table.columns[column.column]
        counted = continued_counts(counts)
        wrapped = wrap_findings(column.column, counts, counted, table.line)
        table = replace(table, columns={**table.columns, column.column: counted})
    written = table.columns[column.column]
    values = convert(scaled(table, column), column.unit, unit)
    values, masked = possible(path, channel, column.column, values, table.line, unit if strain else "")
    values, codes = without_codes(column.column, values, written, table.line)
    values, dropped = without_dropped(column.column, column.unit, values, written, table.line)
    values, absent = without_thermometer_codes(column.column, unit, values, table.line)
    return values, [*wrapped, *masked, *codes, *dropped, *absent]


def scaled(table: Table, column: Column | Condition) -> Array:
    """The values (n,) of a column with the factor and the offset of the mapping."""
    return column.scale * table.columns[column.column] + column.offset
