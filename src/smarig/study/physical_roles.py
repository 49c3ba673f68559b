"""Which of two columns without a name is the input: what the loop itself says.

Two facts of a hysteresis loop that is swept by its input: the output lags, so each branch lies on the side of the one
before it; and the input is swept evenly, while the output stays near its ends. Exchanged columns show the opposite. A
thermometer that lags reverses the first, and a damped sine weakens the second.
"""

from dataclasses import dataclass

import numpy as np

from smarig.core import Array
from smarig.measurement import dropouts
from smarig.study.input_turns import wide_turns

_WIDE = 0.5  # of the range: branches that form a loop
_LAGS = 0.3  # agreement with a lag, of at most 1
_NARROW = 0.02  # of the range: a loop that noise or rounding would make
_EVENER = 0.15  # difference of the relative entropies
_BINS, _GRID, _MOST = 20, 101, 20_000


@dataclass(frozen=True)
class RoleVote:
    """The votes for the first column as the input (+1 each) and against it (−1 each), with their reasons."""

    score: int
    reasons: tuple[str, ...]


def role_vote(first: Array, second: Array) -> RoleVote:
    """What the loop of two columns (n,) says.

    >>> u = 50 - 40 * np.cos(np.linspace(0, 4 * np.pi, 400))
    >>> late = np.tanh((np.roll(u, 10) - 50) / 8)
    >>> role_vote(u, late).score, role_vote(late, u).score
    (2, -2)
    """
    known = np.isfinite(first) & np.isfinite(second)
    x, y = first[known], second[known]
    x, y = (values[~dropouts(x)] for values in (x, y))
    step = -(-x.size // _MOST)
    x, y = x[::step], y[::step]
    if x.size < 4 * _BINS or not np.ptp(x) or not np.ptp(y):
        return RoleVote(0, ())
    score, reasons = 0, []
    forward, backward = _agreement(x, y), _agreement(y, x)
    if min(forward, -backward) >= _LAGS or min(-forward, backward) >= _LAGS:
        score += 1 if forward > 0 else -1
        reasons.append("the other column lags behind it")
    difference = evenness(x) - evenness(y)
    if abs(difference) >= _EVENER:
        score += 1 if difference > 0 else -1
        reasons.append("it is swept more evenly")
    return RoleVote(score, tuple(reasons) if abs(score) == len(reasons) else ("its loop is not clear",))


def leads(first: Array, second: Array) -> bool:
    """Whether the first of two columns (n,) is ahead of the second, by the way round of their loop.

    >>> t = np.linspace(0, 20, 500)
    >>> leads(np.sin(t), np.sin(t - 0.2)), leads(np.sin(t - 0.2), np.sin(t)), leads(np.sin(t), -np.sin(t))
    (True, False, False)
    """
    known = np.isfinite(first) & np.isfinite(second)
    x, y = (values[known] - values[known].mean() for values in (first, second))
    if x.size < 3 or not np.ptp(x) or not np.ptp(y):
        return False
    area = np.sign(x @ y) * float(x[:-1] @ y[1:] - x[1:] @ y[:-1]) / 2
    path = float(np.abs(np.diff(x[wide_turns(x)])).sum()) / 2
    return bool(area > _NARROW * path * np.ptp(y))


def swept_more_evenly(first: Array, second: Array) -> bool:
    """Whether the first of two columns (n,) is swept more evenly than the second, as what was ramped is."""
    return evenness(first) - evenness(second) >= _EVENER


def _agreement(u: Array, y: Array) -> float:
    """Agreement, in −1…1, of the loops with an output that lags its input; 0 without a loop."""
    turns = wide_turns(u).tolist()
    found = [
        _of_loop(u, y, a, b, c)
        for a, b, c in zip(turns[:-2], turns[1:-1], turns[2:])
        if min(abs(u[b] - u[a]), abs(u[c] - u[b])) >= _WIDE * np.ptp(u)
    ]
    return float(np.mean(found)) if found else 0.0


def _of_loop(u: Array, y: Array, a: int, b: int, c: int) -> float:
    """Agreement of falling minus rising output with the local slope, whose sign it has for a lag."""
    first, second = slice(a, b + 1), slice(b, c + 1)
    rising, falling = (first, second) if u[b] > u[a] else (second, first)
    low = max(u[rising].min(), u[falling].min())
    high = min(u[rising].max(), u[falling].max())
    grid = np.linspace(low, high, _GRID)
    up, down = (np.interp(grid, *_sorted(u[part], y[part])) for part in (rising, falling))
    apart, slope = down - up, np.gradient(up + down)
    if np.mean(np.abs(apart)) < _NARROW * np.ptp(y):
        return 0.0
    size = float(np.sum(np.abs(apart) * np.abs(slope)))
    return float(np.sum(apart * slope)) / size if size else 0.0


def _sorted(u: Array, y: Array) -> tuple[Array, Array]:
    order = np.argsort(u, kind="stable")
    return u[order], y[order]


def evenness(x: Array) -> float:
    """How evenly a column (n,) is swept: the entropy of its histogram over that of a uniform one; 0 for one value."""
    x = x[np.isfinite(x)]
    if not x.size or not np.ptp(x):
        return 0.0
    counts = np.histogram(x, _BINS)[0]
    share = counts[counts > 0] / counts.sum()
    return float(-np.sum(share * np.log(share)) / np.log(_BINS))
