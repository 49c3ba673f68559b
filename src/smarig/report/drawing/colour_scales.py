"""Colours, colour scales and symbols of Plotly's schema in those of Matplotlib."""

import re
from functools import cache
from typing import Any

from matplotlib.colors import Colormap, LinearSegmentedColormap

_RGB = re.compile(r"rgba?\(([^)]*)\)")
_SYMBOLS = {
    "circle": "o",
    "square": "s",
    "diamond": "D",
    "triangle-up": "^",
    "x": "X",
    "cross": "P",
    "star": "*",
    "hexagon": "h",
    "hexagram": "H",
    "x-thin": "x",
    "arrow": "^",
}
_DASHES = {
    "solid": "-",
    "dash": (0, (5, 3)),
    "dot": (0, (1.2, 2)),
    "dashdot": (0, (5, 2, 1.2, 2)),
    "longdash": (0, (8, 3)),
    "longdashdot": (0, (8, 3, 1.2, 3)),
}


def colour(value: Any) -> Any:
    """A colour in Matplotlib's notation: "rgba(33,102,172,.14)" as a tuple, others as they are.

    >>> colour("rgba(255,0,0,.5)"), colour("#123456")
    ((1.0, 0.0, 0.0, 0.5), '#123456')
    """
    found = _RGB.fullmatch(value) if isinstance(value, str) else None
    if found is None:
        return value
    parts = [float(part) for part in found[1].split(",")]
    return (*(part / 255 for part in parts[:3]), *parts[3:])


def dash(style: str) -> Any:
    """The dash pattern of a line: a name, or lengths as "7px,5px"."""
    if style in _DASHES:
        return _DASHES[style]
    return (0, tuple(float(part.removesuffix("px")) for part in style.split(",")))


def symbol(name: str) -> tuple[str, bool]:
    """The marker of a symbol, and whether it is filled."""
    kind, is_open = name.removesuffix("-open"), name.endswith("-open")
    return _SYMBOLS[kind], not is_open


def colour_map(scale: Any) -> Colormap:
    """The colour map of a scale: its name, or its stops."""
    if isinstance(scale, str):
        return _named(scale.lower())
    return _of_stops(tuple((float(at), str(shade)) for at, shade in scale))


@cache
def _named(name: str) -> Colormap:
    from matplotlib import colormaps

    return colormaps[name]


@cache
def _of_stops(stops: tuple[tuple[float, str], ...]) -> Colormap:
    return LinearSegmentedColormap.from_list("stops", list(stops))
