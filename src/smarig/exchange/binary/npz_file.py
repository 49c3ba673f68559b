"""Reads the arrays of NumPy archives (.npz): vectors of one length are the columns of a table."""

import zipfile
from collections import Counter
from pathlib import Path

import numpy as np

from smarig.core import Array, DataError
from smarig.exchange.mappings.mapping import MappingFile, require_columns
from smarig.exchange.tables.found_table import FoundColumn, FoundTable
from smarig.exchange.tables.text_table import Table, missing_notes
from smarig.exchange.text.no_reading import mark_notes, without_marks

MAX_UNPACKED = 2 * 10**9  # bytes
MAX_COLUMNS = 500
_ENDING = ".npy"
_FEWEST_ROWS = 3


def is_npz(path: Path) -> bool:
    """Whether a file is a ZIP archive of arrays alone."""
    try:
        with zipfile.ZipFile(path) as parts:
            names = parts.namelist()
    except Exception:  # zipfile raises whatever a damaged directory leads to
        return False
    return bool(names) and all(name.endswith(_ENDING) for name in names)


def npz_tables(path: Path) -> list[FoundTable]:
    """The vectors of the most common length as one table; DataError if they are fewer than two."""
    columns = _columns(path)
    if len(columns) < 2:
        raise DataError(
            f"{path} holds {len(columns)} vector(s) of numbers. At least two of one length are needed."
        )
    found = tuple(FoundColumn(name, "", without_marks(values)) for name, values in columns.items())
    return [FoundTable(path, "npz", "", found, {"npz": {}}, {})]


def read_npz(path: Path, mapping: MappingFile) -> Table:
    """The vectors of an archive; ConfigError for those that the mapping does not name."""
    written = _columns(path)
    require_columns(mapping, list(written), path)
    columns = {name: without_marks(values) for name, values in written.items()}
    rows = next(iter(columns.values())).size
    marks = {
        name: Counter(f"{x:g}" for x in v[np.isnan(columns[name]) & ~np.isnan(v)])
        for name, v in written.items()
    }
    notes = [
        *mark_notes({name: found for name, found in marks.items() if found}, rows),
        *missing_notes(written),
    ]
    return Table(columns, np.arange(1, rows + 1), {}, tuple(notes))


def _columns(path: Path) -> dict[str, Array]:
    """The vectors of numbers that have the most common length; the columns of a matrix have its name and a number."""
    try:
        with zipfile.ZipFile(path) as parts:
            unpacked = sum(part.file_size for part in parts.infolist())
        if unpacked > MAX_UNPACKED:
            raise DataError(f"{path} unpacks to {unpacked / 1e6:.0f} MB. Split it.")
        with np.load(path, allow_pickle=False) as archive:
            arrays = {name: array for name in archive.files if (array := _numbers(archive, name)) is not None}
    except DataError:
        raise
    except Exception as error:  # NumPy and zipfile raise a class of their own for each kind of damage
        raise DataError(
            f"{path} is no NumPy archive, or is damaged ({type(error).__name__}). Copy it again."
        ) from None
    vectors: dict[str, Array] = {}
    for name, array in arrays.items():
        signals = np.atleast_2d(array.T if array.ndim == 2 and array.shape[0] >= array.shape[1] else array)
        several = len(signals) > 1
        vectors |= {
            f"{name}/column {k + 1}" if several else name: row for k, row in enumerate(signals[:MAX_COLUMNS])
        }
    lengths = Counter(v.size for v in vectors.values() if v.size >= _FEWEST_ROWS)
    most = max(lengths, key=lambda size: (lengths[size], size), default=0)
    return {name: v for name, v in vectors.items() if v.size == most}


def _numbers(archive: np.lib.npyio.NpzFile, name: str) -> Array | None:
    """An array of real numbers or times as floats, times in seconds; None for texts, objects and higher dimensions."""
    try:
        array = archive[name]
    except ValueError:  # objects, which only a pickle can hold
        return None
    if array.dtype.kind in "mM":
        unit = "timedelta64[ns]" if array.dtype.kind == "m" else "datetime64[ns]"
        array = array.astype(unit).astype(np.int64) / 1e9
    return array.astype(np.float64) if array.dtype.kind in "iufb" and 0 < array.ndim <= 2 else None
