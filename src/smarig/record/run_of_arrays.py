"""A run in memory of rows that were measured elsewhere."""

from pathlib import Path

import numpy as np

from smarig.core import Array
from smarig.record.run import Run
from smarig.record.schema import SAMPLE_COLUMNS


def run_of_arrays(u: Array, y: Array, t_s: Array | None = None, unit: str = "") -> Run:
    """A run with inputs (n,) and outputs (n,), and their times if these are known; it has no file."""
    columns = {name: np.full(u.size, np.nan) for name in SAMPLE_COLUMNS}
    columns |= {"tick": np.arange(u.size, dtype=float), "input": u, "position": y}
    columns["quality"] = np.zeros(u.size)
    if t_s is not None:
        columns["t_s"] = t_s
    meta = {
        "source": "import",
        "input": {"quantity": "input", "unit": "", "from": "measured"},
        "output": {"quantity": "output", "unit": unit},
        "end": {"cause": "done"},
    }
    return Run(Path("arrays"), meta, columns, (), ())
