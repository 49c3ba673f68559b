"""A hysteresis loop as a small inline SVG drawing without script, for lists and notebooks."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, spaced
from smarig.report.components.html import Html, escaped, joined, tag
from smarig.report.components.numbers import number
from smarig.report.components.style import COOLING, FAINT, HEATING, INK

WIDTH_PX, HEIGHT_PX = 220, 150
_TEXT = "#4b5563"
_LARGEST = 1e12
_LEFT, _RIGHT, _TOP, _BOTTOM = 8, 8, 16, 18


@dataclass(frozen=True)
class Frame:
    """The ranges of inputs and outputs of a drawing. Drawings with the same frame can be compared."""

    u: tuple[float, float]
    y: tuple[float, float]


def frame_of(u: Array, y: Array) -> Frame:
    """The frame that a loop fills; a range of zero length is extended by 0.5 to both sides."""
    drawn = _drawable(u, y)
    if not drawn.any():
        return Frame((-0.5, 0.5), (-0.5, 0.5))
    ends = [(float(v.min()), float(v.max())) for v in (u[drawn], y[drawn])]
    known = [(low, high) if high > low else (low - 0.5, low + 0.5) for low, high in ends]
    return Frame(known[0], known[1])


def thumbnail(
    u: Array, y: Array, words: str, units: tuple[str, str], label: str = "", frame: Frame | None = None
) -> Html:
    """The loop through points u, y (k,), rising and falling in two colours; ``words`` is its text alternative.

    ``units`` are the units of input and output; ``label`` marks simulated data.
    """
    drawn = _drawable(u, y)
    u, y = u[drawn], y[drawn]
    if not u.size:
        return Html("")
    shown = frame or frame_of(u, y)
    x = _scaled(u, shown.u, _LEFT, WIDTH_PX - _RIGHT)
    z = _scaled(y, shown.y, HEIGHT_PX - _BOTTOM, _TOP)
    up = np.diff(u) > 0
    paths = [_svg_path(x, z, chosen, colour) for chosen, colour in ((up, HEATING), (~up, COOLING))]
    border = (_LEFT, _TOP, WIDTH_PX - _LEFT - _RIGHT, HEIGHT_PX - _TOP - _BOTTOM)
    box = '<rect x="{}" y="{}" width="{}" height="{}" fill="none" stroke="{}"/>'.format(*border, FAINT)
    return tag(
        "svg",
        Html(box),
        *(paths if u.size > 1 else [_dot(x[0], z[0])]),
        tag(
            "g", *_texts(shown, units, label), font_size="9", font_family="system-ui, sans-serif", fill=_TEXT
        ),
        viewBox=f"0 0 {WIDTH_PX} {HEIGHT_PX}",
        role="img",
        aria_label=f"{label}, simulated. {words}" if label else words,
    )


def _drawable(u: Array, y: Array) -> NDArray[np.bool_]:
    """Mask (k,) of the points of plausible size."""
    return (np.abs(u) <= _LARGEST) & (np.abs(y) <= _LARGEST)


def _scaled(values: Array, span: tuple[float, float], first: float, last: float) -> Array:
    return first + (last - first) * (values - span[0]) / (span[1] - span[0])


def _svg_path(x: Array, z: Array, chosen: NDArray[np.bool_], colour: str) -> Html:
    """The path of the chosen segments in tenths of a pixel; adjacent segments are joined."""
    pieces, at = [], -1
    for k in np.flatnonzero(chosen):
        start = "" if at == k else f"M{x[k]:.1f} {z[k]:.1f}"
        pieces.append(f"{start}L{x[k + 1]:.1f} {z[k + 1]:.1f}")
        at = k + 1
    return Html(f'<path d="{"".join(pieces)}" fill="none" stroke="{colour}"/>') if pieces else Html("")


def _dot(x: float, z: float) -> Html:
    return Html(f'<circle cx="{x:.1f}" cy="{z:.1f}" r="2" fill="{INK}"/>')


def _texts(shown: Frame, units: tuple[str, str], label: str) -> Sequence[Html]:
    """The ends of both axes with their units, and the label."""
    below, above = HEIGHT_PX - 5, _TOP - 5
    inputs, outputs = end_labels(shown.u), " to ".join(end_labels(shown.y))
    found = [
        _text(_LEFT, below, inputs[0]),
        _text(WIDTH_PX - _RIGHT, below, f"{inputs[1]}{spaced(units[0])}", 'text-anchor="end"'),
        _text(_LEFT, above, f"{outputs}{spaced(units[1])}"),
    ]
    if label:
        width = 7 * len(label) + 6
        found.append(
            Html(f'<rect x="{WIDTH_PX - _RIGHT - width}" y="1" width="{width}" height="13" fill="#f7c948"/>')
        )
        found.append(
            _text(WIDTH_PX - _RIGHT - 3, above, label, 'text-anchor="end" font-weight="700" fill="#111"')
        )
    return found


def end_labels(span: tuple[float, float]) -> tuple[str, str]:
    """Both ends of a range, with decimals according to its length.

    >>> end_labels((-0.0017, 12.6)), end_labels((0.02, 0.0345))
    (('0.0', '12.6'), ('0.0200', '0.0345'))
    """
    power = math.floor(math.log10(span[1] - span[0]))
    if not -4 < power < 5:
        return number(span[0]), number(span[1])
    places = max(0, 2 - power)
    first, last = (f"{round(v, places) + 0.0:.{places}f}".replace("-", "−") for v in span)
    return first, last


def _text(x: float, y: float, words: str, more: str = "") -> Html:
    return joined([Html(f'<text x="{x}" y="{y}" {more}>'), escaped(words), Html("</text>")])
