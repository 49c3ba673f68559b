"""Reads the variables of a MATLAB 5 file, the numeric ones as matrices.

It reads the files of ``save -v6`` and ``-v7``: a header of 128 bytes, then one element per variable, deflated or
not (MathWorks, "MAT-File Format", Level 5). Every size is checked against the available bytes, and no file expands
beyond ``MAX_BYTES`` in memory. Other versions, texts, cells, structures, objects and complex numbers are errors.

SciPy's reader ended the process on single changed bytes of a small file; tests compare both on sound files.
"""

import math
import struct
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from smarig.core import Array, ConfigError, DataError, UsageError, check_file, file_bytes, shown
from smarig.exchange.binary.mat_elements import MATRIX, NUMERIC, Variable, element, size_of, variable_of
from smarig.exchange.binary.mat_structs import struct_fields
from smarig.exchange.mappings.mapping import MappingFile, require_columns
from smarig.exchange.mappings.mapping_layouts import MatLayout
from smarig.exchange.tables.text_table import MAX_COLUMNS, Table

MAX_BYTES = 300_000_000  # inflating needs up to twice as much
_HEADER_BYTES = 128
_ORDER = {b"IM": "<", b"MI": ">"}
_COMPRESSED = 15  # kind of an element
_NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
_DAMAGE = (struct.error, zlib.error, ValueError, KeyError)  # raised by damaged bytes


@dataclass(frozen=True)
class MatFile:
    """A MATLAB 5 file's variables by name."""

    path: Path
    variables: dict[str, Variable]

    def matrix(self, name: str) -> Array:
        """A variable (m, n) of real numbers, with NaN; DataError for anything else."""
        variable = self.variables[name]
        where = f"{self.path}: variable {shown(name)}"
        if variable.kind not in NUMERIC.values():
            raise DataError(f"{where} is of MATLAB class {variable.kind}; a matrix of numbers was expected.")
        if len(variable.shape) != 2 or 0 in variable.shape:
            size = size_text(variable.shape)
            raise DataError(f"{where} is {size}; a matrix with rows and columns was expected.")
        if 8 * math.prod(variable.shape) > MAX_BYTES:
            raise _too_large(self.path)
        try:
            values = _values(variable)
        except _DAMAGE:
            raise _damaged(self.path) from None
        if np.isinf(values).any():
            row, column = (int(k) + 1 for k in np.argwhere(np.isinf(values))[0])
            raise DataError(f"{where} is infinite in row {row}, column {column}.")
        return values


def open_mat(path: Path) -> MatFile:
    """The variables of a file; UsageError if it does not exist, DataError if it is not a valid MATLAB 5 file."""
    data = _bytes(path)
    variables: dict[str, Variable] = {}
    try:
        order = _ORDER[data[_HEADER_BYTES - 2 : _HEADER_BYTES]]
        for payload in _inflated(path, data, order):
            name, variable = variable_of(payload, order)
            if name in variables:
                raise DataError(
                    f"{path} holds the variable {shown(name)} more than once. Save the file again."
                )
            if name:  # variables without a name belong to MATLAB itself
                variables[name] = variable
                variables |= struct_fields(name, variable)
    except _DAMAGE:
        raise _damaged(path) from None
    if not variables:
        raise DataError(f"{path} is a MATLAB file without any variable.")
    return MatFile(path, variables)


def size_text(shape: tuple[int, ...]) -> str:
    """The size of a matrix as text.

    >>> size_text((129, 4))
    '129 × 4'
    """
    return " × ".join(map(str, shape))


def _bytes(path: Path) -> bytes:
    check_file(path)
    try:
        if path.stat().st_size > MAX_BYTES:
            raise _too_large(path)
        data = file_bytes(path)
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror or error}.") from None
    if data.startswith(b"MATLAB 7.3") or b"\x89HDF\r\n\x1a\n" in data[:1024]:
        raise DataError(
            f"{path} is a MATLAB 7.3 (HDF5) file, which smarig does not read. "
            f"Save it in MATLAB with save(…, '-v7'), in Octave with save -v7."
        )
    if not data.startswith(b"MATLAB 5.0"):
        raise DataError(f"{path} is not a MATLAB 5 file (as written by save -v6 or -v7).")
    return data


def _inflated(path: Path, data: bytes, order: str) -> Iterator[memoryview]:
    """The elements of the variables, inflated if they are deflated, each without its tag."""
    rest, room = memoryview(data)[_HEADER_BYTES:], MAX_BYTES
    while rest:
        kind, payload, after = element(rest, order)
        if kind == _COMPRESSED:
            inflate = zlib.decompressobj()
            packed = inflate.decompress(payload, room)
            if len(packed) == room:
                raise _too_large(path)
            room -= len(packed)
            kind, payload, _ = element(memoryview(packed), order)
            if not inflate.eof:
                raise ValueError("cut off")
            after = rest[8 + size_of(rest, order) :]  # deflated elements are not padded
        if kind != MATRIX:
            raise ValueError("not a variable")
        yield payload
        rest = after


def _values(variable: Variable) -> Array:
    """The numbers, column by column in the file; MATLAB stores integers in the smallest type that fits."""
    kind, payload, _ = element(variable.elements, variable.order)
    numbers = np.frombuffer(payload, dtype=variable.order + _NUMBERS[kind])
    return numbers.astype(np.float64).reshape(variable.shape, order="F")


def _too_large(path: Path) -> DataError:
    return DataError(
        f"{path} holds more than {MAX_BYTES / 1e6:.0f} MB of numbers. Split it into smaller files."
    )


def _damaged(path: Path) -> DataError:
    return DataError(f"{path} is damaged or cut off: its MATLAB variables cannot be read. Copy it again.")


def read_mat_table(path: Path, mapping: MappingFile, layout: MatLayout) -> Table:
    """The variables of a mapping, each (n,) = loops one after the other, in the order of the file.

    ``line`` is the number of a reading within its loop, from 1. Raises UsageError for a missing file of a set,
    ConfigError for a missing or unmapped variable, DataError for an invalid file or variable.
    """
    if layout.matrix:
        return _matrix_table(path, mapping, layout.matrix)
    files = [open_mat(file) for file in file_set(path, layout.files)]
    file_of = _files_by_variable(files)
    require_columns(mapping, _to_be_mapped(list(file_of), list(mapping.used())), path, "variable")
    matrices = {name: _loops(file_of[name], name, layout) for name in mapping.used()}
    for (a, x), (b, y) in pairwise(matrices.items()):
        if x.shape != y.shape:
            raise DataError(
                f"{path}: variables {shown(a)} and {shown(b)} differ in size, "
                f"{size_text(file_of[a].variables[a].shape)} and {size_text(file_of[b].variables[b].shape)}; they must "
                "hold the same readings."
            )
    loops, readings = next(iter(matrices.values())).shape
    if readings < 2:
        raise DataError(f"{path} holds {readings} reading(s) per loop. At least two are needed.")
    columns = {name: x.ravel() for name, x in matrices.items()}
    line = np.tile(np.arange(1, readings + 1), loops)
    number = np.repeat(np.arange(loops), readings) if layout.loops != "none" else None
    return Table(columns, line, {}, _missing_notes(columns), number)


def _missing_notes(columns: dict[str, Array]) -> tuple[str, ...]:
    return tuple(
        f"Variable {shown(name)}: {int(np.isnan(x).sum())} of {x.size} numbers are NaN."
        for name, x in columns.items()
        if np.isnan(x).any()
    )


def matrix_columns(file: MatFile, name: str) -> dict[str, Array]:
    """The signals of a matrix (m, n), each along its longer side, and the vectors of their length under their names."""
    matrix = file.matrix(name)
    signals = matrix.T if matrix.shape[0] >= matrix.shape[1] else matrix
    if len(signals) > MAX_COLUMNS:
        raise DataError(
            f"{file.path}: variable {shown(name)} is {size_text(matrix.shape)}; a table has at most "
            f"{MAX_COLUMNS} columns."
        )
    columns = {f"column {k + 1}": signal for k, signal in enumerate(signals)}
    for other, variable in file.variables.items():
        if sorted(variable.shape) == [1, signals.shape[1]] and variable.kind in NUMERIC.values():
            columns[other] = file.matrix(other).ravel()
    return columns


def _matrix_table(path: Path, mapping: MappingFile, name: str) -> Table:
    file = open_mat(path)
    if name not in file.variables:
        raise ConfigError(
            f"{path} has no variable {shown(name)}, the matrix of mapping {mapping.name}. "
            f"The file has: {', '.join(file.variables)}."
        )
    columns = matrix_columns(file, name)
    require_columns(mapping, list(columns), path)
    rows = next(iter(columns.values())).size
    return Table(columns, np.arange(1, rows + 1), {}, _missing_notes(columns))


def file_set(path: Path, patterns: tuple[str, ...]) -> list[Path]:
    """All files of the set of ``path``, in the order of the patterns; only the file itself without patterns.

    >>> [p.name for p in file_set(Path("H_x.mat"), ())]
    ['H_x.mat']
    """
    if not patterns:
        return [path]
    for pattern in patterns:
        before, after = pattern.split("*")
        common = path.name.removeprefix(before).removesuffix(after)
        if path.name != f"{before}{common}{after}":
            continue
        files = [path.with_name(p.replace("*", common)) for p in patterns]
        missing = [file for file in files if not file.exists()]
        if missing:
            raise UsageError(
                f"{path} must be read together with {missing[0].name}, which is not in the same folder."
            )
        for file in files:
            check_file(file)
        return files
    raise UsageError(f"The mapping reads files named {' and '.join(patterns)}; {path} is none of them.")


def _to_be_mapped(names: Sequence[str], used: Sequence[str]) -> list[str]:
    """The variables that a mapping must name: fields of structs only where it uses them, and then not the structs.

    >>> _to_be_mapped(["data", "data/t", "data/fs", "x"], ["data/t"])
    ['data/t', 'x']
    """
    structs = {name.split("/")[0] for name in used if "/" in name}
    return [name for name in names if name in used or ("/" not in name and name not in structs)]


def _files_by_variable(files: list[MatFile]) -> dict[str, MatFile]:
    """The file of each variable; DataError if a variable is in two files."""
    file_of: dict[str, MatFile] = {}
    for file in files:
        for name in file.variables:
            if name in file_of:
                raise DataError(
                    f"Variable {shown(name)} is in {file_of[name].path} and in {file.path}. Keep one of them."
                )
            file_of[name] = file
    return file_of


def _loops(file: MatFile, name: str, layout: MatLayout) -> Array:
    """A variable as (loops, readings)."""
    matrix = file.matrix(name)
    if layout.loops == "columns":
        return matrix.T
    if layout.loops == "rows":
        return matrix
    if 1 not in matrix.shape:
        raise DataError(
            f"{file.path}: variable {shown(name)} is {size_text(matrix.shape)}, a vector was expected. If each column "
            f'is one loop, set [mat] loops = "columns" (or "rows") in the mapping.'
        )
    return matrix.reshape(1, -1)
