"""Writes a run as a deflated MATLAB 5 file of structures, for MATLAB, Octave and scipy.io.loadmat.

``samples.NAME`` are columns. ``steps`` and ``events`` are structure arrays with one element each. ``units`` and
``what`` state the unit and the meaning of each column. ``about`` describes the run. The samples are one element, which
scipy compresses as a whole: the memory for it is the size of the samples.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from smarig.exchange.export_columns import (
    FLAGS,
    ExportColumn,
    event_columns,
    integers,
    label,
    sample_columns,
    step_columns,
    title,
)
from smarig.record import AnyRun


def mat(run: AnyRun, path: Path) -> None:
    """MATLAB 5 structures with units, steps and events; for MATLAB, Octave and scipy.io.loadmat."""
    from scipy.io import savemat

    tables = {"samples": sample_columns(run), "steps": step_columns(run), "events": event_columns(run)}
    content = {
        "about": _about(run),
        "samples": {c.name: _Samples(c) for c in tables["samples"]},
        "steps": _rows(tables["steps"]),
        "events": _rows(tables["events"]),
        "units": {name: _units(columns) for name, columns in tables.items()},
        "what": {name: {c.name: c.what for c in columns} for name, columns in tables.items()},
    }
    with path.open("wb") as file:  # savemat would append .mat to other names
        savemat(file, content, long_field_names=True, do_compression=True, oned_as="column")


@dataclass(frozen=True)
class _Samples:
    """A column as an array that savemat gets when it writes it, so that not all columns are in memory."""

    column: ExportColumn

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        """Doubles with NaN if unknown, as in MATLAB; marks of samples as integers, for bitand."""
        del dtype, copy  # savemat asks for neither
        values = self.column.values
        return integers(values, 0).astype(np.int32) if self.column.name == "quality" else values


def _units(columns: Sequence[ExportColumn]) -> dict[str, str]:
    """Units of the numeric columns; "1" for numbers without a unit."""
    return {c.name: c.unit or "1" for c in columns if not c.text}


def _rows(columns: Sequence[ExportColumn]) -> np.ndarray:
    """A structure array (k, 1); ``void`` is logical."""
    rows = np.empty((columns[0].values.size, 1), dtype=[(c.name, object) for c in columns])
    for column in columns:
        values: list[Any] = column.values.tolist()
        rows[column.name][:, 0] = [bool(v) for v in values] if column.name == "void" else values
    return rows


def _about(run: AnyRun) -> dict[str, Any]:
    texts = {
        key: str(getattr(run.info, key) or "") for key in ("protocol", "rig", "wire", "actuator", "notes")
    }
    return texts | {
        "title": title(run),
        "source": label(run),
        "twin": run.twin,
        "complete": run.complete,
        "ended": run.cause,
        "quality_bits": {word: bit for bit, word in FLAGS.items()},
        "run_json": json.dumps(run.meta, ensure_ascii=False),
    }
