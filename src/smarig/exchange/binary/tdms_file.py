"""Reads groups of LabVIEW TDMS files with npTDMS: the channels, their units, and their common clock."""

import logging
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from smarig.core import Array, DataError, UsageError, shown
from smarig.exchange.binary.needed_package import needed_package
from smarig.exchange.layouts.joined_clocks import joined_clocks
from smarig.exchange.mappings.mapping import MappingFile, require_columns
from smarig.exchange.mappings.mapping_layouts import TdmsLayout
from smarig.exchange.tables.found_table import FoundColumn, FoundTable
from smarig.exchange.tables.text_table import Table, missing_notes

MAX_VALUES = 50_000_000  # of all channels
MAX_GROUPS = 1000
CLOCK = "time"  # name of the column of the clock that a group's channels share
_LABEL_KEYS = ("NI_ChannelName", "description")
_UNIT_KEYS = ("unit_string", "NI_UnitDescription", "unit", "Unit")


def tdms_tables(path: Path) -> list[FoundTable]:
    """A table for each group of two numeric channels or more of one length; DataError if there is none."""
    with _opened(path) as file:
        groups = [(group, _rows(path, group).columns) for group in file.groups()[:MAX_GROUPS]]
        headers = {group.name: _texts(file.properties) | _texts(group.properties) for group, _ in groups}
    tables = {group.name: columns for group, columns in groups if len(columns) >= 2}
    if not tables:
        raise DataError(
            f"{path} holds no group with two numeric channels of one length. Give a file of measured columns."
        )
    return [
        FoundTable(
            path, "tdms", name if len(tables) > 1 else "", columns, {"tdms": {"group": name}}, headers[name]
        )
        for name, columns in tables.items()
    ]


def _texts(properties: Mapping[str, Any]) -> dict[str, str]:
    return {str(key): str(value) for key, value in properties.items()}


def read_tdms(path: Path, mapping: MappingFile, layout: TdmsLayout) -> Table:
    """The channels of a group; UsageError for a missing group, ConfigError for channels that the mapping does not
    name.
    """
    with _opened(path) as file:
        groups = {group.name: group for group in file.groups()}
        if layout.group not in groups:
            raise UsageError(
                f"{path} has no group {shown(layout.group)}. Its groups are: {', '.join(groups)}."
            )
        found = _rows(path, groups[layout.group])
        columns = {column.name: column.values for column in found.columns}
    require_columns(mapping, list(columns), path, "channel")
    rows = next(iter(columns.values())).size
    return Table(columns, np.arange(1, rows + 1), {}, found.notes)


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """The file, whose values are read when they are asked for; DataError for a damaged or a very large one."""
    package = needed_package("nptdms", path, "a LabVIEW TDMS file")
    package.log.log_manager.set_level(logging.CRITICAL)  # it prints bytes of damaged files
    try:
        with path.open("rb") as opened, _with_metadata(package, path, opened) as file:
            values = sum(len(channel) for group in file.groups() for channel in group.channels())
            if values > MAX_VALUES:
                raise DataError(f"{path} holds {values} values, more than {MAX_VALUES}. Split it.")
            yield file
    except (DataError, UsageError, MemoryError):
        raise
    except Exception as error:  # npTDMS raises whatever damaged bytes lead to
        raise _damaged(path, type(error).__name__) from None


def _with_metadata(package: Any, path: Path, opened: BinaryIO) -> Any:
    """The file before its values are read. A length in damaged bytes asks for any amount of memory."""
    try:
        return package.TdmsFile.open(opened)
    except MemoryError:
        raise _damaged(path, "an impossible length") from None


def _damaged(path: Path, why: str) -> DataError:
    return DataError(f"{path} is no TDMS file, or is damaged ({why}). Copy it again.")


@dataclass(frozen=True, eq=False)
class _Rows:
    """The columns of a group in common rows, and what was done to bring them there."""

    columns: tuple[FoundColumn, ...]
    notes: tuple[str, ...]


def _rows(path: Path, group: Any) -> _Rows:
    """The clock and the numeric channels of a group. Channels whose waveforms have other clocks are joined on time;
    without a clock, only those of the most frequent length have common rows.
    """
    numeric = [channel for channel in group.channels() if channel.dtype.kind in "iufbM" and len(channel) >= 2]
    lengths = [len(channel) for channel in numeric]
    usual = max(set(lengths), key=lambda n: (lengths.count(n), n), default=0)
    named = CLOCK in [channel.name for channel in numeric]
    clocked = [] if named else [channel for channel in numeric if channel.properties.get("wf_increment")]
    if not clocked or any(len(channel) == usual and channel not in clocked for channel in numeric):
        columns = tuple(_column(path, channel) for channel in numeric if len(channel) == usual)
        return _Rows(columns, (*_gaps(columns), *_left_out([c for c in numeric if len(c) != usual])))
    clocks = _clocks(clocked)
    joined = joined_clocks(clocks)
    read = [_column(path, channel) for channel in clocked]
    columns = [FoundColumn(CLOCK, "s", clocks[joined.base])]
    for k, column in enumerate(read):
        columns.append(replace(column, values=joined.in_rows(k, column.values)))
    several = any(not np.array_equal(clock, clocks[0]) for clock in clocks)
    done = (joined.sentence(read[joined.base].name),) if several else ()
    left = [channel for channel in numeric if channel not in clocked]
    return _Rows(tuple(columns), (*_gaps(read), *done, *_left_out(left)))


def _gaps(columns: Sequence[FoundColumn]) -> list[str]:
    """Findings on channels one by one: their lengths may differ."""
    return [note for column in columns for note in missing_notes({column.name: column.values})]


def _left_out(channels: Sequence[Any]) -> list[str]:
    """A sentence on the channels that share neither a clock nor a number of readings with the others."""
    if not channels:
        return []
    names = ", ".join(shown(channel.name) for channel in channels)
    return [f"Left out, as their readings belong to no row of the others: {names}."]


def _clocks(channels: Sequence[Any]) -> list[Array]:
    """The times of the readings of each channel, in seconds from the earliest start, if all starts are written."""
    starts = [channel.properties.get("wf_start_time") for channel in channels]
    known = all(isinstance(start, np.datetime64) for start in starts)
    begin = [float((start - min(starts)) / np.timedelta64(1, "s")) if known else 0.0 for start in starts]
    return [
        start
        + float(channel.properties.get("wf_start_offset", 0.0))
        + float(channel.properties["wf_increment"]) * np.arange(len(channel), dtype=np.float64)
        for start, channel in zip(begin, channels)
    ]


def _column(path: Path, channel: Any) -> FoundColumn:
    """A channel with its unit and the name that people gave it, where the name is that of a terminal."""
    unit, values = _read(path, channel)
    label = next((str(channel.properties[k]) for k in _LABEL_KEYS if channel.properties.get(k)), "")
    return FoundColumn(channel.name, unit, values, comment="" if label == channel.name else label)


def _read(path: Path, channel: Any) -> tuple[str, Array]:
    """The unit of a channel, and its values; those of times are seconds from the first."""
    values = channel[:]
    if values.dtype.kind == "M":
        return "s", (values - values[0]) / np.timedelta64(1, "s")
    numbers = np.array(values, dtype=np.float64)
    if numbers.ndim != 1:
        raise DataError(f"{path}: channel {shown(channel.name)} holds no plain numbers.")
    numbers[np.isinf(numbers)] = np.nan
    return next((str(channel.properties[k]) for k in _UNIT_KEYS if channel.properties.get(k)), ""), numbers
