"""Primitives to draw, as plain values: where (``path``), when (``times_s``, None: always) and what.

They separate the modules that know the rig from the module that drives the viewer.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, Severity
from smarig.live.colours import Colour

Times = Array | None


@dataclass(frozen=True)
class SeriesLegend:
    """Names, with units, colours and widths, of the columns of a ``TimeSeries``."""

    path: str
    names: tuple[str, ...]
    colours: tuple[Colour, ...]
    widths_px: tuple[float, ...] = ()


@dataclass(frozen=True)
class TimeSeries:
    """Time series: values (n, k) at n times."""

    path: str
    times_s: Array
    values: Array


@dataclass(frozen=True)
class Polylines:
    """Polylines (m, 2) or (m, 3): all of them always, or one for each time. Without ``colours``, the colour
    comes from ``ColourChanges``."""

    path: str
    times_s: Times
    strips: Sequence[Array]
    colours: Sequence[Colour]
    width_px: float = 1.5
    draw_order: float = 0.0


@dataclass(frozen=True)
class ColourChanges:
    """The colour at each time of the one strip that is always at ``path``."""

    path: str
    times_s: Array
    colours: Sequence[Colour]


@dataclass(frozen=True)
class Points:
    """Points (m, 2) or (m, 3), always or one for each time, with optional labels. Radius 0: labels alone."""

    path: str
    times_s: Times
    points: Array
    colour: Colour
    radius_px: float = 0.0
    texts: tuple[str, ...] = ()
    draw_order: float = 0.0


@dataclass(frozen=True)
class Pixels:
    """Pixels (rows, columns, 3), RGB, one unit each; row 0 at the origin of ``path``."""

    path: str
    pixels: NDArray[np.uint8]


@dataclass(frozen=True)
class Transform:
    """Transform of everything under ``path``: shift (n, 3), turn about z (n,) in radians, or a fixed scale
    (3,)."""

    path: str
    times_s: Times
    shift: Array
    turn_rad: Array | None = None
    scale: tuple[float, float, float] | None = None


@dataclass(frozen=True)
class SolidBody:
    """A body that does not change: box (full sizes) or cylinder (radius, radius, length along z)."""

    path: str
    shape: Literal["box", "cylinder"]
    size: tuple[float, float, float]
    centre: tuple[float, float, float]
    colour: Colour


@dataclass(frozen=True)
class StateLane:
    """States, one for each time, lasting to the next."""

    path: str
    times_s: Array
    states: tuple[str, ...]


@dataclass(frozen=True)
class StateLegend:
    """Colours of a lane's states."""

    path: str
    colours: dict[str, Colour] = field(default_factory=dict)


@dataclass(frozen=True)
class TextLog:
    """Lines of text with their severities."""

    path: str
    times_s: Array
    texts: tuple[str, ...]
    severities: tuple[Severity, ...]


@dataclass(frozen=True)
class TextPage:
    """A text in Markdown."""

    path: str
    text: str


Primitive = (
    SeriesLegend
    | TimeSeries
    | Polylines
    | ColourChanges
    | Points
    | Pixels
    | Transform
    | SolidBody
    | StateLane
    | StateLegend
    | TextLog
    | TextPage
)


def point(*xyz: float) -> Array:
    """One point, shape (1, 3)."""
    return np.array([xyz], dtype=float)
