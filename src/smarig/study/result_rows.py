"""Tables of results: a row for each specimen or recording, and no curve of an input that goes up and down."""

import numpy as np

from smarig.core import UsageError, shown, spaced
from smarig.report import display_unit, number
from smarig.study.column_guess import ColumnGuess
from smarig.study.table_guess import TableGuess
from smarig.study.typed_names import typed_name

_FEWEST_OF_CURVE = 10  # different inputs; fewer show no loop
_MOST_SHOWN = 3


def refuse_result_rows(guess: TableGuess) -> None:
    """Raise UsageError for a table of results, which no model of a loop describes."""
    drive = guess.first("input")
    if drive is None or not are_results(guess):
        return
    values = np.unique(drive.facts.known)
    first = ", ".join(number(v) for v in values[:_MOST_SHOWN])
    levels = f"{first}{' …' if values.size > _MOST_SHOWN else ''}{spaced(display_unit(drive.unit or ''))}"
    raise UsageError(
        f"{guess.table.path}: these {len(guess.table)} rows look like results, each of another specimen or recording: "
        f"{shown(typed_name(guess.table, drive.name))} has the same {values.size} values again and again ({levels}) "
        "and goes one way only, so there is no curve of an input that goes up and down. Study the recorded curves from "
        "which they were derived. If the rows are one record, name its columns with --input NAME --output NAME."
    )


def are_results(guess: TableGuess) -> bool:
    """Whether texts stand beside an input of a few values, each in several rows, that never goes both ways.

    A record has a clock or more values. Two sweeps of the same values may be the two branches of a loop.
    """
    drive = guess.first("input")
    labelled = any(column.kind == "text" for column in guess.table.columns)
    if drive is None or not labelled or guess.first("time") is not None:
        return False
    return _repeats_one_way(drive)


def _repeats_one_way(drive: ColumnGuess) -> bool:
    """Whether a few values come back only in further rows at the same one, or in sweeps that begin again."""
    u = drive.facts.known
    values, times = np.unique(u, return_counts=True)
    if not 2 <= values.size < _FEWEST_OF_CURVE or times.min() < 2:
        return False
    for x in (u, -u):
        back = np.flatnonzero(np.diff(x) < 0)
        if back.size != 1 and (x[back] == x.max()).all() and (x[back + 1] == x.min()).all():
            return True
    return False
