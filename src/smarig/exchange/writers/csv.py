"""A run's samples as CSV with units in the header; reads back through ``smarig import --format csv``."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from smarig.record import Run
from smarig.record.schema import SAMPLE_COLUMNS

_WHOLE = ("tick", "step", "counts", "flags")


def csv(run: Run, path: Path) -> None:
    """Comma-separated samples, header row with units; columns that were never measured are left out."""
    columns = dict(_named(run))
    names = list(columns)
    cells = [_texts(name, columns[name]) for name in names]
    with path.open("w", encoding="utf-8", newline="") as file:
        file.write(",".join(names) + "\n")
        file.writelines(",".join(row) + "\n" for row in zip(*cells, strict=True))


def _named(run: Run) -> Iterator[tuple[str, np.ndarray]]:
    own = {
        "t_s": "time_s",
        "quality": "flags",
        "input": f"input_{run.input_unit}" if run.input_unit in ("K", "A") else "input",
        "position": f"position_{run.unit}" if run.unit in ("mm", "deg") else "position",
    }
    for name in SAMPLE_COLUMNS:
        if name in ("tick", "quality") or run.has(name):
            yield own.get(name, name), run[name]


def _texts(name: str, values: np.ndarray) -> list[str]:
    """Shortest texts that read back to the same float64; empty where unknown."""
    if name in _WHOLE:
        return ["" if v != v else str(int(v)) for v in values.tolist()]
    return ["" if v != v else repr(v) for v in values.tolist()]
