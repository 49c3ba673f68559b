"""A charge that a current of the same table was summed to, beside which an input of the instrument was measured."""

import re
from collections.abc import Sequence

import numpy as np

from smarig.core import correlation
from smarig.exchange import FoundTable
from smarig.study import quantity_words as q
from smarig.study.column_guess import ColumnGuess

_SAME = 0.9  # least correlation of the steps of a charge with the current that it is the integral of
_TERMINAL = re.compile(  # where a sensor is connected
    r"analog|\baux|\bext\b|\bextern|\badc|\ba[id] ?\d|\binput ?\d|\bin ?\d|\bch(annel)? ?\d|kanal|eingang|entr[ée]e",
    re.IGNORECASE,
)


def is_integral_of_current(charge: ColumnGuess, columns: Sequence[ColumnGuess]) -> bool:
    """Whether a charge is no reading: its steps from row to row follow a current that was measured beside it."""
    return any(_steps_follow(charge, c) for c in columns if c.quantity == q.CURRENT and not c.commanded)


def of_terminal(c: ColumnGuess) -> bool:
    """Whether a voltage is named by the terminal at which it was read, as that of a sensor is."""
    return c.quantity == q.VOLTAGE and _TERMINAL.search(_plain(c.label)) is not None


def line_that_names(c: ColumnGuess, table: FoundTable) -> str:
    """The line before a table that says of a column that it is a motion; "" if none does."""
    texts = [text for text in table.header.values() if f" {_plain(c.label)} " in f" {_plain(text)} "]
    motions = (q.DISPLACEMENT, q.STRAIN, q.ANGLE, q.FORCE)
    return next((text for text in texts if q.quantity_of_name(text)[0] in motions), "")


def _steps_follow(charge: ColumnGuess, current: ColumnGuess) -> bool:
    total, flow = charge.facts.values, current.facts.values
    known = np.isfinite(np.diff(total)) & np.isfinite(flow[1:])
    return int(known.sum()) > 2 and correlation(np.diff(total)[known], flow[1:][known]) >= _SAME


def _plain(text: str) -> str:
    return re.sub(r"[_\W]+", " ", text).strip().lower()
