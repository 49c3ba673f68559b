"""The peak of a transformation in a curve of heat flow: start, peak and finish by tangents, and its heat.

A branch has a baseline before and after the peak. The start is where the tangent at the steepest place of the leading
flank meets the baseline before the peak, extrapolated; the finish is the same of the trailing flank and the baseline
after it; the peak is where the curve is farthest from the baseline (ASTM F2004). A straight flank aside, the steepest
place is the inflection: a Gaussian peak m, s on a straight baseline has its start at m − 2 s and its finish at m + 2 s.

Below the peak the baseline goes from the line before to the line after in proportion to the part of the area that has
passed, which is exact for a step of the heat capacity (Hemminger and Sarge 1991). The latent heat is the area over it,
in time.

As in ``branch_tangents``, each figure is the mean over the choices of readings, and its draws contain the noise and the
spread of the choices.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, UsageError
from smarig.measurement import input_noise_sd
from smarig.transformation.branch_noise import ReadingNoise, pooled, reading_noise
from smarig.transformation.branch_tangents import DRAWS, LEAST_RISE, with_choice
from smarig.transformation.cycle_figures import Drawn
from smarig.transformation.fitted_line import (
    PlateauLine,
    SteepLine,
    SteepNoise,
    intersection,
    intersection_draws,
    plateau_line,
    steep_line,
)
from smarig.transformation.tangent_ranges import plateau_rows, steep_rows, steepest_centre

Integers = NDArray[np.int64]
FEWEST_OF_PEAK = 20  # readings of a branch
_END = 0.05  # of the readings: the level at an end, before anything else is known
_KNEE = 0.7  # of its half width: how far the foot of a peak lies beyond its half height; that of a Gaussian is 2 σ
_SMOOTHED = 0.2  # of its half width: readings whose mean shows where a peak is
_TOPS = (0.05, 0.1, 0.2)  # of its height: the readings at the top that show where it is highest
_ROUNDS = 6


@dataclass(frozen=True, eq=False)
class PeakTangent:
    """A tangent of a flank and the baseline it meets, of one choice of readings; ``foot`` is where they meet."""

    steep: SteepLine
    baseline: PlateauLine
    foot: tuple[float, float]


@dataclass(frozen=True, eq=False)
class HeatFlowPeak:
    """A peak that points up in a branch u, y (n,) in order of rising temperature.

    ``figures``: "low" and "high" (the feet at the lower and upper temperature), "peak", and "heat" if the rate is
    known. ``why_not``: reasons of those that are missing. ``baseline`` (n,) is that of a middle choice, ``top`` the
    curve at the peak, and ``noise_sd`` that of one reading.
    """

    u: Array
    y: Array
    figures: dict[str, Drawn]
    why_not: dict[str, str]
    baseline: Array
    tangents: dict[str, PeakTangent]
    top: float
    noise_sd: float


def heat_flow_peak(u: Array, y: Array, *, rate_K_per_s: float | None = None, seed: int = 0) -> HeatFlowPeak:
    """The highest peak of a branch with temperatures u and heat flows y (n,) in order of rising u, peak upwards.

    Heat is in the unit of y times seconds. Raises UsageError, with the reason, if no peak stands out.
    """
    if u.size < FEWEST_OF_PEAK:
        raise UsageError(f"it has {u.size} readings, and a peak needs at least {FEWEST_OF_PEAK}")
    rough = _rough_peak(u, y)
    noise = _noise(u, y, rough)
    if not rough.height > LEAST_RISE * noise.sd:
        raise UsageError(_why_none(u, y, rough))
    dice = np.random.default_rng(seed)
    drawn = noise.draws(DRAWS, np.arange(u.size), u.size, dice)
    bend = dice.standard_normal((DRAWS, 2))
    picks = dice.random((3, DRAWS))
    lines = {side: [plateau_line(u, y, rows, drawn) for rows in rough.rows[side]] for side in ("low", "high")}
    steep_noise = SteepNoise(drawn, noise.sd * float(np.sqrt(noise.inflation)), bend)
    figures: dict[str, Drawn] = {}
    tangents: dict[str, PeakTangent] = {}
    why_not: dict[str, str] = {}
    for k, (side, flank) in enumerate((("low", _leading), ("high", _trailing))):
        if not lines[side]:
            where = "before" if side == "low" else "after"
            why_not[side] = f"the curve has no baseline {where} the peak on the temperature axis"
            continue
        found = flank(u, y, lines[side], rough, steep_noise)
        if found:
            figures[side] = _mean_foot(found, picks[k])
            tangents[side] = found[len(found) // 2]
        else:
            why_not[side] = "fewer than three of its readings lie on the flank: a tangent needs them"
    pairs = list(zip(*_paired(lines["low"], lines["high"])))
    bases = [_baseline(u, y, low, high, rough) for low, high in pairs]
    tops = [t for base in bases for t in _tops(u, y - base, rough, drawn)]
    figures["peak"] = _mean([t.value for t in tops], [t.draws for t in tops], picks[2])
    if not (lines["low"] and lines["high"]):
        why_not["heat"] = "the curve has a baseline on one side of the peak only"
    elif rate_K_per_s is None:
        why_not["heat"] = "the heating rate is not known, because no time is recorded"
    else:
        areas = [_area(u, y, pair, base, rough, drawn) for pair, base in zip(pairs, bases)]
        figures["heat"] = _mean(
            [a.value / rate_K_per_s for a in areas], [a.draws / rate_K_per_s for a in areas], picks[2]
        )
    middle = bases[len(bases) // 2]
    top = float(np.interp(figures["peak"].value, u, middle + _moving_mean(y - middle, rough.window)))
    return HeatFlowPeak(u, y, figures, why_not, middle, tangents, top, noise.sd)


@dataclass(frozen=True, eq=False)
class _RoughPeak:
    """Row of the highest reading, height over the baseline, rows of each baseline, and readings of a moving mean."""

    apex: int
    height: float
    knees: tuple[float, float]
    rows: dict[str, tuple[Integers, ...]]
    window: int


def _rough_peak(u: Array, y: Array) -> _RoughPeak:
    """Where the peak and its baselines are: from a line through both ends, improved in turns."""
    end = max(3, round(_END * u.size))
    (u0, u1), (y0, y1) = ((np.median(x[:end]), np.median(x[-end:])) for x in (u, y))
    rough, base = _improved(u, y, y0 + (u - u0) * (y1 - y0) / (u1 - u0), max(1, u.size // 100))
    for _ in range(_ROUNDS - 1):
        try:
            rough, base = _improved(u, y, base, rough.window)
        except UsageError:
            raise UsageError(_why_none(u, y, rough)) from None
    return rough


def _improved(u: Array, y: Array, base: Array, window: int) -> tuple[_RoughPeak, Array]:
    """The peak over a baseline (n,), and the baseline that follows from it."""
    apex, height, halves = _around_apex(u, y - base, window)
    lower, upper = (abs(float(u[apex]) - half) for half in halves)
    knees = halves[0] - _KNEE * lower, halves[1] + _KNEE * upper
    span = knees[1] - knees[0]
    rows = {"low": _rows(u, u[0], knees[0], span), "high": _rows(u, u[-1], knees[1], span)}
    lines = [np.polyfit(u[r[len(r) // 2]], y[r[len(r) // 2]], 1) for r in rows.values() if r]
    if not lines:
        raise UsageError(
            "no peak stands out from a baseline: there is none on either side of the highest part"
        )
    low, high = (
        np.polyval(lines[0], u),
        np.polyval(lines[-1], u),
    )  # a side without a line has that of the other
    part = np.clip((u - knees[0]) / span, 0.0, 1.0)
    per_reading = float(np.median(np.diff(u))) or span / u.size
    smoothed = max(1, int(_SMOOTHED * min(lower, upper) / per_reading))
    return _RoughPeak(apex, height, knees, rows, smoothed), low + part * (high - low)


def _rows(u: Array, end: float, knee: float, span: float) -> tuple[Integers, ...]:
    """The rows of a baseline; () for a knee beyond the end."""
    return plateau_rows(u, float(end), knee, span) if u[0] < knee < u[-1] else ()


def _why_none(u: Array, y: Array, rough: _RoughPeak) -> str:
    """Why no peak stands out: another one in its baselines, which is no noise, or the noise."""
    line = np.interp(u, u[[0, -1]], y[[0, -1]])
    far = np.where((u < rough.knees[0]) | (u > rough.knees[1]), _moving_mean(y - line, rough.window), 0.0)
    other = int(np.argmax(far))
    if far[other] > LEAST_RISE * input_noise_sd(y):
        return f"a second peak, as that of an R-phase, lies near {u[other]:.0f} in the baseline of the highest one"
    return "no peak stands out clearly from its baseline and noise"


def _around_apex(u: Array, d: Array, window: int) -> tuple[int, float, tuple[float, float]]:
    """The highest reading of a moving mean, its height, and the temperatures at half of it on both sides."""
    smooth = _moving_mean(d, window)
    apex = int(np.argmax(smooth))
    height = float(smooth[apex])
    below = np.flatnonzero(smooth < height / 2)
    left, right = below[below < apex], below[below > apex]
    if not (height > 0 and left.size and right.size):
        raise UsageError("no peak stands out from a baseline: the curve is highest at an end")
    return apex, height, (float(u[left[-1]]), float(u[right[0]]))


def _moving_mean(x: Array, window: int) -> Array:
    """The mean of each reading and ``window`` on each side of it; of fewer, as many on both sides, at the ends."""
    sums = np.concatenate([[0.0], np.cumsum(x)])
    rows = np.arange(x.size)
    half = np.minimum(np.minimum(rows, rows[::-1]), window)
    return (sums[rows + half + 1] - sums[rows - half]) / (2 * half + 1)


def _noise(u: Array, y: Array, rough: _RoughPeak) -> ReadingNoise:
    """The noise of a reading from both baselines, with the larger correlation of them."""
    widest = [max(rows, key=len) for rows in rough.rows.values() if rows]
    own = [reading_noise(u[rows], y[rows]) for rows in widest]
    both = pooled(own) or own[0]
    return ReadingNoise(both.sd, both.degrees, max(n.inflation for n in own))


def _leading(
    u: Array, y: Array, lines: Sequence[PlateauLine], rough: _RoughPeak, noise: SteepNoise
) -> list[PeakTangent]:
    """The tangents of the flank at the lower temperature, of every choice of its readings and of its baseline."""
    return _flank(u[: rough.apex + 1], y[: rough.apex + 1], lines, rough.window, noise)


def _trailing(
    u: Array, y: Array, lines: Sequence[PlateauLine], rough: _RoughPeak, noise: SteepNoise
) -> list[PeakTangent]:
    """Those of the flank at the upper temperature: of its mirror image, whose temperatures have the other sign."""
    image = [PlateauLine(n.a, -n.b, n.a_draws, -n.b_draws) for n in lines]
    turned = SteepNoise(noise.draws[:, ::-1], noise.sd, noise.bend)
    rows = slice(None, rough.apex - 1 if rough.apex else None, -1)
    found = _flank(-u[rows], y[rows], image, rough.window, turned)
    return [_mirrored(tangent) for tangent in found]


def _mirrored(tangent: PeakTangent) -> PeakTangent:
    s, b, (u, y) = tangent.steep, tangent.baseline, tangent.foot
    steep = SteepLine(-s.u, s.y, -s.du_dy, -s.u_draws, -s.du_dy_draws)
    return PeakTangent(steep, PlateauLine(b.a, -b.b, b.a_draws, -b.b_draws), (-u, y))


def _flank(
    u: Array, y: Array, lines: Sequence[PlateauLine], window: int, noise: SteepNoise
) -> list[PeakTangent]:
    """The tangents of a flank that rises from its first reading to the peak, its last one."""
    from scipy.optimize import isotonic_regression  # imported here: takes half a second

    middle = lines[len(lines) // 2]
    over = _moving_mean(y - middle.a - middle.b * u, window)  # the noise of a reading must not choose it
    height = float(over[-1 - window :].max())
    share = isotonic_regression(np.clip(over / height, -0.5, 1.5), increasing=True).x
    if not share[0] < 0.25 < 0.75 < share[-1]:
        return []
    centre = steepest_centre(u, share)
    choices = steep_rows(share, centre)
    if not choices:
        return []
    at = middle.a + middle.b * float(np.median(u[choices[-1]])) + centre * height
    steeps = [steep_line(u, y, r, at, noise, float(np.ptp(share[r])), of_input=False) for r in choices]
    rising = [s for s in steeps if s is not None and s.du_dy > 0]
    feet = [(s, b, intersection(b, s)) for s, b in product(rising, lines) if 1 - s.du_dy * b.b > 0.5]
    return [PeakTangent(s, b, (foot, b.a + b.b * foot)) for s, b, foot in feet]


def _mean_foot(found: Sequence[PeakTangent], picks: Array) -> Drawn:
    return _mean([t.foot[0] for t in found], [intersection_draws(t.baseline, t.steep) for t in found], picks)


def _mean(values: Sequence[float], draws: Sequence[Array], picks: Array) -> Drawn:
    """The mean over choices, with draws (B,) of the noise and of the choice; ``picks`` (B,) in 0 … 1."""
    each = np.array(values)
    picked = np.minimum((picks * each.size).astype(int), each.size - 1)
    return Drawn(float(each.mean()), with_choice(each, np.stack(draws), picked))


def _paired(low: list[PlateauLine], high: list[PlateauLine]) -> tuple[list[PlateauLine], list[PlateauLine]]:
    """The same number of lines on both sides, the nearest to the peak together; a side without one has the other's."""
    low, high = low or high, high or low
    count = max(len(low), len(high))
    chosen = np.linspace(0, 1, count)
    low, high = ([lines[round(c * (len(lines) - 1))] for c in chosen] for lines in (low, high))
    return low, high


def _inside(u: Array, rough: _RoughPeak) -> NDArray[np.bool_]:
    """The rows of the peak: between the baselines' nearest readings, which the widest choice begins with."""
    low, high = rough.rows["low"], rough.rows["high"]
    begin = max(int(r[-1]) for r in low) if low else 0
    stop = min(int(r[0]) for r in high) if high else u.size - 1
    return (np.arange(u.size) >= begin) & (np.arange(u.size) <= stop)


def _baseline(u: Array, y: Array, low: PlateauLine, high: PlateauLine, rough: _RoughPeak) -> Array:
    """The baseline (n,): from one line to the other in proportion to the area of the peak that has gone by."""
    before, after = low.a + low.b * u, high.a + high.b * u
    part = _part(u, y, before, after, rough)
    return before + part * (after - before)


def _part(u: Array, y: Array, before: Array, after: Array, rough: _RoughPeak) -> Array:
    """The part (n,) of the area that has passed by, by iteration; 0 and 1 outside the peak."""
    inside = _inside(u, rough)
    part = np.clip((u - rough.knees[0]) / (rough.knees[1] - rough.knees[0]), 0.0, 1.0)
    for _ in range(_ROUNDS):
        over = np.where(inside, y - before - part * (after - before), 0.0)
        passed = np.concatenate([[0.0], np.cumsum((over[1:] + over[:-1]) / 2 * np.diff(u))])
        if passed[-1] <= 0:
            break
        part = np.clip(passed / passed[-1], 0.0, 1.0)
    return part


def _area(
    u: Array,
    y: Array,
    lines: tuple[PlateauLine, PlateauLine],
    base: Array,
    rough: _RoughPeak,
    drawn: Array,
) -> Drawn:
    """The area between curve and baseline over the rows of the peak, in the unit of y times K."""
    low, high = lines
    rows = np.flatnonzero(_inside(u, rough))
    weights = np.zeros(u.size)
    steps = np.diff(u[rows])
    weights[rows[:-1]] += steps / 2
    weights[rows[1:]] += steps / 2
    area = float(weights @ (y - base))
    before, after = low.a + low.b * u, high.a + high.b * u
    part = _part(u, y, before, after, rough)
    shift = drawn @ weights
    for line, share in ((low, 1 - part), (high, part)):
        shift = (
            shift
            - (line.a_draws - line.a) * (weights @ share)
            - (line.b_draws - line.b) * (weights @ (share * u))
        )
    return Drawn(area, area + shift)


def _tops(u: Array, d: Array, rough: _RoughPeak, drawn: Array) -> list[Drawn]:
    """Where a cubic through the top of the peak is highest, of each choice of its readings."""
    smooth = _moving_mean(d, rough.window)
    found: list[Drawn] = []
    for depth in _TOPS:
        below = np.flatnonzero(smooth < (1 - depth) * smooth[rough.apex])
        low = max(below[below < rough.apex], default=-1) + 1
        high = min(below[below > rough.apex], default=u.size)
        rows = np.arange(min(low, max(rough.apex - 2, 0)), max(high, min(rough.apex + 3, u.size)))
        found.append(_top(u[rows], d[rows], drawn[:, rows]))
    return found


def _top(u: Array, d: Array, drawn: Array) -> Drawn:
    """The maximum of a cubic through (u, d), a parabola of fewer than six readings, kept inside them."""
    middle, scale = float(u.mean()), float(np.ptp(u)) / 2
    degree = 3 if u.size >= 6 else 2
    inverse = np.linalg.pinv(np.vander((u - middle) / scale, degree + 1, increasing=True))
    coefficients = np.vstack([d, d + drawn]) @ inverse.T
    b, c = coefficients[:, 1], coefficients[:, 2]
    a = coefficients[:, 3] if degree == 3 else np.zeros_like(b)
    root = np.sqrt(np.maximum(c**2 - 3 * a * b, 0.0))
    at = np.where(root - c != 0, b / np.where(root - c != 0, root - c, 1.0), 0.0)
    places = middle + scale * np.clip(at, -1.0, 1.0)
    return Drawn(float(places[0]), places[1:])
