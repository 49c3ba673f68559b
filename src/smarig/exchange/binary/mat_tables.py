"""Finds the tables in MATLAB 5 files: vectors of one length, matrices whose columns or rows are loops, or one matrix
that holds the signals side by side.
"""

from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from smarig.core import DataError
from smarig.exchange.binary.mat_file import MatFile, matrix_columns, open_mat
from smarig.exchange.tables.found_table import TEXT, FoundColumn, FoundTable


def mat_tables(path: Path, others: Sequence[Path] = ()) -> list[FoundTable]:
    """The table of a file; a file of one variable is read together with another in its folder.

    ``others`` are files that may belong to it. DataError if no two variables have one size.
    """
    file = open_mat(path)
    sizes = _by_size(file)
    best = max(sizes.values(), key=len, default=[])
    if len(best) >= 2:
        columns = tuple(FoundColumn(name, "", _values(file, name)) for name in best)
        nothing = np.full(columns[0].values.size, np.nan)
        columns += tuple(FoundColumn(name, "", nothing, TEXT) for name in _others(file, best))
        return [FoundTable(path, "mat", "", columns, {"mat": _loops(file, best[0])}, {})]
    for other in [p for p in (*others, *sorted(path.parent.glob("*.mat"))[:200]) if p != path]:
        if (found := _together(file, best, other)) is not None:
            return [found]
    matrices = [name for shape, names in sizes.items() for name in names if min(shape) > 1]
    if len(matrices) == 1:
        return [_of_one_matrix(file, matrices[0])]
    raise DataError(f"{path} holds no two variables of one size. Give a file with an input and an output.")


def _of_one_matrix(file: MatFile, name: str) -> FoundTable:
    """The table of a matrix whose columns (or rows, along its longer side) are the signals."""
    columns = tuple(FoundColumn(own, "", values) for own, values in matrix_columns(file, name).items())
    return FoundTable(file.path, "mat", "", columns, {"mat": {"matrix": name}}, {})


def _others(file: MatFile, used: Sequence[str]) -> list[str]:
    """Variables that are in no table and that no used struct contains: a mapping must name them."""
    structs = {name.split("/")[0] for name in used if "/" in name}
    return [name for name in file.variables if name not in used and name not in structs and "/" not in name]


def _together(file: MatFile, names: Sequence[str], other: Path) -> FoundTable | None:
    """The table of two files with one matrix each, of one size, whose names differ at the beginning or the end."""
    pattern = _patterns(file.path.name, other.name)
    if pattern is None or not names or file.path.parent != other.parent:
        return None
    try:
        second = open_mat(other)
    except DataError:
        return None
    theirs = [n for n, v in second.variables.items() if v.shape == file.variables[names[0]].shape]
    if len(theirs) != 1 or theirs[0] in file.variables:
        return None
    columns = (
        FoundColumn(names[0], "", _values(file, names[0])),
        FoundColumn(theirs[0], "", _values(second, theirs[0])),
    )
    layout = {"mat": {"files": list(pattern), **_loops(file, names[0])}}
    return FoundTable(file.path, "mat", "", columns, layout, {}, (other,))


def _patterns(one: str, two: str) -> tuple[str, str] | None:
    """Names with '*' for the text that both have in common at the end or at the beginning.

    >>> _patterns("H_a.mat", "B_a.mat")
    ('H*', 'B*')
    """
    a, b = one.removesuffix(".mat"), two.removesuffix(".mat")
    k = 0
    while k < min(len(a), len(b)) and a[-1 - k] == b[-1 - k]:
        k += 1
    if k and a[:-k] and b[:-k]:
        return f"{a[:-k]}*", f"{b[:-k]}*"
    return None


def _by_size(file: MatFile) -> dict[tuple[int, ...], list[str]]:
    found: dict[tuple[int, ...], list[str]] = defaultdict(list)
    for name, variable in file.variables.items():
        if len(variable.shape) == 2 and min(variable.shape) >= 1 and max(variable.shape) >= 3:
            try:
                file.matrix(name)
            except DataError:  # no numbers
                continue
            found[variable.shape].append(name)
    return found


def _loops(file: MatFile, name: str) -> dict[str, str]:
    rows, columns = file.variables[name].shape
    return {} if min(rows, columns) == 1 else {"loops": "columns" if rows >= columns else "rows"}


def _values(file: MatFile, name: str) -> np.ndarray:
    """The values, loop by loop."""
    matrix = file.matrix(name)
    return (matrix.T if matrix.shape[0] >= matrix.shape[1] else matrix).ravel()
