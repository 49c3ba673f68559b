"""Writes a run's samples as CSV with units in the header; ``smarig import --format csv`` reads them back.

Columns that were never measured are left out.
"""

from csv import writer as csv_writer
from pathlib import Path

import numpy as np

from smarig.record import SAMPLE_COLUMNS, AnyRun

_WHOLE = ("tick", "step", "counts", "flags")
BLOCK_ROWS = 10_000  # in memory as texts


def csv(run: AnyRun, path: Path) -> None:
    """Samples only, units in the header row; for spreadsheets, pandas.read_csv and smarig import."""
    headers = _headers(run)
    with path.open("w", encoding="utf-8", newline="") as file:
        csv_writer(file, lineterminator="\n").writerow(headers.values())  # quotes a unit with a comma
        for block in run.blocks(list(headers), BLOCK_ROWS):
            cells = [_texts(header, block[name]) for name, header in headers.items()]
            file.writelines(",".join(row) + "\n" for row in zip(*cells, strict=True))


def _headers(run: AnyRun) -> dict[str, str]:
    """The header of each column that was measured, and always of tick and quality."""
    own = {
        "t_s": "time_s",
        "quality": "flags",
        "input": _headed("input", run.input_unit, ("K", "A")),
        "position": _headed("position", run.unit, ("mm", "deg")),
    }
    return {
        name: own.get(name, name) for name in SAMPLE_COLUMNS if name in ("tick", "quality") or run.has(name)
    }


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
