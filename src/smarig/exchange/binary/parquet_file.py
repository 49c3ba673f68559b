"""Reads columns of Parquet files with pyarrow."""

from pathlib import Path
from typing import Any

import numpy as np

from smarig.core import Array, DataError
from smarig.exchange.binary.needed_package import needed_package
from smarig.exchange.mappings.mapping import MappingFile, require_columns
from smarig.exchange.tables.found_table import FoundColumn, FoundTable
from smarig.exchange.tables.text_table import Table, missing_notes

MAX_ROWS = 20_000_000
MAX_COLUMNS = 500
_UNIT_KEYS = (b"unit", b"units", b"Unit")


def parquet_tables(path: Path) -> list[FoundTable]:
    """The numeric columns and times of a Parquet file as one table; DataError if it holds fewer than two."""
    columns = _columns(path)
    if len(columns) < 2:
        raise DataError(f"{path} holds {len(columns)} numeric column(s). At least two are needed.")
    return [FoundTable(path, "parquet", "", columns, {"parquet": {}}, {})]


def read_parquet(path: Path, mapping: MappingFile) -> Table:
    """The columns of a Parquet file; ConfigError for columns that the mapping does not name."""
    columns = {column.name: column.values for column in _columns(path)}
    require_columns(mapping, list(columns), path)
    rows = next(iter(columns.values())).size
    if rows < 2:
        raise DataError(f"{path} holds {rows} sample(s). At least two are needed.")
    return Table(columns, np.arange(1, rows + 1), {}, tuple(missing_notes(columns)))


def _columns(path: Path) -> tuple[FoundColumn, ...]:
    parquet = needed_package("pyarrow.parquet", path, "a Parquet file")
    try:
        file = parquet.ParquetFile(path)
        if file.metadata.num_rows > MAX_ROWS or file.metadata.num_columns > MAX_COLUMNS:
            raise DataError(
                f"{path} has {file.metadata.num_rows} rows of {file.metadata.num_columns} columns, more than "
                f"{MAX_ROWS} of {MAX_COLUMNS}. Split it."
            )
        table = file.read()
        return tuple(column for field in table.schema for column in _of_field(table, field))
    except DataError:
        raise
    except Exception as error:  # pyarrow has a class of its own for each kind of damage
        raise DataError(
            f"{path} is no Parquet file, or is damaged ({type(error).__name__}). Copy it again."
        ) from None


def _of_field(table: Any, field: Any) -> list[FoundColumn]:
    from pyarrow import types

    values, unit = table.column(field.name), _unit(field)
    if types.is_timestamp(field.type) or types.is_duration(field.type) or types.is_time64(field.type):
        numbers = values.cast("int64").to_numpy().astype(np.float64)
        scale = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}[field.type.unit]
        return [FoundColumn(field.name, "s", (numbers - numbers[0]) * scale if numbers.size else numbers)]
    if not (types.is_integer(field.type) or types.is_floating(field.type) or types.is_boolean(field.type)):
        return []
    numbers: Array = np.array(values.to_numpy(), dtype=np.float64)
    numbers[np.isinf(numbers)] = np.nan
    return [FoundColumn(field.name, unit, numbers)]


def _unit(field: Any) -> str:
    entries = field.metadata or {}
    return next((entries[key].decode("utf-8", "replace") for key in _UNIT_KEYS if key in entries), "")
