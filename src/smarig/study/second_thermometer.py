"""A second thermometer beside the input: a witness of its faults, or one at another place."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, shown
from smarig.study import quantity_words as q
from smarig.study.column_guess import ColumnGuess
from smarig.study.input_turns import wide_turns

AGREE_K = 5.0  # two thermometers whose readings differ less show one temperature
_ONE_PLACE_K = 3.0  # between two thermocouples at one place, each of class 1: within 1.5 K (IEC 60584-1)
_JUMPS = 3.0  # times the largest step of another thermometer: such a reading jumps


@dataclass(frozen=True, eq=False)
class SecondThermometer:
    """A thermometer beside that of the input. ``heating`` and ``cooling`` (K) are its usual (median) readings less
    those of the input, NaN for a direction that does not occur; ``apart`` (n,) are the rows that differ by more than
    ``AGREE_K``, ``unusual`` (n,) those among them that differ as much from what is usual in their direction, and
    ``sudden`` (n,) those among ``apart`` whose difference came or went at once.
    """

    heating: float
    cooling: float
    apart: NDArray[np.bool_]
    unusual: NDArray[np.bool_]
    sudden: NDArray[np.bool_]

    @property
    def is_witness(self) -> bool:
        """Whether it usually agrees in either direction, and most of the rows apart are no part of its usual
        difference: a fault comes at once and in a few rows, whichever way the ramp goes; an oven leads or lags on each
        ramp, and at another place the difference grows through all values between.
        """
        usual = np.array([self.heating, self.cooling])
        rows, apart, faulty = self.apart.size, int(self.apart.sum()), int((self.unusual & self.sudden).sum())
        agrees = 2 * apart < rows and not (np.abs(usual) >= AGREE_K).any()  # NaN counts as agreeing
        return agrees and 2 * faulty >= apart

    @property
    def is_at_one_place(self) -> bool:
        """Whether it usually reads, in either direction, what another thermometer at that place may read."""
        return not (np.abs([self.heating, self.cooling]) > _ONE_PLACE_K).any()  # NaN counts as agreeing

    def difference(self, drive: ColumnGuess) -> str:
        """How it differs from the input, in words."""
        ways = (("while it heats", self.heating), ("while it cools", self.cooling))
        parts = [
            f"{abs(value):.2g} K {'higher' if value > 0 else 'lower'} {when}"
            for when, value in ways
            if np.isfinite(value)
        ]
        share = 100 * np.count_nonzero(self.apart) / self.apart.size
        return (
            f"it usually reads {' and '.join(parts)} than {shown(drive.name)}, and differs by more than {AGREE_K:g} K "
            f"in {share:.2g} % of the rows: a thermometer at another place, no witness of faults"
        )


def second_thermometer(c: ColumnGuess, drive: ColumnGuess) -> SecondThermometer | None:
    """How a thermometer compares with that of the input; None for columns that are not both thermometers of one unit,
    or without common readings. A set-point is no thermometer.
    """
    if not (c.quantity == drive.quantity == q.TEMPERATURE) or c.unit != drive.unit or c.commanded:
        return None
    known = np.isfinite(c.facts.values) & np.isfinite(drive.facts.values)
    u, other = drive.facts.values[known], c.facts.values[known]
    if u.size < 2:
        return None
    rises = _rises(min(u, other, key=np.ptp))  # a fault widens the range of its thermometer
    differs = other - u
    usual = np.where(rises, _median(differs[rises]), _median(differs[~rises]))
    apart = np.abs(differs) > AGREE_K
    unusual = apart & (np.abs(differs - usual) > AGREE_K)
    usually = _median(differs[rises]), _median(differs[~rises])
    return SecondThermometer(*usually, apart, unusual, _sudden(differs, apart))


def witness_reason(c: ColumnGuess, drive: ColumnGuess) -> str:
    """What a second thermometer at one place shows, and whether the first one jumps."""
    words = f"a second thermometer, within {AGREE_K:g} K of {shown(drive.name)} in half of the rows or more"
    first, own = _largest_step(drive), _largest_step(c)
    if first <= _JUMPS * own:
        return words
    jumps = f"{shown(drive.name)} jumps by up to {first:.3g} from row to row, this one by {own:.3g}"
    return f"{words}; {jumps}: try it as the input"


def _sudden(differs: Array, apart: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The rows apart of each group in a row whose difference began or ended with a step of more than ``AGREE_K``."""
    found = np.zeros(apart.size, dtype=bool)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], apart, [False]]).astype(int)))
    steps = np.abs(np.diff(differs, prepend=differs[:1], append=differs[-1:]))
    for a, b in edges.reshape(-1, 2):
        found[a:b] = max(steps[a], steps[b]) > AGREE_K
    return found


def _rises(u: Array) -> NDArray[np.bool_]:
    """Whether each row lies on a rising branch, between turns that noise does not make."""
    rises = np.zeros(u.size, dtype=bool)
    turns = wide_turns(u)
    for a, b in zip(turns, turns[1:], strict=False):
        rises[a : b + 1] = u[b] > u[a]
    return rises


def _median(x: Array) -> float:
    return float(np.median(x)) if x.size else np.nan


def _largest_step(c: ColumnGuess) -> float:
    return float(np.abs(np.diff(c.facts.known)).max())
