"""Which rows of runs an identification used, and which runs ended before their protocol did."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from smarig.identification.fod_data import FodData
from smarig.measurement import dropouts
from smarig.record import Run, counted, suspect_rows, void_rows
from smarig.replay import driven_by_input

MISSING, DROPPED, UNKNOWN = "missing values", "drop-outs", "unknown memory"
VOID, SUSPECT = "of void steps", "suspect"
THINNED, NOT_ON_CURVES, NOT_SELECTED = "thinned out", "not on first-order curves", "not selected"


@dataclass(frozen=True)
class RowsUsed:
    """``used`` of the ``given`` rows of a run (settled points, if it has steps), and the number left out by reason."""

    run: str
    given: int
    used: int
    noun: str = "rows"
    left_out: dict[str, int] = field(default_factory=dict)

    def to_json(self) -> dict[str, Any]:
        """Plain values."""
        return {"run": self.run, "given": self.given, "used": self.used, "left_out": dict(self.left_out)}

    @property
    def text(self) -> str:
        """One sentence.

        >>> RowsUsed("a", 10, 7, "rows", {"missing values": 2, "drop-outs": 1}).text
        'a: 7 of 10 rows used; left out: 2 missing values, 1 drop-outs.'
        """
        reasons = ", ".join(f"{count} {reason}" for reason, count in self.left_out.items())
        return f"{self.run}: {self.used} of {self.given} {self.noun} used{f'; left out: {reasons}' if reasons else ''}."


def without_dropouts(run: Run) -> Run:
    """The run with an unknown input where its instrument failed to answer; other runs as they are."""
    if not driven_by_input([run]):
        return run
    known = np.flatnonzero(np.isfinite(run["input"]))
    lost = known[dropouts(run["input"][known])]
    if not lost.size:
        return run
    u = run["input"].copy()
    u[lost] = np.nan
    return replace(run, columns={**run.columns, "input": u})


def rows_used(
    runs: Sequence[Run], known: Sequence[int], used: Sequence[int], rest: str
) -> tuple[RowsUsed, ...]:
    """The rows of runs as given, of which ``known`` have a known memory and ``used`` were fitted.

    ``rest`` is the reason for leaving out rows with a known memory.
    """
    found = []
    for run, k, n in zip(runs, known, used, strict=True):
        counting = counted(run)
        given, measured = len(run.settled) or len(run), _measured(run)
        lost = counting.points()[0].size - measured
        missing = (len(run.settled) or len(counting)) - measured - lost
        reasons = _not_counted(run) | {
            MISSING: missing,
            DROPPED: lost,
            UNKNOWN: measured - k,
            rest: k - n,
        }
        left_out = {reason: count for reason, count in reasons.items() if count > 0}
        noun = "settled points" if run.settled else "rows"
        found.append(RowsUsed(run.name, given, n, noun, left_out))
    return tuple(found)


def _measured(run: Run) -> int:
    """How many points a run has that count."""
    return counted(without_dropouts(run)).points()[0].size


def _not_counted(run: Run) -> dict[str, int]:
    """The samples of a run of motions that do not count, by reason."""
    if run.settled:
        return {}
    void = void_rows(run)
    return {VOID: int(void.sum()), SUSPECT: int((suspect_rows(run) & ~void).sum())}


def rows_of_runs(
    runs: Sequence[Run], data: FodData, select: str | None, points: tuple[tuple[int, ...], tuple[int, ...]]
) -> tuple[RowsUsed, ...]:
    """The rows used of each run: those of a positive measure, or those on first-order curves."""
    known, used = points
    if known:
        return rows_used(runs, known, used, THINNED)
    every = [_measured(run) for run in runs]
    on_curves = [int(np.sum(data.run == k)) for k in range(len(runs))]
    return rows_used(runs, every, on_curves, NOT_ON_CURVES if select is None else NOT_SELECTED)


def early_end_warnings(runs: Sequence[Run]) -> list[str]:
    """A sentence for each run that a trip, a fault or a request ended, with the time of its last row and the cause."""
    return [_warning(run) for run in runs if run.info.end is not None and run.early_end]


def _warning(run: Run) -> str:
    known = run["t_s"][np.isfinite(run["t_s"])]
    when = f" at {known[-1]:.1f} s" if known.size else ""
    return f"{run.name} ended early{when}: {run.early_end}. The model describes only the rows before."
