"""What the numbers of a column look like: range, step, order, repeated values."""

from dataclasses import dataclass

import numpy as np

from smarig.core import Array, root_mean_square
from smarig.exchange import FoundColumn, plausible
from smarig.measurement import dropouts

CONSTANT_SHARE = 0.1  # of the mean: a column that varies less counts as a condition
_STEP_SHARE = 0.01  # of the rms step: a column that differs less from the steps of another one holds them
_EVEN_SHARE = 0.02  # of the step: steps that differ less are equal


@dataclass(frozen=True, eq=False)
class ColumnFacts:
    """Facts about a column: ``values`` (n,), ``missing`` of them, range, ``spread`` of all but
    the outermost 2 %, and median ``step`` between different rows.

    ``rising``: no row is below the one before. ``restarts``: how often a column that rises otherwise starts again at
    its first value. ``even``: the steps are equal. ``whole``: all are whole numbers.
    ``constant``: all lie within a tenth of their mean. ``levels`` is the number of different values, ``comment`` what
    the file says of it beside name and unit.
    """

    name: str
    written_unit: str
    kind: str
    values: Array
    missing: int
    low: float
    high: float
    step: float
    spread: float
    rising: bool
    restarts: int
    even: bool
    whole: bool
    constant: bool
    levels: int
    comment: str = ""

    @property
    def span(self) -> float:
        """Highest minus lowest value."""
        return self.high - self.low

    @property
    def is_flag(self) -> bool:
        """Whether every value is 0 or 1, and both occur."""
        return self.levels == 2 and self.low == 0 and self.high == 1

    @property
    def lowest_reading(self) -> float:
        """The lowest value, drop-outs to 0 aside."""
        return float(np.min(self.known[~dropouts(self.known)]))

    @property
    def known(self) -> Array:
        """The values that are numbers."""
        return self.values[np.isfinite(self.values)]

    def looks(self) -> str:
        """What the numbers look like, in a few words."""
        if not self.known.size:
            return "no numbers"
        if self.levels == 1:
            return "one value throughout"
        if self.rising and self.span > 0:
            return "rises evenly" if self.even else "rises"
        if self.constant:
            return "varies little"
        return "whole numbers, up and down" if self.whole else "up and down"


def column_facts(column: FoundColumn) -> ColumnFacts:
    """The facts about a column. Values that are too large to be measured count as missing.

    >>> column_facts(FoundColumn("t", "s", np.arange(5.0))).looks()
    'rises evenly'
    """
    values = plausible(column.values)
    x = values[np.isfinite(values)]
    steps = np.diff(x)
    moved = np.abs(steps[steps != 0])
    step = float(np.median(moved)) if moved.size else 0.0
    mean = float(np.mean(np.abs(x))) if x.size else 0.0
    spread = np.quantile(x, 0.98) - np.quantile(x, 0.02) if x.size else 0.0
    return ColumnFacts(
        name=column.name,
        written_unit=column.unit,
        kind=column.kind,
        values=values,
        missing=values.size - x.size,
        low=float(x.min()) if x.size else np.nan,
        high=float(x.max()) if x.size else np.nan,
        step=step,
        spread=float(spread),
        rising=bool(x.size > 1 and (steps >= 0).all() and x[-1] > x[0]),
        restarts=_restarts(x, steps, step),
        even=bool(moved.size > 1 and moved.size == steps.size and np.ptp(moved) <= _EVEN_SHARE * step),
        whole=bool(x.size and (x == np.round(x)).all()),
        constant=bool(x.size and spread <= CONSTANT_SHARE * mean),
        levels=np.unique(x).size,
        comment=column.comment,
    )


def counts_rows(f: ColumnFacts) -> bool:
    """Whether a column rises by one from row to row."""
    return f.rising and f.even and f.whole and f.step == 1


def steps_of(part: ColumnFacts, whole: ColumnFacts) -> bool:
    """Whether a column that moves holds the steps of another one from row to row, but for noise.

    >>> facts = [column_facts(FoundColumn(name, "", x)) for name, x in zip("ab", np.array([[2, 3, -1], [2, 5, 4.0]]))]
    >>> steps_of(*facts)
    True
    """
    x, total = part.values, whole.values
    if x.size != total.size or x.size < 3 or part.missing or whole.missing or not part.span:
        return False
    size = root_mean_square(x)
    if abs(x[1:].sum() - (total[-1] - total[0])) > _STEP_SHARE * size * x.size:  # soon decided
        return False
    return bool(np.sqrt(np.mean((np.diff(total) - x[1:]) ** 2)) <= _STEP_SHARE * size)


def _restarts(x: Array, steps: Array, step: float) -> int:
    """How often values start again at the first one, within a step; 0 if they fall anywhere else."""
    again = x[1:][steps < 0]
    return again.size if (again <= x[:1] + step).all() else 0
