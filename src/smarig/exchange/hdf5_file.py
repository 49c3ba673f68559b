"""Reads data sets of HDF5 files with h5py: vectors of one length in a group, and tables of several columns."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import DataError, UsageError
from smarig.exchange.found_table import FoundColumn, FoundTable
from smarig.exchange.mapping import Hdf5Layout, MappingFile, require_columns
from smarig.exchange.needed_package import needed_package
from smarig.exchange.text_table import Table, missing_notes

MAX_VALUES = 50_000_000
MAX_GROUPS = 1000
MAX_COLUMNS = 200
_UNIT_KEYS = ("units", "unit", "Units", "Unit", "UNITS")


def hdf5_tables(path: Path) -> list[FoundTable]:
    """A table for each group of numeric data sets of one length; DataError if there is none."""
    found = []
    with _opened(path) as file:
        groups = dict(_groups(file))
        for name, group in groups.items():
            columns = _columns(path, group)
            if len(columns) >= 2:
                header = {str(key): _plain(value) for key, value in list(group.attrs.items())[:100]}
                title = name.strip("/") if len(groups) > 1 else ""
                found.append(FoundTable(path, "hdf5", title, columns, {"hdf5": {"group": name}}, header))
    if not found:
        raise DataError(
            f"{path} holds no group with two numeric data sets of one length. Give a file of measured columns."
        )
    return found


def read_hdf5(path: Path, mapping: MappingFile, layout: Hdf5Layout) -> Table:
    """The columns of a group; UsageError for a missing group, ConfigError for other columns, DataError for bad ones."""
    with _opened(path) as file:
        group = file.get(layout.group)
        if group is None or not hasattr(group, "keys"):
            raise UsageError(f"{path} has no group '{layout.group}'.")
        columns = {column.name: column.values for column in _columns(path, group)}
    require_columns(mapping, list(columns), path, "data set")
    rows = next(iter(columns.values())).size
    return Table(columns, np.arange(1, rows + 1), {}, tuple(missing_notes(columns)))


def _opened(path: Path) -> Any:
    h5py = needed_package("h5py", path, "an HDF5 file")
    try:
        return h5py.File(path, "r")
    except OSError:
        raise DataError(f"{path} is no HDF5 file, or is damaged or cut off. Copy it again.") from None


def _groups(file: Any) -> Iterator[tuple[str, Any]]:
    """All groups with their paths, the file itself first; links to other files are not followed."""
    waiting, count = [("/", file)], 0
    while waiting:
        name, group = waiting.pop(0)
        count += 1
        if count > MAX_GROUPS:
            return
        yield name, group
        for key in list(group.keys())[:MAX_GROUPS]:
            child = _member(group, key)
            if child is not None and hasattr(child, "keys"):
                waiting.append((f"{name.rstrip('/')}/{key}", child))


def _member(group: Any, key: str) -> Any:
    """A member of a group that lies in the same file and directly in it, else None."""
    if type(group.get(key, getlink=True)).__name__ != "HardLink":
        return None
    return group.get(key)


def _columns(path: Path, group: Any) -> tuple[FoundColumn, ...]:
    """The columns of the most frequent length in a group."""
    found: list[FoundColumn] = []
    for key in list(group.keys())[:MAX_COLUMNS]:
        member = _member(group, key)
        if member is None or not hasattr(member, "shape") or hasattr(member, "keys") or member.shape is None:
            continue
        if np.prod(member.shape, dtype=float) > MAX_VALUES:
            raise DataError(
                f"{path}: data set '{key}' has more than {MAX_VALUES // 10**6} million values. Split it."
            )
        if len(member.shape) in (1, 2) and 0 not in member.shape:
            found += _of_dataset(path, key, member)
    lengths = [column.values.size for column in found]
    usual = max(set(lengths), key=lambda n: (lengths.count(n), n), default=0)
    return tuple(column for column in found if column.values.size == usual and usual >= 2)


def _of_dataset(path: Path, key: str, member: Any) -> list[FoundColumn]:
    unit = next((_plain(member.attrs[k]) for k in _UNIT_KEYS if k in member.attrs), "")
    try:
        if member.dtype.names:
            data = member[()].ravel()
            fields = [
                f for f in member.dtype.names if np.issubdtype(data[f].dtype, np.number) and data[f].ndim == 1
            ]
            return [FoundColumn(f"{key}/{f}", "", _floats(data[f])) for f in fields]
        if not np.issubdtype(member.dtype, np.number) or np.issubdtype(member.dtype, np.complexfloating):
            return []
        data = member[()]
    except (OSError, TypeError, ValueError) as error:
        raise DataError(
            f"{path}: data set '{key}' cannot be read ({type(error).__name__}). Copy the file again."
        ) from None
    if data.ndim == 1:
        return [FoundColumn(key, unit, _floats(data))]
    if data.shape[1] > MAX_COLUMNS or data.shape[0] < data.shape[1]:
        data = data.T
    if data.shape[1] > MAX_COLUMNS:
        return []
    names = _column_names(member, data.shape[1])
    return [FoundColumn(f"{key}/{name}", "", _floats(data[:, k])) for k, name in enumerate(names)]


def _column_names(member: Any, columns: int) -> list[str]:
    """The names of the columns of a matrix from an attribute of that many texts, else their numbers."""
    for value in member.attrs.values():
        texts = np.atleast_1d(value)
        if texts.size == columns and texts.dtype.kind in "SUO":
            return [_plain(text) for text in texts]
    return [f"column {k + 1}" for k in range(columns)]


def _floats(values: NDArray[Any]) -> NDArray[np.float64]:
    found = np.asarray(values, dtype=np.float64).copy()
    found[np.isinf(found)] = np.nan
    return found


def _plain(value: Any) -> str:
    return value.decode("utf-8", errors="replace") if isinstance(value, bytes) else str(value)[:200]
