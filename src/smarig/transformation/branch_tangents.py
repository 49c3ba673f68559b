"""The tangents of one heating or cooling branch, and where they meet.

``low`` is the corner at the lower temperature (A_s on heating, M_f on cooling) and ``high`` that at the upper one
(A_f, M_s). Both follow from the same steep tangent. The corners are computed for every choice of readings in
``tangent_ranges``. Their mean is the value. Its interval has two parts: the noise of the readings, and the spread of
the choices beyond what noise alone would give them, as in a random-effects mean of several laboratories
(DerSimonian and Laird 1986).
"""

from dataclasses import dataclass, field, replace
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, UsageError
from smarig.transformation.branch_noise import ReadingNoise, at_least, pooled, reading_noise
from smarig.transformation.fitted_line import (
    PlateauLine,
    SteepLine,
    intersection,
    intersection_draws,
    plateau_line,
)
from smarig.transformation.input_noise import smoothed_input
from smarig.transformation.rough_shape import RoughShape, rough_shape
from smarig.transformation.steep_choices import steep_lines
from smarig.transformation.tangent_ranges import FEWEST_PLATEAU, JUMP, plateau_rows

Integers = NDArray[np.int64]
FEWEST_READINGS = 10
DRAWS = 400
_PICKS = 7  # seed
_STEEP_PLATEAU = 0.25  # of the steep slope: a steeper plateau has not levelled off
_SHORT_PLATEAU = 0.3  # of the span: a shorter one is a part of the knee
LEAST_RISE = 8.0  # times the noise of the plateaus
_WIDE_GAP = (
    0.4  # of the span from corner to corner: readings about a corner that are farther apart do not show it
)


@dataclass(frozen=True, eq=False)
class Corner:
    """Where a plateau's tangent meets the steep one: value, draws (B,), the output there, and its plateau's tangent.

    ``borrowed``: the plateau is that of the other branch of the cycle. ``gap``: the two readings between which the
    branch has none, if the corner lies between them and the draws therefore span them.
    """

    value: float
    draws: Array
    output: float
    output_draws: Array
    plateau: PlateauLine
    plateau_rows: Integers
    borrowed: bool = False
    gap: tuple[float, float] | None = None


@dataclass(frozen=True, eq=False)
class BranchTangents:
    """A branch in order of rising input, u and y (n,), its tangents and corners.

    ``why_not`` gives the reason for a corner that is missing, by "low" and "high". ``noise_sd`` is that of the output.
    ``jump`` is the largest share of the output between two readings of the transformation, and their inputs. ``span``
    is the rough distance of the corners. ``clipped``: the output at which the range of its sensor ends, by side.
    """

    u: Array
    y: Array
    steep: SteepLine
    steep_rows: Integers
    low: Corner | None
    high: Corner | None
    why_not: dict[str, str]
    noise_sd: float
    steep_lines: tuple[SteepLine, ...]
    plateaus: dict[str, tuple[PlateauLine, ...]]
    picks: Array
    jump: tuple[float, float, float]
    span: float
    clipped: dict[str, float] = field(default_factory=dict)

    @property
    def gaps(self) -> tuple[tuple[float, float], ...]:
        """Inputs between which readings are missing: on the steep part, and about a corner."""
        share, low, high = self.jump
        own = [(low, high)] if share > JUMP else []
        own += [corner.gap for corner in (self.low, self.high) if corner and corner.gap]
        return tuple(dict.fromkeys(own))


def branch_tangents(
    u: Array, y: Array, *, seed: int = 0, curve_seed: int = 0, unit: str = ""
) -> BranchTangents:
    """The tangents of a branch with readings u and y (n,) in order of rising input.

    ``seed`` draws the noise, ``curve_seed`` what the bend of the curve could be: branches of one curve have it in
    common. Raises UsageError, with the reason, if a reading is not a number, if there are fewer than ten, or if no
    steep part stands out from the plateaus and the noise.
    """
    _check(u, y)
    readings = u
    smoothed = smoothed_input(u)
    u = u if smoothed is None else smoothed
    shape = rough_shape(u, y, noisy=smoothed is not None)
    dice = np.random.default_rng(seed)
    rows = {side: plateau_rows(u, end, knee, shape.span) for side, end, knee in shape.sides()}
    noises = {side: reading_noise(u[_widest(r)], y[_widest(r)]) if r else None for side, r in rows.items()}
    output_noise = pooled([n for n in noises.values() if n])
    _check_rise(shape, output_noise)
    bend = np.random.default_rng(curve_seed).standard_normal((DRAWS, 2))
    steep, chosen_rows = steep_lines(readings, y, shape, output_noise, dice, bend, noisy=smoothed is not None)
    lines: dict[str, tuple[PlateauLine, ...]] = {}
    for side, choices in rows.items():
        noise = at_least(own, output_noise) if (own := noises[side]) else None
        drawn = noise.draws(DRAWS, _widest(choices), u.size, dice) if noise else np.zeros((DRAWS, u.size))
        lines[side] = tuple(plateau_line(u, y, r, drawn) for r in choices)
    picks = np.random.default_rng(_PICKS).random((3, DRAWS))  # the same choices in every branch
    middle = len(steep) // 2
    found = BranchTangents(
        u=u,
        y=y,
        steep=steep[middle],
        steep_rows=chosen_rows[middle],
        low=None,
        high=None,
        why_not={},
        noise_sd=output_noise.sd if output_noise else 0.0,
        steep_lines=steep,
        plateaus=lines,
        picks=picks,
        jump=_largest_jump(u, shape.share),
        span=shape.span,
    )
    for side, end, knee in shape.sides():
        reason = _not_level(found, rows[side], end, knee, shape, unit)
        corner = None if reason else _corner(found, lines[side], side, rows[side])
        reason = reason or ("" if corner else "its tangents meet outside the readings")
        why_not = found.why_not | ({side: reason} if reason else {})
        changed: dict[str, Any] = {side: corner, "why_not": why_not}
        found = replace(found, **changed)
    if found.low is None and found.high is None:
        raise UsageError("it is flat, or not complete: the output levels off at neither end")
    return found


def with_borrowed_plateau(branch: BranchTangents, other: BranchTangents, side: str) -> BranchTangents:
    """The branch with the missing corner of a side from the plateau of the other branch of its cycle."""
    lines = other.plateaus[side]
    donor: Corner | None = getattr(other, side)
    corner = _corner(branch, lines, side, ()) if donor and not donor.borrowed else None
    if corner is None:
        return branch
    why_not = {k: v for k, v in branch.why_not.items() if k != side}
    changed: dict[str, Any] = {side: replace(corner, borrowed=True), "why_not": why_not}
    return replace(branch, **changed)


def _check(u: Array, y: Array) -> None:
    if not (np.isfinite(u).all() and np.isfinite(y).all()):
        raise UsageError("a reading of its temperature or output is not a number")
    if u.size < FEWEST_READINGS:
        raise UsageError(f"it has {u.size} readings, and tangents need at least {FEWEST_READINGS}")
    if np.ptp(u) == 0 or np.ptp(y) == 0:
        raise UsageError("its temperature or output is constant")


def _check_rise(shape: RoughShape, noise: ReadingNoise | None) -> None:
    least = LEAST_RISE * (noise.sd if noise else 0.0)
    if abs(shape.rise) <= least or not shape.stands_out:
        raise UsageError("no steep part stands out clearly from its plateaus and noise")


def _largest_jump(u: Array, share: Array) -> tuple[float, float, float]:
    steps = np.diff(np.clip(share, 0.0, 1.0))
    k = int(np.argmax(steps))
    return float(steps[k]), float(u[k]), float(u[k + 1])


def _not_level(
    found: BranchTangents,
    choices: tuple[Integers, ...],
    end: float,
    knee: float,
    shape: RoughShape,
    unit: str,
) -> str:
    """Why a plateau gives no tangent; "" if it does."""
    where = f"before its end at {end:.4g}{unit and ' ' + unit}"
    if abs(knee - end) < _SHORT_PLATEAU * shape.span:
        return f"the output has not levelled off {where}"
    if not choices:
        return f"fewer than {FEWEST_PLATEAU} readings lie on the plateau at its end at {end:.4g}{unit and ' ' + unit}"
    side = "low" if end < knee else "high"
    slopes = [abs(line.b * found.steep.du_dy) for line in found.plateaus[side]]
    if float(np.median(slopes)) > _STEEP_PLATEAU:
        return f"the output has not levelled off {where}"
    return ""


def _corner(
    found: BranchTangents, lines: tuple[PlateauLine, ...], side: str, choices: tuple[Integers, ...]
) -> Corner | None:
    """The corner over all choices of plateau and steep tangent; None if it lies outside the readings."""
    pairs = [
        (steep, line) for steep, line in product(found.steep_lines, lines) if 1 - steep.du_dy * line.b > 0.5
    ]
    if not pairs:
        return None
    values = np.array([intersection(line, steep) for steep, line in pairs])
    outputs = np.array([line.a + line.b * v for (_, line), v in zip(pairs, values)])
    value = float(values.mean())
    if not found.u[0] <= value <= found.u[-1]:
        return None
    drawn = np.stack([intersection_draws(line, steep) for steep, line in pairs])
    drawn_outputs = np.stack([line.a_draws + line.b_draws * d for (_, line), d in zip(pairs, drawn)])
    pick_plateau = found.picks[0 if side == "low" else 2]
    steps = (found.picks[1] * len(found.steep_lines)).astype(int) * len(lines) + (
        pick_plateau * len(lines)
    ).astype(int)
    picked = np.minimum(steps, len(pairs) - 1)
    draws = with_choice(values, drawn, picked)
    gap = _gap_about(found.u, value, _WIDE_GAP * found.span)
    if gap is not None:
        draws = _over_gap(draws, value, gap, pick_plateau)
    line = lines[len(lines) // 2] if lines else pairs[0][1]
    rows = choices[len(lines) // 2] if choices else np.empty(0, dtype=np.int64)
    output_draws = with_choice(outputs, drawn_outputs, picked)
    return Corner(value, draws, float(outputs.mean()), output_draws, line, rows, gap=gap)


def _gap_about(u: Array, value: float, widest: float) -> tuple[float, float] | None:
    """The readings next to a value, if they are farther apart than ``widest``."""
    k = int(np.clip(np.searchsorted(u, value), 1, u.size - 1))
    low, high = float(u[k - 1]), float(u[k])
    return (low, high) if high - low > widest else None


def _over_gap(draws: Array, value: float, gap: tuple[float, float], uniform: Array) -> Array:
    """The noise of the draws (B,) about any place of a gap: a curve without readings may bend anywhere in it.

    95 % of the places (``uniform``, B) are the gap.
    """
    low, high = gap
    return (low + high) / 2 + (high - low) / 0.95 * (uniform - 0.5) + (draws - value)


def with_choice(values: Array, drawn: Array, picked: Integers) -> Array:
    """Draws (B,) of the mean over choices: noise, and the spread of the choices beyond that of noise.

    ``values`` (W,) of the choices, ``drawn`` (W, B) with noise, ``picked`` (B,) one choice for each draw.
    """
    between = float(values.var())
    by_noise = float((drawn - values[:, None]).var(axis=0).mean())
    share = np.sqrt(max(0.0, between - by_noise) / between) if between > 0 else 0.0
    return np.asarray(drawn.mean(axis=0) + share * (values[picked] - values.mean()))


def _widest(choices: tuple[Integers, ...]) -> Integers:
    return max(choices, key=len) if choices else np.empty(0, dtype=np.int64)
