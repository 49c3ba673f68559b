"""Finds the tables in a data file of any format that is known."""

from collections.abc import Sequence
from pathlib import Path

from smarig.core import CURVES, DataError, check_file, content_kind, opened_file
from smarig.exchange.checks.value_bounds import check_size
from smarig.exchange.importing import LARGEST_BYTES
from smarig.exchange.refused_files import check_data_file
from smarig.exchange.tables.forc_file import read_forc
from smarig.exchange.tables.found_table import FoundColumn, FoundTable

_HEAD = 4096  # bytes


def find_tables(path: Path, others: Sequence[Path] = ()) -> list[FoundTable]:
    """The tables of a file, in order. A file of reversal curves is one table without columns to choose.

    ``others`` are files given with it, of which some may belong to it. Raises UsageError for a missing file or extra,
    and DataError for a file that holds no table, or a number that is too large to be measured.
    """
    tables = _tables(path, others)
    for column in (column for table in tables for column in table.columns):
        check_size(path, column.name, column.values, marks=True)  # text tables did so with their line numbers
    return tables


def _tables(path: Path, others: Sequence[Path]) -> list[FoundTable]:
    check_file(path)
    if path.stat().st_size > LARGEST_BYTES:
        raise DataError(f"{path} is larger than {LARGEST_BYTES // 10**9} GB. Split it.")
    check_data_file(path)
    with opened_file(path) as file:
        head = file.read(_HEAD)
    if head.startswith(b"PK"):
        from smarig.exchange.binary.npz_file import is_npz, npz_tables

        if is_npz(path):
            return npz_tables(path)
        from smarig.exchange.binary.workbook_file import workbook_tables

        return workbook_tables(path)
    if head.startswith((b"\x89HDF", b"MATLAB 7.3")):
        from smarig.exchange.binary.hdf5_file import hdf5_tables

        return hdf5_tables(path)
    if head.startswith(b"PAR1"):
        from smarig.exchange.binary.parquet_file import parquet_tables

        return parquet_tables(path)
    if head.startswith(b"TDSm"):
        from smarig.exchange.binary.tdms_file import tdms_tables

        return tdms_tables(path)
    if head.startswith(b"MATLAB 5"):
        from smarig.exchange.binary.mat_tables import mat_tables

        return mat_tables(path, others)
    if content_kind(path) == CURVES:
        return [_forc(path)]
    from smarig.exchange.tables.text_dialect import text_tables

    return text_tables(path)


def _forc(path: Path) -> FoundTable:
    file = read_forc(path)
    columns = (
        FoundColumn("field", file.units[0], file.field),
        FoundColumn("moment", file.units[1], file.moment),
    )
    return FoundTable(path, "forc", "", columns, {}, file.header)
