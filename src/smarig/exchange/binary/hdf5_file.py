"""Reads HDF5 files, also of MATLAB 7.3: vectors of one length in a group, and tables of several columns."""

from collections.abc import Sequence
from pathlib import Path, PurePosixPath

import numpy as np

from smarig.core import DataError, UsageError, shown
from smarig.exchange.binary.hdf5_logs import joined_logs
from smarig.exchange.binary.hdf5_process import Hdf5Group, read_groups
from smarig.exchange.binary.needed_package import check_package
from smarig.exchange.mappings.mapping import MappingFile, require_columns
from smarig.exchange.mappings.mapping_layouts import Hdf5Layout
from smarig.exchange.tables.found_table import FoundTable
from smarig.exchange.tables.text_table import Table, missing_notes


def hdf5_tables(path: Path) -> list[FoundTable]:
    """A table for each group of numeric data sets of one length, and for logs that are joined; DataError if there is
    none.
    """
    check_package("h5py", path, "an HDF5 file")
    groups = read_groups(path)
    found = []
    records = joined_logs(groups)
    logs = {log for record in records for log in record.logs}
    for record in records:
        of = next(group for group in groups if group.name == record.group)
        title, layout = record.group.strip("/"), {"hdf5": {"group": record.group, "logs": True}}
        scalars = _scalars_of(of, groups)
        found.append(FoundTable(path, "hdf5", title, record.columns, layout, of.header, scalars=scalars))
    for group in groups:
        if len(group.columns) >= 2 and group.name not in logs:
            title = group.name.strip("/") if len(groups) > 1 else ""
            layout = {"hdf5": {"group": group.name}}
            columns, scalars = tuple(group.columns), _scalars_of(group, groups)
            found.append(FoundTable(path, "hdf5", title, columns, layout, group.header, scalars=scalars))
    if not found:
        left_out = [
            f" Data set {shown(name)} {why}." for group in groups for name, why in group.left_out.items()
        ]
        raise DataError(
            f"{path} holds no group with two numeric data sets of one length.{''.join(left_out[:3])} "
            "Give a file of measured columns."
        )
    return found


def _scalars_of(group: Hdf5Group, groups: Sequence[Hdf5Group]) -> dict[str, tuple[float, str]]:
    """The single numbers that belong to a table: of its group, of those around it, and of groups without a table beside
    any of these, as entry/sample beside entry/data.
    """
    own = PurePosixPath(group.name)
    found: dict[str, tuple[float, str]] = {}
    for other in groups:
        path = PurePosixPath(other.name)
        neighbour = len(other.columns) < 2 and path.parent in own.parents
        if path == own or path in own.parents or neighbour:
            found |= other.scalars
    return found


def read_hdf5(path: Path, mapping: MappingFile, layout: Hdf5Layout) -> Table:
    """The columns of a group; ConfigError for other columns, DataError for a missing group or bad columns."""
    check_package("h5py", path, "an HDF5 file")
    if layout.logs:
        return _read_logs(path, mapping, layout)
    (group,) = read_groups(path, layout.group)
    columns = {column.name: column.values for column in group.columns}
    for name, use in mapping.used().items():
        if name in group.left_out and name not in columns:
            raise DataError(f"{path}: data set {shown(name)}, the {use}, {group.left_out[name]}.")
    require_columns(mapping, list(columns), path, "data set")
    rows = next(iter(columns.values())).size
    return Table(columns, np.arange(1, rows + 1), {}, tuple(missing_notes(columns)))


def _read_logs(path: Path, mapping: MappingFile, layout: Hdf5Layout) -> Table:
    """The logs below a group in common rows; UsageError if there are none."""
    record = next((each for each in joined_logs(read_groups(path)) if each.group == layout.group), None)
    if record is None:
        raise UsageError(f"{path} has no logs below the group {shown(layout.group)} that share times.")
    columns = {column.name: column.values for column in record.columns}
    require_columns(mapping, list(columns), path, "log")
    rows = record.columns[0].values.size
    return Table(columns, np.arange(1, rows + 1), {}, (*missing_notes(columns), *record.notes))
