"""Draws axes, lines, dots and text as one SVG figure that is readable on light and on dark pages.

Coordinates are in the units of the data. Colours have the same meaning as on report pages
(``smarig.report.components.style``): vermilion for rising input, blue for falling input, green for a model.
"""

from collections.abc import Iterable, Sequence
from html import escape

import numpy as np
from numpy.typing import ArrayLike

from smarig.report import style

# colours on light and on dark pages: the same hues, brighter on dark
_INKS = {
    "ink": (style.INK, "#e6e8eb"),
    "grey": (style.GREY, "#a3abb6"),
    "faint": (style.FAINT, "#3d434b"),
    "heat": (style.HEATING, "#ff8c42"),
    "cool": (style.COOLING, "#5db7f2"),
    "model": (style.MODEL, "#2ecc9c"),
    "third": (style.surface_colour("exponential"), "#f0b53a"),
    "ground": ("#ffffff", "#131416"),
}
PLAIN = (
    "svg{font:13px system-ui,-apple-system,'Segoe UI',Roboto,'Helvetica Neue',Arial,sans-serif}"
    ".line{fill:none;stroke-width:1.8;stroke-linejoin:round;stroke-linecap:round}.thin{stroke-width:1}"
    ".thick{stroke-width:2.8}.dash{stroke-dasharray:5 4}.dot{stroke-dasharray:1 4}.wash{fill-opacity:.16;stroke:none}"
    ".title{font-weight:650}.small{font-size:12px}.middle{text-anchor:middle}.end{text-anchor:end}"
    ".halo{paint-order:stroke;stroke:var(--ground);stroke-width:4px;stroke-linejoin:round}"
)


def _style() -> str:
    def inks(dark: bool) -> str:
        return "svg{" + "".join(f"--{name}:{pair[dark]};" for name, pair in _INKS.items()) + "}"

    uses = "".join(f".s-{n}{{stroke:var(--{n})}}.f-{n}{{fill:var(--{n})}}" for n in _INKS)
    return f"<style>{inks(False)}@media(prefers-color-scheme:dark){{{inks(True)}}}{PLAIN}{uses}</style>"


def tenths(value: float) -> str:
    """A coordinate rounded to tenths of a pixel, without trailing zeros.

    >>> tenths(12.04), tenths(-0.01), tenths(3.25001)
    ('12', '0', '3.3')
    """
    return f"{round(float(value), 1) + 0.0:g}"


def plain(value: float) -> str:
    """The number at a tick, with a true minus sign."""
    return f"{value:g}".replace("-", "−")


class Picture:
    """A figure of ``width`` × ``height`` pixels; ``words`` is its text alternative."""

    def __init__(self, width: int, height: int, words: str) -> None:
        self.width, self.height, self.words = width, height, words
        self.parts: list[str] = []

    def add(self, markup: str) -> None:
        """Add markup, in pixels."""
        self.parts.append(markup)

    def add_text(self, x: float, y: float, words: str, look: str = "f-ink") -> None:
        """Add text at a position in pixels."""
        self.add(f'<text x="{tenths(x)}" y="{tenths(y)}" class="{look}">{escape(words)}</text>')

    def svg(self) -> str:
        """The content of the SVG file."""
        size = f'width="{self.width}" height="{self.height}" viewBox="0 0 {self.width} {self.height}"'
        head = f'<svg xmlns="http://www.w3.org/2000/svg" {size} role="img">'
        ground = '<rect width="100%" height="100%" class="f-ground"/>'
        body = "\n".join(self.parts)
        return f"{head}\n<title>{escape(self.words)}</title>\n{_style()}\n{ground}\n{body}\n</svg>\n"


class Panel:
    """A frame at (left, top) of ``width`` × ``height`` pixels, with axes in the units of the data."""

    def __init__(
        self,
        picture: Picture,
        box: tuple[float, float, float, float],
        x: tuple[float, float],
        y: tuple[float, float],
        *,
        titles: tuple[str, str, str],
        ticks: tuple[Sequence[float], Sequence[float]],
    ) -> None:
        self.picture, self.x, self.y = picture, x, y
        self.left, self.top, self.width, self.height = box
        self._frame(titles, ticks)

    def _frame(self, titles: tuple[str, str, str], ticks: tuple[Sequence[float], Sequence[float]]) -> None:
        p, bottom = self.picture, self.top + self.height
        title, under, beside = titles
        for value in ticks[0]:
            u, _ = self.at(value, self.y[0])
            self._stroke(f"M{tenths(u)} {tenths(bottom)}v-5", "line thin s-ink")
            p.add_text(u, bottom + 16, plain(value), "small middle f-ink")
        for value in ticks[1]:
            _, v = self.at(self.x[0], value)
            self._stroke(f"M{tenths(self.left)} {tenths(v)}h5", "line thin s-ink")
            p.add_text(self.left - 6, v + 4, plain(value), "small end f-ink")
        box = f'x="{tenths(self.left)}" y="{tenths(self.top)}" width="{tenths(self.width)}"'
        p.add(f'<rect {box} height="{tenths(self.height)}" class="line thin s-ink"/>')
        p.add_text(self.left, self.top - 10, title, "title f-ink")
        p.add_text(self.left + self.width / 2, bottom + 34, under, "middle f-ink")
        if beside:
            x, y = tenths(self.left - 38), tenths(self.top + self.height / 2)
            turn = f'transform="translate({x} {y}) rotate(-90)"'
            p.add(f'<text {turn} class="middle f-ink">{escape(beside)}</text>')

    def at(self, x: float, y: float) -> tuple[float, float]:
        """The position of a point in pixels."""
        u = self.left + self.width * (x - self.x[0]) / (self.x[1] - self.x[0])
        v = self.top + self.height * (self.y[1] - y) / (self.y[1] - self.y[0])
        return u, v

    def _stroke(self, path: str, look: str) -> None:
        self.picture.add(f'<path d="{path}" class="{look}"/>')

    def _path(self, x: ArrayLike, y: ArrayLike) -> str:
        places = [self.at(a, b) for a, b in zip(np.asarray(x, float), np.asarray(y, float), strict=True)]
        return "M" + "L".join(f"{tenths(u)} {tenths(v)}" for u, v in places)

    def line(self, x: ArrayLike, y: ArrayLike, look: str = "s-ink") -> None:
        """Draw a line through points."""
        self._stroke(self._path(x, y), f"line {look}")

    def area(self, x: ArrayLike, y: ArrayLike, look: str = "wash f-ink") -> None:
        """Draw a closed area."""
        self._stroke(self._path(x, y) + "z", look)

    def dots(self, x: ArrayLike, y: ArrayLike, look: str = "f-ink", size: float = 2.6) -> None:
        """Draw a mark at each point, as one path."""
        places = [self.at(a, b) for a, b in zip(np.asarray(x, float), np.asarray(y, float), strict=True)]
        r = tenths(size)
        turn = f"a{r} {r} 0 1 0 {tenths(2 * size)} 0a{r} {r} 0 1 0 -{tenths(2 * size)} 0"
        self._stroke("".join(f"M{tenths(u - size)} {tenths(v)}{turn}" for u, v in places), look)

    def bars(self, x: ArrayLike, low: ArrayLike, high: ArrayLike, look: str = "thin s-ink") -> None:
        """Draw a vertical bar at each x."""
        ends = zip(np.asarray(x, float), np.asarray(low, float), np.asarray(high, float), strict=True)
        pairs = [(self.at(a, b), self.at(a, c)) for a, b, c in ends]
        path = "".join(f"M{tenths(p[0])} {tenths(p[1])}V{tenths(q[1])}" for p, q in pairs)
        self._stroke(path, f"line {look}")

    def cells(
        self, edges: ArrayLike, values: ArrayLike, look: str, top: float, steps: int = 10, least: float = 0.0
    ) -> None:
        """Draw square cells (row y, column x) between the edges; the opacity is proportional to value / ``top``.

        Values up to ``least``, and NaN, are omitted.
        """
        share = np.nan_to_num(np.asarray(values, float) - least) / (top - least)
        level = np.ceil(np.clip(share, 0, 1) * steps).astype(int)
        places = np.asarray(edges, float)
        for k in range(1, steps + 1):
            path = "".join(_runs(self, places, level == k))
            if path:
                self.picture.add(
                    f'<path d="{path}" class="{look}" fill-opacity="{k / steps:g}" shape-rendering="crispEdges"/>'
                )

    def arrow(self, start: tuple[float, float], end: tuple[float, float], look: str = "ink") -> None:
        """Draw an arrow between two points."""
        (u0, v0), (u1, v1) = self.at(*start), self.at(*end)
        direction = np.array([u1 - u0, v1 - v0]) / max(np.hypot(u1 - u0, v1 - v0), 1e-9)
        side, back = np.array([-direction[1], direction[0]]) * 4, np.array([u1, v1]) - 9 * direction
        neck = back + 2 * direction
        self._stroke(f"M{tenths(u0)} {tenths(v0)}L{tenths(neck[0])} {tenths(neck[1])}", f"line s-{look}")
        corners = [(u1, v1), tuple(back + side), tuple(back - side)]
        self._stroke("M" + "L".join(f"{tenths(a)} {tenths(b)}" for a, b in corners) + "z", f"f-{look}")

    def add_text(
        self, x: float, y: float, words: str, look: str = "f-ink", shift: tuple[float, float] = (0, 0)
    ) -> None:
        """Add text at a point, shifted by pixels; a halo keeps it readable over lines."""
        u, v = self.at(x, y)
        self.picture.add_text(u + shift[0], v + shift[1], words, f"halo {look}")


def _runs(panel: Panel, edges: np.ndarray, chosen: np.ndarray) -> Iterable[str]:
    """A rectangle for each row of adjacent chosen cells."""
    for i, row in enumerate(chosen):
        steps = np.diff(np.concatenate([[0], row.astype(int), [0]]))
        for j, k in zip(np.flatnonzero(steps == 1), np.flatnonzero(steps == -1)):
            corners = (*panel.at(edges[j], edges[i + 1]), *panel.at(edges[k], edges[i]))
            left, top, right, bottom = (round(place) for place in corners)  # whole pixels avoid seams
            yield f"M{left} {top}H{right}V{bottom}H{left}z"


def staircase(extrema: Sequence[float]) -> tuple[list[float], list[float]]:
    """The boundary of alternating extrema in the Preisach plane (β, α), up to the present input."""
    pairs = [(min(p), max(p)) for p in zip(extrema, extrema[1:])] + [(extrema[-1], extrema[-1])]
    return [b for b, _ in pairs], [a for _, a in pairs]
