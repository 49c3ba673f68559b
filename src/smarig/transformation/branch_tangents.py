"""The tangents of one heating or cooling branch, and where they meet.

``low`` is the corner at the lower temperature (A_s on heating, M_f on cooling) and ``high`` that at the upper one
(A_f, M_s). Both follow from the same steep tangent. The corners are computed for every choice of readings in
``tangent_ranges``. Their mean is the value. Its interval has two parts: the noise of the readings, and the spread of
the choices beyond what noise alone would give them, as in a random-effects mean of several laboratories
(DerSimonian and Laird 1986).
"""

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from smarig.core import UsageError
from smarig.transformation.fitted_line import (
    PlateauLine,
    SteepLine,
    intersection,
    intersection_draws,
    plateau_line,
    steep_line,
)
from smarig.transformation.input_noise import smoothed_input
from smarig.transformation.reading_noise import ReadingNoise, reading_noise
from smarig.transformation.rough_shape import RoughShape, rough_shape
from smarig.transformation.tangent_ranges import FEWEST_PLATEAU, plateau_rows, steep_rows

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
FEWEST_READINGS = 10
DRAWS = 400
_UNCERTAIN = 3.0  # times the standard deviation of the most certain slope
_FEW_STEEP = 8  # readings
_FLATTER = 1.4  # times the du/dy of the steepest choice
_PICKS = 7  # seed
_INPUT_NOISE = 2.0  # times the plateaus' noise: more on the steep part is noise of the input
_STEEP_PLATEAU = 0.25  # of the steep slope: a steeper plateau has not levelled off
_SHORT_PLATEAU = 0.3  # of the span: a shorter one is a part of the knee
_LEAST_RISE = 8.0  # times the noise of the plateaus


@dataclass(frozen=True, eq=False)
class Corner:
    """Where a plateau's tangent meets the steep one: value, draws (B,), the output there, and its plateau's tangent.

    ``borrowed``: the plateau is that of the other branch of the cycle.
    """

    value: float
    draws: Array
    output: float
    output_draws: Array
    plateau: PlateauLine
    plateau_rows: Integers
    borrowed: bool = False


@dataclass(frozen=True, eq=False)
class BranchTangents:
    """A branch in order of rising input, u and y (n,), its tangents and corners.

    ``why_not`` gives the reason for a corner that is missing, by "low" and "high". ``noise_sd`` is that of the output.
    ``jump`` is the largest share of the output between two readings of the transformation, and their inputs.
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


def branch_tangents(u: Array, y: Array, *, seed: int = 0, unit: str = "") -> BranchTangents:
    """The tangents of a branch with readings u and y (n,) in order of rising input.

    Raises UsageError, with the reason, if a reading is not a number, if there are fewer than ten, or if no steep part
    stands out from the plateaus and the noise.
    """
    _check(u, y)
    readings = u
    smoothed = smoothed_input(u)
    u = u if smoothed is None else smoothed
    shape = rough_shape(u, y, noisy=smoothed is not None)
    dice = np.random.default_rng(seed)
    rows = {side: plateau_rows(u, end, knee, shape.span) for side, end, knee in shape.sides()}
    noises = {side: reading_noise(u[_widest(r)], y[_widest(r)]) if r else None for side, r in rows.items()}
    output_noise = _pooled([n for n in noises.values() if n])
    _check_rise(shape, output_noise)
    steep, chosen_rows = _steep_lines(readings, y, shape, output_noise, dice, noisy=smoothed is not None)
    lines: dict[str, tuple[PlateauLine, ...]] = {}
    for side, choices in rows.items():
        noise = _at_least(own, output_noise) if (own := noises[side]) else None
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
    )
    for side, end, knee in shape.sides():
        reason = _not_level(found, rows[side], end, knee, shape, unit)
        corner = None if reason else _corner(found, lines[side], side, rows[side])
        reason = reason or ("" if corner else "its tangents meet outside the readings")
        found = replace(
            found,
            **{side: corner},
            why_not=found.why_not | ({side: reason} if reason else {}),
        )
    return found


def with_borrowed_plateau(branch: BranchTangents, other: BranchTangents, side: str) -> BranchTangents:
    """The branch with the missing corner of a side from the plateau of the other branch of its cycle."""
    lines = other.plateaus[side]
    donor: Corner | None = getattr(other, side)
    corner = _corner(branch, lines, side, ()) if donor and not donor.borrowed else None
    if corner is None:
        return branch
    why_not = {k: v for k, v in branch.why_not.items() if k != side}
    return replace(branch, **{side: replace(corner, borrowed=True)}, why_not=why_not)


def _check(u: Array, y: Array) -> None:
    if not (np.isfinite(u).all() and np.isfinite(y).all()):
        raise UsageError("a reading of its temperature or output is not a number")
    if u.size < FEWEST_READINGS:
        raise UsageError(f"it has {u.size} readings, and tangents need at least {FEWEST_READINGS}")
    if np.ptp(u) == 0 or np.ptp(y) == 0:
        raise UsageError("its temperature or output is constant")


def _check_rise(shape: RoughShape, noise: ReadingNoise | None) -> None:
    least = _LEAST_RISE * (noise.sd if noise else 0.0)
    if abs(shape.rise) <= least or not shape.stands_out:
        raise UsageError("its curve is flat: no steep part stands out from the plateaus and the noise")


def _steep_lines(
    u: Array,
    y: Array,
    shape: RoughShape,
    noise: ReadingNoise | None,
    dice: np.random.Generator,
    *,
    noisy: bool,
) -> tuple[tuple[SteepLine, ...], tuple[Integers, ...]]:
    """The steep tangent of each choice, with its readings."""
    choices = steep_rows(shape.share, shape.centre)
    choices = choices if noisy else _steep_alone(u, y, choices)
    if not choices:
        raise UsageError(
            "fewer than three of its readings lie in the transformation: a steep tangent needs them"
        )
    widest, at = choices[-1], shape.output_at_centre
    on_steep = reading_noise(u[widest], y[widest])
    seen = noise is not None and on_steep.sd > _INPUT_NOISE * noise.sd and widest.size >= 5
    of_input = noisy or seen
    known = reading_noise(y[widest], u[widest]) if of_input else _at_least(on_steep, noise)
    drawn = known.draws(DRAWS, widest, u.size, dice)
    sd = known.sd * float(np.sqrt(known.inflation))
    pairs = [
        (steep_line(u, y, rows, at, drawn, sd, float(np.ptp(shape.share[rows])), of_input=of_input), rows)
        for rows in choices
    ]
    good = [
        (line, rows) for line, rows in pairs if line is not None and (of_input or line.du_dy * shape.rise > 0)
    ]
    good = _certain(good)
    if not good:
        raise UsageError(
            "its steep part has no slope of one sign: too few readings, or too much noise of the temperature"
        )
    return tuple(line for line, _ in good), tuple(rows for _, rows in good)


def _certain(found: list[tuple[SteepLine, Integers]]) -> list[tuple[SteepLine, Integers]]:
    """The choices without those whose slope is far less certain than that of the best: they have too few readings."""
    if not found:
        return found
    spread = [float(np.std(line.du_dy_draws)) for line, _ in found]
    return [pair for pair, sd in zip(found, spread) if sd <= _UNCERTAIN * min(spread)]


def _largest_jump(u: Array, share: Array) -> tuple[float, float, float]:
    steps = np.diff(np.clip(share, 0.0, 1.0))
    k = int(np.argmax(steps))
    return float(steps[k]), float(u[k]), float(u[k + 1])


def _steep_alone(u: Array, y: Array, choices: tuple[Integers, ...]) -> tuple[Integers, ...]:
    """The choices; of few readings, without those that are much flatter: they reach beyond the steep part."""
    if not choices or choices[-1].size >= _FEW_STEEP:
        return choices
    slopes = [abs(float(np.polyfit(y[r], u[r], 1)[0])) if np.ptp(y[r]) > 0 else np.inf for r in choices]
    return tuple(r for r, slope in zip(choices, slopes) if slope <= _FLATTER * min(slopes))


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
    draws = _with_choice(values, drawn, picked)
    line = lines[len(lines) // 2] if lines else pairs[0][1]
    rows = choices[len(lines) // 2] if choices else np.empty(0, dtype=np.int64)
    output_draws = _with_choice(outputs, drawn_outputs, picked)
    return Corner(value, draws, float(outputs.mean()), output_draws, line, rows)


def _with_choice(values: Array, drawn: Array, picked: Integers) -> Array:
    """Draws (B,) of the mean over choices: noise, and the spread of the choices beyond that of noise.

    ``values`` (W,) of the choices, ``drawn`` (W, B) with noise, ``picked`` (B,) one choice for each draw.
    """
    between = float(values.var())
    by_noise = float((drawn - values[:, None]).var(axis=0).mean())
    share = np.sqrt(max(0.0, between - by_noise) / between) if between > 0 else 0.0
    return np.asarray(drawn.mean(axis=0) + share * (values[picked] - values.mean()))


def _widest(choices: tuple[Integers, ...]) -> Integers:
    return max(choices, key=len) if choices else np.empty(0, dtype=np.int64)


def _pooled(noises: list[ReadingNoise]) -> ReadingNoise | None:
    """The noise of both plateaus together."""
    if not noises:
        return None
    degrees = sum(n.degrees for n in noises)
    return ReadingNoise(float(np.sqrt(sum(n.degrees * n.sd**2 for n in noises) / degrees)), degrees)


def _at_least(found: ReadingNoise, least: ReadingNoise | None) -> ReadingNoise:
    """The noise of a part, with the help of that of both plateaus where few readings determine it."""
    if least is None or found.degrees >= 8:
        return found
    pooled = _pooled([found, ReadingNoise(least.sd, min(least.degrees, 8.0))])
    return pooled or found
