"""Writes a run's samples as CSV with units in the header; ``smarig import --format csv`` reads them back.

Columns that were never measured are left out.
"""

from collections.abc import Iterator
from csv import writer as csv_writer
from pathlib import Path

import numpy as np

from smarig.record import SAMPLE_COLUMNS, Run

_WHOLE = ("tick", "step", "counts", "flags")


def csv(run: Run, path: Path) -> None:
    """Samples only, units in the header row; for spreadsheets, pandas.read_csv and smarig import."""
    columns = dict(_named(run))
    names = list(columns)
    cells = [_texts(name, columns[name]) for name in names]
    with path.open("w", encoding="utf-8", newline="") as file:
        csv_writer(file, lineterminator="\n").writerow(names)  # quotes a unit with a comma
        file.writelines(",".join(row) + "\n" for row in zip(*cells, strict=True))


def _named(run: Run) -> Iterator[tuple[str, np.ndarray]]:
    own = {
        "t_s": "time_s",
        "quality": "flags",
        "input": _headed("input", run.input_unit, ("K", "A")),
        "position": _headed("position", run.unit, ("mm", "deg")),
    }
    for name in SAMPLE_COLUMNS:
        if name in ("tick", "quality") or run.has(name):
            yield own.get(name, name), run[name]


def _headed(name: str, unit: str, own: tuple[str, ...]) -> str:
    """The header of a column: the name for smarig's own reader, else the unit in brackets, for a mapping file.

    >>> _headed("position", "mm", ("mm", "deg")), _headed("input", "A/m", ("K", "A")), _headed("input", "", ())
    ('position_mm', 'input [A/m]', 'input')
    """
    if unit in own:
        return f"{name}_{unit}"
    return f"{name} [{one_line(unit)}]" if unit else name


def one_line(text: str) -> str:
    r"""A text that cannot start a line of its own, where a spreadsheet would take it for a formula.

    >>> one_line("mm\n=1+1")
    'mm =1+1'
    """
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())


def _texts(name: str, values: np.ndarray) -> list[str]:
    """The shortest texts that read back to the same float64; empty if unknown."""
    if name in _WHOLE:
        return ["" if v != v else str(int(v)) for v in values.tolist()]
    return ["" if v != v else repr(v) for v in values.tolist()]
