"""The steep tangent of a branch for every choice of its readings."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, UsageError
from smarig.transformation.branch_noise import ReadingNoise, at_least, reading_noise
from smarig.transformation.fitted_line import SteepLine, SteepNoise, steep_line
from smarig.transformation.rough_shape import RoughShape
from smarig.transformation.tangent_ranges import ENOUGH_STEEP, JUMP, steep_rows

Integers = NDArray[np.int64]
_UNCERTAIN = 3.0  # times the standard deviation of the most certain slope
_FEW_STEEP = 8  # readings
_FLATTER = 1.4  # times the du/dy of the steepest choice, or neighbours
_END_SHARE = 0.02  # of the output: a logistic curve never reaches its ends
_INPUT_NOISE = 2.0  # times the plateaus' noise: more on the steep part is noise of the input


def steep_lines(
    u: Array,
    y: Array,
    shape: RoughShape,
    noise: ReadingNoise | None,
    dice: np.random.Generator,
    bend: Array,
    *,
    noisy: bool,
) -> tuple[tuple[SteepLine, ...], tuple[Integers, ...]]:
    """The steep tangent of each choice, with its readings."""
    choices = steep_rows(shape.share, shape.centre)
    if not noisy:
        choices = _as_steep_as_neighbours(u, y, shape.share, noise, _steep_alone(u, y, choices))
    if not choices:
        raise UsageError(
            "fewer than three of its readings lie in the transformation: a steep tangent needs them"
        )
    widest, at = choices[-1], shape.output_at_centre
    on_steep = reading_noise(u[widest], y[widest])
    seen = noise is not None and on_steep.sd > _INPUT_NOISE * noise.sd and widest.size >= 5
    of_input = noisy or seen
    known = reading_noise(y[widest], u[widest]) if of_input else at_least(on_steep, noise)
    noise_draws = known.draws(len(bend), widest, u.size, dice)
    drawn = SteepNoise(noise_draws, known.sd * float(np.sqrt(known.inflation)), bend)
    pairs = [
        (steep_line(u, y, rows, at, drawn, float(np.ptp(shape.share[rows])), of_input=of_input), rows)
        for rows in choices
    ]
    good = [
        (line, rows) for line, rows in pairs if line is not None and (of_input or line.du_dy * shape.rise > 0)
    ]
    if widest.size == 2 and good:
        return _between_two(good[0][0], shape.share[widest]), (widest,) * 3
    good = _certain(good)
    if not good:
        raise UsageError(
            "its steep part has no slope of one sign: too few readings, or too much noise of the temperature"
        )
    return tuple(line for line, _ in good), tuple(rows for _, rows in good)


def _steep_alone(u: Array, y: Array, choices: tuple[Integers, ...]) -> tuple[Integers, ...]:
    """The choices; of few readings, without those that are much flatter: they reach beyond the steep part."""
    if not choices or choices[-1].size >= _FEW_STEEP:
        return choices
    return _not_flatter(u, y, choices, min(_du_dy(u, y, rows) for rows in choices))


def _not_flatter(u: Array, y: Array, choices: tuple[Integers, ...], du_dy: float) -> tuple[Integers, ...]:
    """The choices that are not much flatter than a slope."""
    return tuple(rows for rows in choices if _du_dy(u, y, rows) <= _FLATTER * du_dy)


def _du_dy(u: Array, y: Array, rows: Integers) -> float:
    return abs(float(np.polyfit(y[rows], u[rows], 1)[0])) if np.ptp(y[rows]) > 0 else np.inf


def _as_steep_as_neighbours(
    u: Array, y: Array, share: Array, noise: ReadingNoise | None, choices: tuple[Integers, ...]
) -> tuple[Integers, ...]:
    """The steepest two neighbours with a fifth of the output between them, and the choices that are not much flatter.

    Somewhere between two readings, a curve is as steep as their chord (mean value theorem). A line through readings
    beyond them is flatter, and its corners lie too far apart. What noise may add to the chord does not count. Choices
    of four readings and more determine a tangent by themselves.
    """
    moved = np.abs(np.diff(y)) - 2.0 * np.sqrt(2.0) * (noise.sd if noise else 0.0)
    wide = (np.diff(np.clip(share, 0.0, 1.0)) > JUMP) & (moved > 0) & (np.diff(u) > 0)
    if not choices or not wide.any() or min(map(len, choices)) >= ENOUGH_STEEP:
        return choices
    chords = np.where(wide, np.diff(u) / np.where(wide, moved, 1.0), np.inf)
    k = int(np.argmin(chords))
    return np.array([k, k + 1]), *_not_flatter(u, y, choices, float(chords[k]))


def _between_two(chord: SteepLine, share: Array) -> tuple[SteepLine, ...]:
    """The tangents that the curve between two readings can have: their chord, if it is straight there; that of a
    logistic curve through both; and one that is steeper by as much again.
    """
    low, high = np.clip(share, _END_SHARE, 1 - _END_SHARE)
    steeper = float(4 * (high - low)) / float(np.log(high / (1 - high)) - np.log(low / (1 - low)))
    return tuple(
        replace(chord, du_dy=chord.du_dy * factor, du_dy_draws=chord.du_dy_draws * factor)
        for factor in (1.0, steeper, steeper**2)
    )


def _certain(found: list[tuple[SteepLine, Integers]]) -> list[tuple[SteepLine, Integers]]:
    """The choices without those whose slope is far less certain than that of the best: they have too few readings."""
    if not found:
        return found
    spread = [float(np.std(line.du_dy_draws)) for line, _ in found]
    return [pair for pair, sd in zip(found, spread) if sd <= _UNCERTAIN * min(spread)]
