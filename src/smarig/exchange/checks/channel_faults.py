"""Findings on one measured channel: clipping, spikes, held values, coarse steps, constant values.

Each finding is one sentence. The thresholds are chosen so that an undisturbed slow signal gives no finding.
"""

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, spaced
from smarig.record import ImportFinding, remarks

_COARSE = 0.002  # of the range: smaller steps are invisible in a hysteresis loop
_SPIKE = 0.3  # of the 1–99 % range
_FEW = 0.02  # of the rows: more single rows that lie apart are noise
_HELD_ROWS = 5
_CLIPPED_ROWS = 5


def channel_findings(
    name: str, unit: str, x: Array, line: NDArray[np.int64], *, rests: bool = False
) -> list[ImportFinding]:
    """Findings on one channel ``x`` (n,); ``line`` (n,) are the lines of the values.

    ``rests``: the channel itself may stand still, so held values do not mean that a sensor is read too often.
    """
    finite = np.isfinite(x)
    values, where = (x, line) if finite.all() else (x[finite], line[finite])
    if values.size < 10:
        return []
    if np.ptp(values) == 0:
        return remarks(
            f"{name} is {values[0]:g}{spaced(unit)} in every row. It is nominal or not connected, not measured."
        )
    stuck = [] if rests else _clipped(name, unit, values, where)  # a wire rests at both ends of its travel
    return stuck + _spikes(name, unit, values, where) + remarks(*_steps(name, unit, values, rests))


def unused_findings(name: str, x: Array, line: NDArray[np.int64]) -> list[ImportFinding]:
    """Findings on a column that is not imported but shows faults of the logger: constant or spiky."""
    values = x[np.isfinite(x)]
    if values.size < 10:
        return []
    if np.ptp(values) == 0:
        return remarks(f"{name} is {values[0]:g} in every row.")
    return [f.without_kind for f in _spikes(name, "", values, line[np.isfinite(x)])]


def clipped(x: Array) -> NDArray[np.bool_]:
    """Mask of samples (n,) stuck at the largest or smallest value of a channel that varies elsewhere.

    A run of equal extreme values counts from five rows on, if it is five times as long as any run of equal values
    in between: a channel at rest or in coarse steps repeats itself elsewhere too. Channels that are held for more
    than five rows in between are not checked.
    """
    mask = np.zeros(x.size, dtype=bool)
    if np.isfinite(x).sum() < 10 or np.nanmax(x) == np.nanmin(x):
        return mask
    extremes = np.nanmax(x), np.nanmin(x)
    between = np.diff(x) == 0
    between &= ~np.isin(x[1:], extremes)
    elsewhere = 1 + max((b - a for a, b in _runs(between)), default=0)
    for extreme in extremes if elsewhere <= _HELD_ROWS else ():
        longest = max(b - a for a, b in _runs(x == extreme))
        if longest >= max(_CLIPPED_ROWS, 5 * elsewhere):
            mask |= x == extreme
    return mask


def quantum(x: Array) -> float | None:
    """Step of a quantised channel, or None: the grid on which nearly all small differences of levels lie.

    >>> quantum(np.round(np.linspace(0, 1, 200) ** 2 * 40) * 0.085)
    0.085
    """
    levels, times = np.unique(x[np.isfinite(x)], return_counts=True)
    frequent = levels[times > 2]  # means of two readings lie off the grid
    gaps = np.diff(frequent if frequent.size > 8 else levels)
    if gaps.size < 8:
        return None
    gaps = gaps[gaps > 0.2 * np.median(gaps)]  # rounded decimals scatter around a level
    small = np.quantile(gaps, 0.1)
    step = float(np.median(gaps[gaps < 1.3 * small]))
    near = gaps[gaps < 5.5 * step]
    step = float(near.sum() / np.round(near / step).sum())
    on_grid = np.abs(near / step - np.round(near / step)) < 0.08
    return float(f"{step:.3g}") if near.size >= 8 and on_grid.mean() > 0.9 else None


def _runs(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]]))).tolist()
    return list(zip(edges[::2], edges[1::2]))


def _clipped(name: str, unit: str, x: Array, line: NDArray[np.int64]) -> list[ImportFinding]:
    mask = clipped(x)
    if not mask.any():
        return []
    rows = line[mask]
    text = (
        f"{name} is clipped at {x[mask][0]:g}{spaced(unit)} in {rows.size} rows "
        f"(from line {rows.min()} to {rows.max()}): the range of the sensor ends there. Marked as saturated."
    )
    return [ImportFinding(text, "clipped channel")]


def lone_spikes(x: Array) -> NDArray[np.bool_]:
    """Mask of rows (n,) that alone lie far from both neighbours; none if there are many, which is noise."""
    mask = np.zeros(x.size, dtype=bool)
    finite = np.isfinite(x)
    v = x if finite.all() else x[finite]
    if v.size < 50:
        return mask
    limit = _SPIKE * float(np.ptp(np.quantile(v, [0.01, 0.99])))
    step = np.diff(v)
    before, after = step[:-1], step[1:]  # a lone row lies on one side of both neighbours
    lone = (before * after < 0) & (np.abs(before) > limit) & (np.abs(after) > limit)
    if limit > 0 and lone.mean() <= _FEW:
        mask[np.flatnonzero(finite)[1:-1][lone]] = True
    return mask


def error_codes(x: Array) -> NDArray[np.bool_]:
    """Mask of readings (n,) that repeat the lowest or highest value in a few single rows, each far from both neighbours
    and the range of all others, or further off than all others lie apart: a channel reads no such value twice, but a
    logger writes its code so.

    >>> x = np.sin(np.arange(200) / 9)
    >>> x[[50, 120]] = -99
    >>> np.flatnonzero(error_codes(x)).tolist()
    [50, 120]
    """
    mask, lone = np.zeros(x.size, dtype=bool), lone_spikes(x)
    known = np.flatnonzero(np.isfinite(x))
    for value in {x[known].min(), x[known].max()} if known.size else ():
        rows = x == value
        others = x[known][~(rows | lone)[known]]
        single = not (rows[known][1:] & rows[known][:-1]).any()
        if single and 1 < rows.sum() <= _FEW * known.size and others.size:
            off = max(value - others.max(), others.min() - value)
            if off > np.ptp(others) * (_SPIKE if lone[rows].all() else 1.0) > 0:
                mask |= rows
    return mask


def lost_decimals(x: Array) -> NDArray[np.bool_]:
    """Mask of the few readings (n,) that are ten, a hundred or a thousand times what both neighbours read, and further
    off than all others lie apart: a number that was written without its decimal sign.

    >>> x = 120 + np.arange(40) / 2
    >>> x[7] = 1235
    >>> np.flatnonzero(lost_decimals(x)).tolist()
    [7]
    """
    mask, known = np.zeros(x.size, dtype=bool), np.flatnonzero(np.isfinite(x))
    v = x[known]
    if v.size < 10:
        return mask
    around = np.c_[v[:-2], v[2:]]
    step = float(np.median(np.abs(np.diff(v))))
    for factor in (10.0, 100.0, 1000.0):
        read = v[1:-1] / factor
        near = (read >= around.min(axis=1) - step) & (read <= around.max(axis=1) + step)
        mask[known[1:-1]] |= near & (10 * (np.ptp(around, axis=1) + step) < np.abs(read))
    others = x[known][~mask[known]]
    off = np.maximum(x - others.max(), others.min() - x)
    mask &= off > np.ptp(others)
    return mask if mask.sum() <= max(1, _FEW * known.size) else np.zeros_like(mask)


def _spikes(name: str, unit: str, x: Array, line: NDArray[np.int64]) -> list[ImportFinding]:
    lone = lone_spikes(x)
    if not lone.any():
        return []
    height = np.minimum(np.abs(x[1:-1] - x[:-2]), np.abs(x[1:-1] - x[2:]))
    k = int(np.argmax(np.where(lone[1:-1], height, 0.0))) + 1
    text = (
        f"{name} has single-row spikes in {int(lone.sum())} place(s), the largest "
        f"{f'{x[k]:g}{spaced(unit)}'.strip()} between {x[k - 1]:g} and {x[k + 1]:g} (line {line[k]}); "
        f"kept as they are."
    )
    return [ImportFinding(text, "spikes")]


def _steps(name: str, unit: str, x: Array, rests: bool) -> list[str]:
    out = []
    rows_per_change = x.size / (1 + np.count_nonzero(np.diff(x)))
    if rows_per_change >= _HELD_ROWS and not rests:
        out.append(
            f"{name} changes only every {rows_per_change:.0f} rows on average: "
            f"it is held between conversions or at rest."
        )
    step = quantum(x)
    if step and step > _COARSE * np.ptp(x):
        out.append(
            f"{name} comes in steps of {step:g}{spaced(unit)} ({100 * step / np.ptp(x):.1f} % of its range)."
        )
    return out
