"""Straight lines by least squares, with the draws of their noise.

A tangent to a plateau is y = a + b u. The steep tangent is a line through (u₀, y₀) with the slope du/dy, so that a
vertical one needs no special case. It is the tangent of a cubic in the middle of its readings, since a line through
the steep part of a smooth curve is flatter than the curve at its steepest.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array

Integers = NDArray[np.int64]
_BEND = 0.4  # of share² of the linear term: standard deviation of the bent terms before the readings are seen


@dataclass(frozen=True, eq=False)
class PlateauLine:
    """y = a + b u, and the draws (B,) of a and b."""

    a: float
    b: float
    a_draws: Array
    b_draws: Array


@dataclass(frozen=True, eq=False)
class SteepLine:
    """The line through (u, y) with the slope du/dy, and the draws (B,) of u and du/dy at the same y."""

    u: float
    y: float
    du_dy: float
    u_draws: Array
    du_dy_draws: Array


@dataclass(frozen=True, eq=False)
class SteepNoise:
    """The noise of the readings of a steep part: draws (B, n), their standard deviation, and normal draws (B, 2) for
    what the bend of the curve could be.
    """

    draws: Array
    sd: float
    bend: Array

    def of(self, rows: Integers) -> "SteepNoise":
        """That of some rows."""
        return SteepNoise(self.draws[:, rows], self.sd, self.bend)


def plateau_line(u: Array, y: Array, rows: Integers, noise: Array) -> PlateauLine:
    """The line through the readings of a plateau. ``noise`` (B, n) is added to the outputs of all n rows."""
    design = np.vander(u[rows], 2, increasing=True)
    inverse = np.linalg.pinv(design)
    a, b = inverse @ y[rows]
    drawn = noise[:, rows] @ inverse.T
    return PlateauLine(float(a), float(b), a + drawn[:, 0], b + drawn[:, 1])


def steep_line(
    u: Array, y: Array, rows: Integers, at: float, noise: SteepNoise, share: float, *, of_input: bool
) -> SteepLine | None:
    """The tangent to the steep part where the output is ``at``; None if the readings have no slope there.

    ``share`` of the output lies within the readings. ``of_input``: the noise is that of the input, and u is fitted as
    a function of y; else y is fitted as a function of u.
    """
    if np.ptp(u[rows]) == 0 or np.ptp(y[rows]) == 0:
        return None
    if of_input:
        value, slope, u_draws, slopes = _at_zero(y[rows] - at, u[rows], noise.of(rows), share)
        return SteepLine(value, at, slope, u_draws, slopes)
    centre = _crossing(u[rows], y[rows], at)
    value, slope, y_draws, slopes = _at_zero(u[rows] - centre, y[rows], noise.of(rows), share)
    if slope == 0:
        return None
    return SteepLine(
        centre + (at - value) / slope, at, 1 / slope, centre + (at - y_draws) / slopes, 1 / slopes
    )


def _at_zero(x: Array, z: Array, noise: SteepNoise, share: float) -> tuple[float, float, Array, Array]:
    """Value and slope at x = 0 of a cubic through (x, z), and the draws (B,) of both.

    The two bent terms are pulled to zero, by a prior of about the size that they have in a logistic curve: over a
    share h of the output its cubic term is 0.4 h² of the linear one. Many exact readings override it; of few or noisy
    readings a line remains, and the draws contain what the bend could be.
    """
    scale = float(np.abs(x).max())
    design = np.vander(x / scale, 4, increasing=True)
    prior = _BEND * max(share, 0.2) ** 2 * float(np.ptp(z)) / 2
    weight = max(noise.sd, 1e-3 * prior) / prior
    bent = np.zeros((2, 4))
    bent[0, 2] = bent[1, 3] = weight
    inverse = np.linalg.pinv(np.vstack([design, bent]))[:2]
    value, slope = inverse[:, : x.size] @ z
    drawn = noise.draws @ inverse[:, : x.size].T + weight * prior * noise.bend @ inverse[:, x.size :].T
    return float(value), float(slope) / scale, value + drawn[:, 0], (slope + drawn[:, 1]) / scale


def _crossing(u: Array, y: Array, at: float) -> float:
    """The input at which a line through the readings reaches an output, kept inside the readings."""
    slope, level = np.polyfit(u - u.mean(), y, 1) if np.ptp(u) > 0 else (0.0, y.mean())
    guess = u.mean() + (at - level) / slope if slope else u.mean()
    return float(np.clip(guess, u.min(), u.max()))


def intersection(plateau: PlateauLine, steep: SteepLine) -> float:
    """The input at which a plateau's tangent and the steep tangent meet."""
    return (steep.u + steep.du_dy * (plateau.a - steep.y)) / (1 - steep.du_dy * plateau.b)


def intersection_draws(plateau: PlateauLine, steep: SteepLine) -> Array:
    """The draws (B,) of the intersection."""
    above = steep.u_draws + steep.du_dy_draws * (plateau.a_draws - steep.y)
    return above / (1 - steep.du_dy_draws * plateau.b_draws)
