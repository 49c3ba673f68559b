"""Axes for views that have none: a frame, ticks and labels, drawn in the units of the data, with y upward.

A plot lies in a box WIDTH × HEIGHT. Its transform (shift, scale) maps data units to that box, so a viewer's
tooltip shows data units.
"""

import math
from dataclasses import dataclass

import numpy as np

from smarig.live.colours import FAINT, GREY, INK
from smarig.live.primitives import Points, Polylines, Primitive, Transform

TICK = 0.018  # of the box
MARGIN = (0.17, 0.1, 0.29, 0.18)  # left, right, bottom, top, in heights of the box


@dataclass(frozen=True)
class Axis:
    """A quantity with its unit, and the range drawn."""

    label: str
    low: float
    high: float

    @property
    def ticks(self) -> list[float]:
        """Round numbers inside the range."""
        step = nice_step((self.high - self.low) / 5)
        first = math.ceil(self.low / step - 1e-9)
        return [k * step for k in range(first, math.floor(self.high / step + 1e-9) + 1)]


def nice_step(rough: float) -> float:
    """The next of 1, 2, 5 × 10ⁿ from ``rough`` up.

    >>> nice_step(34.8), nice_step(0.0021)
    (50.0, 0.005)
    """
    power = 10.0 ** math.floor(math.log10(rough))
    return next(float(f"{m * power:.6g}") for m in (1, 2, 5, 10) if m * power >= rough * (1 - 1e-9))


def rounded(label: str, low: float, high: float) -> Axis:
    """An axis that holds low…high with a small margin. Its ends are multiples of a fifth of a tick."""
    span = max(high - low, 1e-9 * max(abs(high), abs(low)), 1e-12)
    fifth = nice_step(span / 5) / 5
    return Axis(label, fifth * math.floor(low / fifth + 1e-9), fifth * math.ceil(high / fifth - 1e-9))


@dataclass(frozen=True)
class Plot:
    """A two-dimensional plot at a path. Its data go under ``path/plot``."""

    path: str
    x: Axis
    y: Axis
    width: float = 1.35
    height: float = 1.0

    @property
    def inside(self) -> str:
        """The path under which data are drawn in their own units."""
        return f"{self.path}/plot"

    @property
    def bounds(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """The range that a view must show, (x, y), with y downward as in viewers."""
        left, right, bottom, top = MARGIN
        return (-left, self.width + right), (-self.height - top, bottom)

    def primitives(self, *, grid: bool = True) -> list[Primitive]:
        """Transform, frame, grid, ticks and labels."""
        x, y = self.x, self.y
        sx, sy = self.width / (x.high - x.low), -self.height / (y.high - y.low)
        place = Transform(self.inside, None, np.array([[-x.low * sx, -y.low * sy, 0.0]]), scale=(sx, sy, 1.0))
        return [place, *(self._grid() if grid else []), *self._frame(), *self._labels()]

    def _grid(self) -> list[Primitive]:
        lines = [np.array([[t, self.y.low], [t, self.y.high]]) for t in self.x.ticks]
        lines += [np.array([[self.x.low, t], [self.x.high, t]]) for t in self.y.ticks]
        return [Polylines(f"{self.inside}/grid", None, lines, [FAINT] * len(lines), 0.6, -20.0)]

    def _frame(self) -> list[Primitive]:
        x, y = self.x, self.y
        dx, dy = TICK * (x.high - x.low) / self.width, TICK * (y.high - y.low) / self.height
        frame = [np.array([[x.low, y.high], [x.low, y.low], [x.high, y.low]])]
        frame += [np.array([[t, y.low], [t, y.low - dy]]) for t in x.ticks]
        frame += [np.array([[x.low, t], [x.low - dx, t]]) for t in y.ticks]
        return [Polylines(f"{self.inside}/frame", None, frame, [GREY] * len(frame), 1.2, -10.0)]

    def _labels(self) -> list[Primitive]:
        x, y = self.x, self.y
        dx, dy = (x.high - x.low) / self.width, (y.high - y.low) / self.height
        at = [(t, y.low - 0.045 * dy) for t in x.ticks] + [
            (x.low - 0.075 * dx, t + 0.028 * dy) for t in y.ticks
        ]
        texts = [f"{t:g}" for t in (*x.ticks, *y.ticks)]
        titles = [
            (x.low + 0.5 * (x.high - x.low), y.low - 0.165 * dy),
            (x.low + 0.1 * dx, y.high + 0.125 * dy),
        ]
        return [
            Points(f"{self.inside}/numbers", None, np.array(at), INK, texts=tuple(texts)),
            Points(f"{self.inside}/titles", None, np.array(titles), INK, texts=(x.label, y.label)),
        ]
