"""The rough shape of a branch: its plateaus, its steep part and its corners, to place the ranges of the tangents.

It starts from the ends of the branch and improves itself: corners give plateaus, plateaus give the share of the output
that is transformed, and that gives the steep part and the corners.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, UsageError
from smarig.transformation.tangent_ranges import plateau_rows, steep_rows, steepest_centre

Line = tuple[float, float]  # level at input 0, and slope
_END = 0.15  # of the input's range: the first plateaus
_STEEP_END = 0.15  # of the steepest slope: an end with more slope is no plateau
_SHORT = 0.3  # of the span: a shorter plateau is left as it was
_LEVEL = 0.3  # of the slope of the transformation: a steeper line is left as it was
_WINDOW = 0.05  # of the input's range, for the steepest slope
_ROUNDS = 6
_STANDS_OUT = 3.0  # times the slope of the plateaus


@dataclass(frozen=True, eq=False)
class RoughShape:
    """Corners, the rising share (n,) of the output, its steepest place, and the output there.

    ``rise`` is the output of the upper plateau minus that of the lower one at the steepest reading. ``stands_out``:
    the steep part is steeper than the plateaus.
    """

    ends: Line
    knees: Line
    share: Array
    centre: float
    output_at_centre: float
    rise: float
    stands_out: bool

    @property
    def span(self) -> float:
        """From the lower to the upper corner."""
        return self.knees[1] - self.knees[0]

    def sides(self) -> Iterator[tuple[str, float, float]]:
        """(side, end of the branch, corner) for both plateaus."""
        yield "low", self.ends[0], self.knees[0]
        yield "high", self.ends[1], self.knees[1]


def rough_shape(u: Array, y: Array, *, noisy: bool = False) -> RoughShape:
    """The rough shape of a branch in order of rising input. Raises UsageError for a flat one.

    ``noisy``: the input carries noise. The steepest place would be one where noise makes it steep, so the middle of
    the output is taken.
    """
    shape, (low, high) = _first_shape(u, y, noisy)
    for _ in range(_ROUNDS):
        before = shape.knees
        low = _plateau(u, y, shape, 0) or low
        high = _plateau(u, y, shape, 1) or high
        try:
            shape = _shape(u, y, low, high, noisy)
        except UsageError:
            break
        if np.allclose(shape.knees, before, atol=1e-3 * float(np.ptp(u))):
            break
    return shape


def _first_shape(u: Array, y: Array, noisy: bool) -> tuple[RoughShape, tuple[Line, Line]]:
    """The shape from lines through the ends; from their levels if no steep part stands out from the lines."""
    lines, levels = _first_plateaus(u, y)
    try:
        shape = _shape(u, y, *lines, noisy)
    except UsageError:
        return _shape(u, y, *levels, noisy), levels
    if shape.stands_out:
        return shape, lines
    try:
        return _shape(u, y, *levels, noisy), levels
    except UsageError:
        return shape, lines


def monotone(u: Array) -> Array:
    """The input without the reversals of its noise, by isotonic least squares."""
    from scipy.optimize import isotonic_regression  # imported here: takes half a second

    return isotonic_regression(u, increasing=True).x


def _first_plateaus(u: Array, y: Array) -> tuple[tuple[Line, Line], tuple[Line, Line]]:
    """Lines through both ends, or their levels where an end is as steep as the transformation; and their levels."""
    steepest = _steepest_slope(monotone(u), y)
    lines: list[Line] = []
    levels: list[Line] = []
    for end, inside in (
        (u.min(), u <= u.min() + _END * np.ptp(u)),
        (u.max(), u >= u.max() - _END * np.ptp(u)),
    ):
        rows = np.flatnonzero(inside)
        nearest = rows[np.argsort(np.abs(u[rows] - end), kind="stable")[: max(1, rows.size // 5)]]
        level: Line = (float(np.median(y[nearest])), 0.0)
        line = _line(u[rows], y[rows]) if rows.size >= 4 and np.ptp(u[rows]) > 0 else level
        lines.append(line if abs(line[1]) <= _STEEP_END * steepest else level)
        levels.append(level)
    return (lines[0], lines[1]), (levels[0], levels[1])


def _steepest_slope(u: Array, y: Array) -> float:
    """The largest slope over windows of 5 % of the input's range and at least five readings."""
    width, found = _WINDOW * float(np.ptp(u)), 0.0
    for k in range(u.size):
        stop = max(k + 5, int(np.searchsorted(u[k:] >= u[k] + width, True)) + k)
        rows = slice(k, min(stop, u.size))
        if u[rows].size >= 3 and np.ptp(u[rows]) > 0:
            found = max(found, abs(_line(u[rows], y[rows])[1]))
    return found


def _shape(u: Array, y: Array, low: Line, high: Line, noisy: bool) -> RoughShape:
    from scipy.optimize import isotonic_regression  # imported here: takes half a second

    below, above = low[0] + low[1] * u, high[0] + high[1] * u
    between = above - below
    middle = float(np.median(between))
    if middle == 0 or np.any(between * middle <= 0.02 * middle**2):
        between = np.full(u.size, middle or np.ptp(y))
    share = isotonic_regression(np.clip((y - below) / between, -0.5, 1.5), increasing=True).x
    if not share[0] < 0.25 < 0.75 < share[-1]:
        raise UsageError("no steep part stands out clearly from its plateaus and noise")
    centre = 0.5 if noisy else steepest_centre(monotone(u), share)
    rows = _widest_rows(share, centre)
    at = float(np.interp(centre, [0, 1], [float(below[rows].mean()), float(above[rows].mean())]))
    slope, u0 = _steep(u[rows], y[rows], at)
    knees = tuple(
        float(np.clip((u0 + slope * (line[0] - at)) / (1 - slope * line[1]), u.min(), u.max()))
        for line in (low, high)
    )
    steepness = abs(1 / slope) if slope else np.inf
    return RoughShape(
        ends=(float(u.min()), float(u.max())),
        knees=(knees[0], knees[1]),
        share=share,
        centre=centre,
        output_at_centre=at,
        rise=float(between[rows].mean()),
        stands_out=steepness > _STANDS_OUT * max(abs(low[1]), abs(high[1])) and knees[1] > knees[0],
    )


def _widest_rows(share: Array, centre: float) -> NDArray[np.int64]:
    choices = steep_rows(share, centre)
    if not choices:
        raise UsageError(
            "fewer than three of its readings lie in the transformation: a steep tangent needs them"
        )
    return choices[-1]


def _steep(u: Array, y: Array, at: float) -> tuple[float, float]:
    """(du/dy, input at the output ``at``) of the line of the input on the output, which noise of the input leaves
    unbiased.
    """
    if np.ptp(y) == 0:
        return 0.0, float(u.mean())
    slope, level = np.polyfit(y - y.mean(), u, 1)
    return float(slope), float(level + slope * (at - y.mean()))


def _plateau(u: Array, y: Array, shape: RoughShape, side: int) -> Line | None:
    """The line through a plateau, from a middle choice of its readings."""
    choices = plateau_rows(u, shape.ends[side], shape.knees[side], shape.span)
    if not choices or shape.span <= 0:
        return None
    rows = choices[len(choices) // 2]
    line = _line(u[rows], y[rows])
    long = abs(shape.knees[side] - shape.ends[side]) > _SHORT * shape.span
    return line if long and abs(line[1]) * shape.span <= _LEVEL * abs(shape.rise) else None


def _line(u: Array, y: Array) -> Line:
    slope, level = np.polyfit(u - u.mean(), y, 1)
    return float(level - slope * u.mean()), float(slope)
