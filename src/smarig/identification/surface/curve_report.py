"""Findings on the measured curves before any fit: monotone, merging, crossing, range fully exercised.

* Assumption 2.1: first-order descending curves fall as the input falls.
* §5.4.1: curves that do not merge at the lower end, or a rising branch that meets the upper curve at an angle, mean
  that the input range was too small.
* Prop. 4.6: curves that cross inside the major loop prove μ < 0 somewhere; the converse is not proved.

Differences count if they exceed five times the noise of a reading, and rises and crossings of a wire in motion if they
also exceed what it moves within one tick.

The crossing of the default one-wire twin, which the measured wire of the thesis does not have (§5.4.1).

How far an output moves within one tick of its reading: a wire in motion is read at some moment of the tick.

The current, the computed temperature and the position of one sample belong to one tick, but to different moments of it:
an instrument is asked in turn, and a command takes effect when it has arrived. So a reading of a moving wire is one of
the outputs between those of one tick before and one tick after. A settled point is held, and has no such motion.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from smarig.core import Array, spaced
from smarig.identification.fod_data import DescendingCurve, FodData
from smarig.identification.surface.curve_fit import fit_curves
from smarig.preisach import thesis_surface
from smarig.record import Run
from smarig.theory import crossing_descending

SIGNIFICANT = 5.0
_DENSE = 20  # points of a curve whose third differences show its noise
# The six surfaces of Table 5.1 over their own partitions have an angle of at most 0.23 (two_c). Cut at the
# second-highest input the two-wire ones have 0.48 or more; cut at the third-highest the one-wire ones have 0.37.
_ANGLE = 0.3
_MERGED = 0.01
NO_CURVES = "The runs contain no first-order curves, so crossing and merging of such curves are unknown."
_SPREAD_FACTOR = 7.0  # the range of a dozen readings of one output is 3.3 σ on average, and sometimes 5 σ


@dataclass(frozen=True)
class CurveReport:
    """``noise`` σ of a reading in ``unit`` (NaN if unknown), ``cross`` of Prop. 4.6, ``merge_spread`` of the ends.

    ``top_angle`` is the slope of the rising branch minus that of the falling one at the top, over the mean slope of
    the major loop: 0 in saturation. ``exercised``: both ends look like saturation; None without first-order curves.
    """

    noise: float
    unit: str
    monotone: bool
    cross: bool
    merge: bool
    merge_spread: float
    top_angle: float
    exercised: bool | None
    warnings: tuple[str, ...]


def curve_report(data: FodData, moved: Array | None = None) -> CurveReport:
    """Compare the curves of FOD data (k points) with their own noise; each warning is one or two sentences.

    ``moved`` (k,) is the motion of the output within one tick of each reading (default: all were held). An output
    that falls while the input rises, as a strain does, is compared in its negative.
    """
    turned = float(np.cov(data.beta, data.y)[0, 1]) < 0 if data.y.size > 1 else False
    data = replace(data, y=-data.y) if turned else data
    descending_curves = data.descending_curves()
    if not descending_curves:
        return CurveReport(
            noise=float("nan"),
            unit=data.unit,
            monotone=True,
            cross=False,
            merge=True,
            merge_spread=0.0,
            top_angle=0.0,
            exercised=None,
            warnings=(NO_CURVES,),
        )
    noise = reading_noise(data)
    threshold = SIGNIFICANT * noise if np.isfinite(noise) else 0.0
    lowest, highest = _extremes(data, moved)
    rising = [low.alpha for low, high in zip(lowest, highest) if _largest_rise(low, high) > threshold]
    crossing = _crossing_curves(lowest, highest, threshold)
    spread = _spread(descending_curves)
    merge = spread <= max(_SPREAD_FACTOR * np.nan_to_num(noise), _MERGED * float(np.ptp(data.y)))
    angle, angle_noise = _top_angle(data, descending_curves, noise)
    angled = angle - 2 * angle_noise > _ANGLE
    unit, sign = data.unit, -1.0 if data.mirrored else 1.0
    warnings = []
    if rising:
        where = ", ".join(f"{sign * a + 0.0:g}" for a in rising[:3])
        way, turn = "fall" if data.mirrored != turned else "rise", "rises" if data.mirrored else "falls"
        warnings.append(
            f"Curves {way} while the input {turn} (α = {where}): Assumption 2.1 does not hold for these data, "
            "and the inverse is not unique there."
        )
    if crossing:
        first, second, place = (f"{sign * value + 0.0:g}" for value in crossing)  # no −0
        warnings.append(
            f"First-order curves cross inside the major loop (α = {first} and {second} near β = {place}): the density "
            "μ of these data is negative somewhere (Prop. 4.6)."
        )
    if not merge:
        warnings.append(
            f"The curves do not merge at their lower end (they spread over {spread:.3g}{spaced(unit)}): the wire "
            "changes from curve to curve, or the range was not fully exercised. If repeats of one state agree, "
            "identify again with lower inputs."
        )
    if angled:
        warnings.append(
            "The range was not fully exercised: the rising branch meets the upper curve at an angle "
            f"({angle:.2f} of the mean slope), so it is not saturated. Identify again with higher inputs."
        )
    crosses = crossing is not None
    return CurveReport(
        noise=noise,
        unit=unit,
        monotone=not rising,
        cross=crosses,
        merge=merge,
        merge_spread=spread,
        top_angle=angle,
        exercised=merge and not angled,
        warnings=tuple(warnings),
    )


def reading_noise(data: FodData) -> float:
    """Standard deviation of a reading about its own curve, without a surface; NaN if curves are too short.

    Long curves: third differences, Var Δ³y = 20σ², by their mean size. Others: the residuals of the sigmoids.
    """
    descending_curves = data.descending_curves()
    if descending_curves and np.median([d.beta.size for d in descending_curves]) >= _DENSE:
        thirds = np.concatenate([np.diff(d.y, 3) for d in descending_curves])
        size = np.sort(np.abs(thirds))[: max(1, round(0.99 * thirds.size))]  # jumps are not noise
        return float(size.mean() * np.sqrt(np.pi / 2) / np.sqrt(20))
    return fit_curves(data).sigma


def _extremes(data: FodData, moved: Array | None) -> tuple[list[DescendingCurve], list[DescendingCurve]]:
    """The descending curves of the lowest and of the highest outputs that the readings may stand for."""
    by = 0.0 if moved is None else moved
    lowest, highest = (replace(data, y=data.y + sign * by) for sign in (-1.0, 1.0))
    return lowest.descending_curves(), highest.descending_curves()


def _largest_rise(lowest: DescendingCurve, highest: DescendingCurve) -> float:
    """Largest rise of the output while the input falls, at least."""
    return float(np.max(lowest.y - np.minimum.accumulate(highest.y)))


def _crossing_curves(
    lowest: list[DescendingCurve], highest: list[DescendingCurve], threshold: float
) -> tuple[float, float, float] | None:
    """(α₁, α₂, β) at which a curve from a higher maximum lies lowest below one from a lower maximum.

    ``lowest`` and ``highest`` are the same curves with the outputs that they have at least and at most. Between two
    points a curve is known to lie between their outputs, and no more.
    """
    ordered = sorted(zip(lowest, highest), key=lambda both: both[0].alpha)
    if len(ordered) < 2:
        return None
    grid = np.unique(np.concatenate([low.beta for low, _ in ordered]))
    upper, owner = np.full(grid.size, -np.inf), np.zeros(grid.size)
    worst, found = threshold, None
    for low, high in ordered:
        least, most = _between_points(low, grid)[0], _between_points(high, grid)[1]
        below = np.where(np.isfinite(most), upper - most, -np.inf)
        k = int(np.argmax(below))
        if below[k] > worst:
            worst, found = float(below[k]), (float(owner[k]), low.alpha, float(grid[k]))
        higher = np.isfinite(least) & (least > upper)
        upper[higher], owner[higher] = least[higher], low.alpha
    return found


def _between_points(d: DescendingCurve, inputs: Array) -> tuple[Array, Array]:
    """(least, most) outputs (n,) of a curve at inputs within its loop, NaN outside: of the points below and above."""
    beta, y = d.beta[::-1], d.y[::-1]
    outside = (inputs < beta[0]) | (inputs > beta[-1]) | (inputs >= d.alpha)  # or on the rising branch
    below = np.clip(np.searchsorted(beta, inputs, side="right") - 1, 0, beta.size - 1)
    above = np.clip(np.searchsorted(beta, inputs, side="left"), 0, beta.size - 1)
    return np.where(outside, np.nan, y[below]), np.where(outside, np.nan, y[above])


def _spread(descending_curves: list[DescendingCurve]) -> float:
    """Range of the outputs at the lowest input, over the curves that reach it."""
    if not descending_curves:
        return 0.0
    lowest = min(float(d.beta[-1]) for d in descending_curves)
    ends = [float(d.y[-1]) for d in descending_curves if d.beta[-1] == lowest]
    return max(ends) - min(ends)


def _top_angle(data: FodData, descending_curves: list[DescendingCurve], noise: float) -> tuple[float, float]:
    """Difference of the branches' slopes at the top over the mean slope, and its noise; 0, 0 if a branch is
    missing.
    """
    rising = data.alpha == data.beta
    inputs, where = np.unique(data.alpha[rising], return_inverse=True)
    if not descending_curves or inputs.size < 2:
        return 0.0, 0.0
    outputs = np.bincount(where, data.y[rising]) / np.bincount(where)
    top = max(descending_curves, key=lambda d: d.alpha)
    height, width = float(np.ptp(top.y)), float(np.ptp(top.beta))
    if inputs[-1] != top.alpha or height == 0.0:
        return 0.0, 0.0
    below = inputs[-2]
    rise = outputs[-1] - outputs[-2]
    fall = outputs[-1] - np.interp(below, top.beta[::-1], top.y[::-1])
    scale = width / height / (top.alpha - below)
    return float((rise - fall) * scale), float(np.nan_to_num(noise) * np.sqrt(2) * scale)


_THESIS_WIRE = "one"  # surfaces of the one-wire rig, whose measured curves do not cross


def twin_crossing_note(runs: Sequence[Run]) -> str:
    """A sentence on crossing curves of a twin whose surface itself crosses; "" for all other runs.

    The thesis finds no crossing in the measured curves of this wire; its fitted surface one_e has one.
    """
    names = {_surface_name(run) for run in runs}
    if len(names) != 1 or not (name := names.pop()).startswith(f"{_THESIS_WIRE}_"):
        return ""
    surface = thesis_surface(name)
    found = crossing_descending(surface)
    if found is None:
        return ""
    return (
        f"This crossing is that of the twin's surface {name} of Table 5.1 (up to {found.depth:.2g} {surface.unit}); "
        "the curves that the thesis measured on its wire do not cross (§5.4.1)."
    )


def _surface_name(run: Run) -> str:
    """The surface of Table 5.1 that a twin simulates; "" for a bench, another surface, or a thermomechanical wire."""
    values: Any = run.info.actuator_values
    if not run.twin or not isinstance(values, dict) or values.get("thermomechanical"):
        return ""
    section = values.get("hysteresis")
    name = section.get("surface") if isinstance(section, dict) else None
    return name if isinstance(name, str) else ""


def motion_within_a_tick(runs: Sequence[Run], data: FodData) -> Array:
    """The larger motion of the output in the tick before and after each point (k,); 0 at settled points and in runs
    without a clock.
    """
    moved = np.zeros(len(data))
    for number, run in enumerate(runs):
        rows = data.run == number
        if rows.any() and not run.settled and run.has("t_s"):
            moved[rows] = _of_samples(run)[data.point[rows]]
    return moved


def _of_samples(run: Run) -> Array:
    """The motion at each sample of a run (n,) with an input and a position."""
    known = np.isfinite(run["input"]) & np.isfinite(run["position"])
    ticks, place = np.unique(
        run["tick"][known], return_inverse=True
    )  # a turning point is in two of the points
    y = np.bincount(place, run["position"][known]) / np.bincount(place)
    per_tick = np.abs(np.diff(y)) / np.diff(ticks)  # a mean of several samples moves by less in one
    return np.maximum(np.append(0.0, per_tick), np.append(per_tick, 0.0))[place]
