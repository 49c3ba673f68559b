"""Repeats of one state of the memory: their noise, apart from a trend over the cycles and from slow changes.

Where repeats drift from cycle to cycle, their standard deviation holds the drift, and a model with an error as large
would pass for one at its noise. So a trend that is common to all states is removed, and stated. Repeats that scatter by
many times the noise within readings are stated too: something between them changed.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, chi2_tail, f_tail
from smarig.identification.verdict_thresholds import OVER_READINGS

FEWEST_CYCLES = 0.2  # between repeats of one state: a trend over less is not one over cycles
P_TREND = 1e-3  # of a trend by chance
P_HALF = 0.01  # of a trend in half of the cycles by chance
MATTERS = 1.5  # standard deviation of the repeats over that without the trend: less does not change a verdict
P_EXCESS = 0.01  # of a scatter that is larger by chance


@dataclass(frozen=True)
class Repeats:
    """Outputs (n,) ``y`` of one state of the memory, and the number of cycles (n,) before each."""

    cycles: Array
    y: Array


@dataclass(frozen=True)
class Repeatability:
    """What repeats show besides noise. ``drift`` is the mean trend per cycle, as a share of the travel, None without a
    trend. ``over_readings`` is their scatter over the noise within readings, None if it is no larger than usual.
    """

    drift: float | None = None
    over_readings: float | None = None

    @property
    def text(self) -> str:
        """A clause without a full stop, "" if the repeats agree within their noise."""
        found = []
        if self.drift is not None:
            found.append(f"repeats drift by {100 * abs(self.drift):.2g} % of the travel per cycle")
        if self.over_readings is not None:
            found.append(f"repeats differ by {self.over_readings:.2g} × the noise of a reading")
        return ", and ".join(found)

    @property
    def warning(self) -> str:
        """The same as sentences for the warnings of a result, "" if there is nothing to state."""
        if not self.text:
            return ""
        floor = "The noise floor excludes this drift. " if self.drift is not None else ""
        return f"The {self.text}. {floor}Something besides the input acts on the output; a diagnosis tests causes."

    def to_json(self) -> dict[str, float | None]:
        """Plain values."""
        return {"drift_per_cycle": self.drift, "over_readings": self.over_readings}


STEADY = Repeatability()


@dataclass(frozen=True)
class PooledRepeats:
    """Sum of ``squares`` about the means of states, less a trend, with its degrees of ``freedom``.

    ``drift`` is the mean trend per cycle in units of the output, None if there is none that matters, or none that goes
    on: the squares are without it all the same, for a change from one visit to the next is no noise of a reading.
    """

    squares: float
    freedom: int
    drift: float | None = None


def pooled_repeats(repeats: Sequence[Repeats]) -> PooledRepeats:
    """The pure error of repeats, without a common trend over the cycles if there is one that matters.

    The trend y = ȳ(state) + a c, or a c + b c², is removed if chance gives one as strong in fewer than ``P_TREND`` of
    cases (F test), and if the standard deviation without it is smaller by the factor ``MATTERS``. It is a drift if it
    goes on through the cycles: relaxation after unequal holds shifts a whole branch at one visit, and any two visits
    differ by a "trend".
    """
    if not repeats:
        return PooledRepeats(0.0, 0)
    y = _centred([r.y for r in repeats])
    plain = PooledRepeats(float(y @ y), sum(r.y.size - 1 for r in repeats))
    cycles = [r.cycles for r in repeats]
    if max(float(np.ptp(c)) for c in cycles) < FEWEST_CYCLES:
        return plain
    linear = _less_trend(y, plain, _centred(cycles))
    if not _is_stronger_than_chance(plain, linear):
        return plain
    curved = _less_trend(y, plain, _centred(cycles), _centred([c**2 for c in cycles]))
    best = curved if _is_stronger_than_chance(linear, curved) else linear
    matters = plain.squares * best.freedom >= MATTERS**2 * best.squares * plain.freedom
    drift = linear.drift if _goes_on(repeats) else None
    return PooledRepeats(best.squares, best.freedom, drift) if matters else plain


def excess_over_readings(value: float, freedom: int, readings: float | None) -> float | None:
    """A scatter of repeats over the noise within ``readings``, if it is larger than usual and no chance."""
    if not readings or value <= OVER_READINGS * readings:
        return None
    chance = chi2_tail(freedom * (value / (OVER_READINGS * readings)) ** 2, freedom)
    return value / readings if chance < P_EXCESS else None


def _goes_on(repeats: Sequence[Repeats]) -> bool:
    """Whether a trend holds over all cycles, and in each half of them by itself and in the same direction."""
    middle = float(np.mean([f([f(r.cycles) for r in repeats]) for f in (np.min, np.max)]))
    halves = [[_part(r, r.cycles <= middle) for r in repeats], [_part(r, r.cycles > middle) for r in repeats]]
    ways = [_way_of_visits(repeats, P_TREND), *(_way_of_visits(half, P_HALF) for half in halves)]
    return ways[0] != 0 and len(set(ways)) == 1


def _part(r: Repeats, rows: NDArray[np.bool_]) -> Repeats:
    return Repeats(r.cycles[rows], r.y[rows])


def _way_of_visits(repeats: Sequence[Repeats], chance: float) -> float:
    """The direction of the trend over visits, 0 without one: what acts at a visit moves all of its states, so states
    that are visited together count as one reading.
    """
    several = [r for r in repeats if r.y.size > 1]
    if not several:
        return 0.0
    at = np.concatenate([r.cycles for r in several])
    apart = float(np.median(np.concatenate([np.diff(r.cycles) for r in several])))
    visits, of = np.unique(np.round((at - at.min()) / (apart or 1.0)), return_inverse=True)
    count = np.bincount(of)
    c, y = (
        np.bincount(of, x) / count
        for x in (_centred([r.cycles for r in several]), _centred([r.y for r in several]))
    )
    plain = PooledRepeats(float(np.sum((y - y.mean()) ** 2)), visits.size - 1)
    trend = _less_trend(y - y.mean(), plain, c - c.mean())
    return float(np.sign(trend.drift or 0.0)) if _is_stronger_than_chance(plain, trend, chance) else 0.0


def _centred(states: Sequence[Array]) -> Array:
    """Values (n,) of all states, each less the mean of its state."""
    return np.concatenate([values - values.mean() for values in states])


def _less_trend(y: Array, plain: PooledRepeats, *basis: Array) -> PooledRepeats:
    """The pure error less the trend in the columns of ``basis``; ``drift`` is the weight of the first."""
    columns = np.column_stack(basis)
    weights, *_ = np.linalg.lstsq(columns, y, rcond=None)
    left = y - columns @ weights
    return PooledRepeats(float(left @ left), max(plain.freedom - len(basis), 0), float(weights[0]))


def _is_stronger_than_chance(before: PooledRepeats, after: PooledRepeats, chance: float = P_TREND) -> bool:
    """Whether one more parameter removes more of the squares than chance does."""
    if not after.freedom:
        return False
    removed = before.squares - after.squares
    if removed <= 0:
        return False
    ratio = removed * after.freedom / after.squares if after.squares else np.inf
    return f_tail(ratio, 1, after.freedom) < chance
