"""MATLAB variables as named columns: what a mapping's [mat] table says of files, matrices and loops.

A variable is a column. Where each column (or row) of equal matrices is one loop, they are stacked one after
the other and numbered from 0. Files that belong together are found side by side by their names. Knows
mappings and matrices; refuses to guess which way a matrix lies, and what a variable means.
"""

from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from smarig.core.errors import DataError, UsageError
from smarig.exchange.mapping import MappingFile, MatLayout, require_columns
from smarig.exchange.mat_file import MatFile, open_mat, size_text
from smarig.exchange.text_table import Table

Array = NDArray[np.float64]


def read_mat_table(path: Path, mapping: MappingFile, layout: MatLayout) -> Table:
    """The variables a mapping uses, each (n,) = loops one after the other, in the order of the file.

    ``line`` is a reading's number within its loop, from 1. Raises UsageError for a missing file of a set,
    ConfigError for a missing or unmapped variable, DataError for a file or variable that is no good.
    """
    files = [open_mat(file) for file in file_set(path, layout.files)]
    file_of = _files_by_variable(files)
    require_columns(mapping, list(file_of), path, "variable")
    matrices = {name: _loops(file_of[name], name, layout) for name in mapping.used()}
    for (a, x), (b, y) in pairwise(matrices.items()):
        if x.shape != y.shape:
            raise DataError(
                f"{path}: variables '{a}' and '{b}' differ in size, {size_text(file_of[a].variables[a].shape)} and "
                f"{size_text(file_of[b].variables[b].shape)}; they must hold the same readings."
            )
    loops, readings = next(iter(matrices.values())).shape
    if readings < 2:
        raise DataError(f"{path} holds {readings} reading(s) a loop; at least two are needed.")
    columns = {name: x.ravel() for name, x in matrices.items()}
    notes = [
        f"Variable '{name}': {int(np.isnan(x).sum())} of {x.size} numbers are NaN."
        for name, x in columns.items()
        if np.isnan(x).any()
    ]
    line = np.tile(np.arange(1, readings + 1), loops)
    number = np.repeat(np.arange(loops), readings) if layout.loops != "none" else None
    return Table(columns, line, {}, tuple(notes), number)


def file_set(path: Path, patterns: tuple[str, ...]) -> list[Path]:
    """All files of the set ``path`` is one of, in the order of the patterns; itself without patterns.

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
        missing = [file for file in files if not file.is_file()]
        if missing:
            raise UsageError(f"{path} belongs with {missing[0].name}, which is not beside it.")
        return files
    raise UsageError(f"The mapping reads files named {' and '.join(patterns)}; {path} is neither.")


def _files_by_variable(files: list[MatFile]) -> dict[str, MatFile]:
    """Which file each variable is in; DataError if it is in two."""
    file_of: dict[str, MatFile] = {}
    for file in files:
        for name in file.variables:
            if name in file_of:
                raise DataError(
                    f"Variable '{name}' is in {file_of[name].path} and in {file.path}; which is meant?"
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
            f"{file.path}: variable '{name}' is {size_text(matrix.shape)}, a vector was expected; if each column "
            f'is one loop, the mapping should say [mat] loops = "columns" (or "rows").'
        )
    return matrix.reshape(1, -1)
