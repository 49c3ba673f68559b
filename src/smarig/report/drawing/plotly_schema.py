"""Values, labels, colours, dashes and symbols of Plotly's schema in those of Matplotlib."""

import html
import re
from functools import cache
from typing import Any

import numpy as np
from matplotlib.colors import Colormap, LinearSegmentedColormap
from numpy.typing import NDArray

from smarig.core import printable
from smarig.report.components.figure import unpacked

Values = NDArray[Any]


def values(trace: dict[str, Any], key: str) -> Values:
    """The values under a key of a trace, or of its bars or markers: packed, numbers, or names."""
    given = trace[key]
    if isinstance(given, dict):
        return unpacked(given)
    return np.asarray(given)


def is_shown(trace: dict[str, Any]) -> bool:
    """Whether a trace is visible."""
    return trace.get("visible", True) is True


_SUB, _SUP = re.compile(r"(\w*)<sub>(.*?)</sub>"), re.compile(r"(\w*)<sup>(.*?)</sup>")
_TAG = re.compile(r"</?[a-z]+>")


def plain_text(text: object) -> str:
    """The label with indices and powers as mathematical text, line breaks as such, and without other tags.

    Characters that no font has are shown by their numbers: Matplotlib would print them in a warning.

    >>> plain_text("A<sub>s</sub> (K)<br>heating"), plain_text("a &amp; b $")
    ('$\\\\mathregular{A_{s}}$ (K)\\nheating', 'a & b \\\\$')
    >>> plain_text("mm\\x1b[2J\\t")
    'mm\\\\x1b[2J '
    """
    words = printable(str(text)).replace("\t", " ").replace("$", r"\$").replace("<br>", "\n")
    words = _SUB.sub(r"$\\mathregular{\1_{\2}}$", words)
    words = _SUP.sub(r"$\\mathregular{\1^{\2}}$", words)
    return html.unescape(_TAG.sub("", words))


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
