"""The result of every reader: columns of a run, its steps, its description, and the findings."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.record import ImportFinding


@dataclass(frozen=True)
class RunDraft:
    """A run to be written: ``columns`` (n,) each under names of SAMPLE_COLUMNS, NaN where unknown;
    ``steps`` in STEP_COLUMNS order; ``findings`` on the file. ``began_s``: when the record began of which it is a part.
    """

    columns: dict[str, Array]
    meta: dict[str, Any]
    steps: tuple[tuple, ...] = ()
    findings: tuple[ImportFinding, ...] = ()
    began_s: float | None = None

    def __len__(self) -> int:
        return next(iter(self.columns.values())).size

    @property
    def warnings(self) -> tuple[str, ...]:
        """The findings, one or two sentences each."""
        return tuple(f.text for f in self.findings)

    def sql_columns(self) -> dict[str, Array | NDArray[np.int64]]:
        """The columns as the run file stores them: a running tick, and a mark on every sample."""
        marks = self.columns.get("quality", np.zeros(len(self)))
        return {**self.columns, "tick": np.arange(len(self)), "quality": np.nan_to_num(marks)}


def step_row(
    index: int,
    *,
    branch: str,
    target: float | None,
    span_s: Sequence[float | None],
    verdict: str,
    position: float | None,
    n: int,
) -> tuple:
    """One row of the step table, in its order; attempt 0, not void."""
    return (index, 0, 0, branch, target, span_s[0], span_s[1], verdict, position, n)


def directions(values: Sequence[float] | Array) -> list[str]:
    """'up' or 'down' for each value relative to the previous one; the first is as the second.

    >>> directions([0.0, 0.5, 0.5, 0.2])
    ['up', 'up', 'up', 'down']
    """
    out: list[str] = []
    for before, now in pairwise(values):
        changed = now > before or now < before  # also False next to a NaN
        out.append(("up" if now > before else "down") if changed else (out[-1] if out else ""))
    return [out[0] if out else "", *out]
