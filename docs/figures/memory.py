"""Figures of relay, boundary, wiping-out and congruency, drawn for the surface of the one-wire rig."""

import numpy as np

from figures.canvas import Panel, Picture, staircase
from smarig import Preisach
from smarig.preisach import thesis_surface

WIRE = thesis_surface("one_e")
RANGE = (0.0, WIRE.upper)
KELVIN, TRAVEL = (0, 50, 100, 150), (0, 4, 8, 12)
INPUT, OUTPUT = "T above ambient (K)", "position (mm)"


def loop(panel: Panel, turns: list[float], look: str = "", begin: int = 0) -> None:
    """Draw the path through ``turns`` from the cold state, rising vermilion and falling blue, from turn ``begin``."""
    wire, here = Preisach(WIRE), 0.0
    for k, turn in enumerate(turns):
        u = np.linspace(here, turn, max(2, int(abs(turn - here) / 1.5)))
        y = wire.follow(u)
        if k >= begin:
            panel.line(u, y, f"{look} s-{'heat' if turn > here else 'cool'}")
        here = turn


def graph(picture: Picture, left: float, title: str, wide: float = 290) -> Panel:
    """The axes of a hysteresis graph over the whole range."""
    titles = (title, INPUT, OUTPUT)
    return Panel(picture, (left, 34, wide, 250), RANGE, (-0.5, 13.2), titles=titles, ticks=(KELVIN, TRAVEL))


def plane(
    picture: Picture,
    box: tuple[float, float, float, float],
    title: str,
    axes: tuple[str, str] = ("β (K)", "α (K)"),
) -> Panel:
    """The axes of the Preisach plane with its diagonal."""
    titles = (title, *axes)
    ticks = (KELVIN, KELVIN if axes[1] else ())
    panel = Panel(picture, box, RANGE, RANGE, titles=titles, ticks=ticks)
    panel.line(RANGE, RANGE, "thin s-grey")
    return panel


def memory(panel: Panel, extrema: list[float]) -> None:
    """Draw the region of relays that are up, shaded, and its boundary."""
    beta, alpha = staircase(extrema)
    panel.area([0.0, *beta], [0.0, *alpha], "wash f-heat")
    panel.line(beta, alpha, "thick s-ink")
    panel.dots(beta[-1:], alpha[-1:], "f-ink", 4)


def relay() -> Picture:
    """One relay, the sum of 12, and the sum of 1500."""
    picture = Picture(
        740,
        300,
        "One relay switches up at alpha and down at beta; the sum of many relays is the loop of the wire.",
    )
    one = Panel(
        picture, (54, 34, 176, 214), (0, 100), (-1.5, 1.5),
        titles=("One relay", "u", "γ"), ticks=((30, 70), (-1, 1)),
    )  # fmt: skip
    one.line([0, 70, 70, 100], [-1.04, -1.04, 1, 1], "s-heat")
    one.line([100, 30, 30, 0], [1.04, 1.04, -1, -1], "s-cool")
    one.arrow((70, -0.5), (70, 0.25), "heat")
    one.arrow((30, 0.5), (30, -0.25), "cool")
    one.add_text(70, -1.5, "α", "middle f-heat", (0, -10))
    one.add_text(30, -1.5, "β", "middle f-cool", (0, -10))
    for left, count, title in ((300, 12, "12 relays"), (540, 1500, "1500 relays")):
        _sum_of_relays(picture, left, count, title)
    return picture


def _sum_of_relays(picture: Picture, left: float, count: int, title: str) -> None:
    """The loop of ``count`` relays of equal weight, sampled from the density and reversible part of the surface."""
    positive = thesis_surface("one_c")
    edges = np.linspace(0, positive.upper, 241)
    a, b = np.meshgrid(edges, edges, indexing="ij")
    F = np.asarray(positive.swept(np.maximum(a, b), b))
    mass = np.tril(F[1:, :-1] - F[:-1, :-1] - F[1:, 1:] + F[:-1, 1:]).clip(0)
    middle = (edges[1:] + edges[:-1]) / 2
    order = np.cumsum(mass.ravel()) / mass.sum()
    picked = np.searchsorted(order, (np.arange(count) + 0.5) / count)
    alpha, beta = middle[picked // 240], middle[picked % 240]
    weight = np.full(count, (positive.y_upper - positive.y_lower) / 2 / count)
    wire = Preisach.from_measure(alpha, np.minimum(alpha, beta), weight)
    u = np.linspace(0, positive.upper, 240)
    up, down = wire.follow(u), wire.follow(u[::-1])
    panel = Panel(
        picture, (left, 34, 190, 214), RANGE, (-0.5, 13.2),
        titles=(title, INPUT, OUTPUT if count == 12 else ""), ticks=(KELVIN, TRAVEL),
    )  # fmt: skip
    panel.line(u, up - up[0], "s-heat")
    panel.line(u[::-1], down - up[0], "s-cool")


def boundary() -> Picture:
    """The boundary after the inputs 0 → 120 → 40 → 80 K."""
    picture = Picture(
        740,
        300,
        "The boundary: a rising input moves a horizontal edge, a falling input a vertical one.",
    )
    moves = [0.0, 120.0, 40.0, 80.0]
    titles = ("rises to 120 K", "falls to 40 K", "rises to 80 K")
    for k, title in enumerate(titles):
        panel = plane(picture, (52 + 236 * k, 34, 204, 214), title, ("β (K)", "α (K)" if k == 0 else ""))
        memory(panel, moves[: k + 2])
        panel.add_text(98, 118, "down", "f-grey", (-70, -52 if k == 0 else -40))
        panel.add_text(18, 30, "up", "f-heat", (0, -16))
        beta, alpha = staircase(moves[: k + 2])
        if k == 0:
            panel.arrow((60, 70), (60, 117), "heat")
        elif k == 1:
            panel.arrow((110, 80), (43, 80), "cool")
            panel.area([40, 40, 120], [40, 120, 120], "wash f-cool")
        else:
            panel.arrow((60, 62), (60, 78), "heat")
        panel.dots(beta[1:-1], alpha[1:-1], "f-ink", 3)
    return picture


def wiping_out() -> Picture:
    """A minor loop closes and is wiped out; the output continues on the outer branch."""
    picture = Picture(
        740, 330, "Wiping-out: when a minor loop closes, its extrema disappear from the boundary."
    )
    turns = [140.0, 28.0, 60.0, 40.0, 90.0]
    left = graph(picture, 54, "position against temperature")
    loop(left, turns)
    wire = Preisach(WIRE)
    y = wire.simulate(turns)
    for k, (u, v) in enumerate(zip(turns, y)):
        left.dots([u], [v], "f-ink", 3)
        where = ((-4, 18), (-12, 4), (6, 14), (-14, -4), (7, 14))[k]
        left.add_text(u, v, "abcde"[k], "f-ink", where)
    right = plane(picture, (430, 34, 290, 250), "boundary before and after")
    memory(right, [0.0, 140.0, 28.0, 90.0])
    beta, alpha = staircase([0.0, 140.0, 28.0, 60.0, 40.0])
    right.line(beta, alpha, "dash s-grey")
    right.add_text(28, 140, "a, b", "f-ink", (8, -6))
    right.add_text(50, 38, "c, d: wiped out", "f-grey")
    right.add_text(90, 90, "e, now", "f-ink", (8, 14))
    return picture


def congruency() -> Picture:
    """Minor loops between 35 and 70 K after two histories: the same shape at two heights."""
    picture = Picture(
        740, 330, "Congruency: minor loops between the same inputs have the same shape for any history."
    )
    left = graph(picture, 54, "two histories, the same two inputs")
    low, high = 32.0, 62.0
    histories = {"lower": [high], "upper": [160.0]}
    shapes = []
    for before in histories.values():
        turns = [*before, low, high, low]
        loop(left, turns, "thin dash")
        loop(left, turns, "thick", begin=len(before) + 1)
        u = np.concatenate([np.linspace(low, high, 40), np.linspace(high, low, 40)])
        wire = Preisach(WIRE)
        wire.simulate([*before, low])
        shapes.append((u, wire.follow(u)))
    lift = shapes[1][1][0] - shapes[0][1][0]
    right = Panel(
        picture, (430, 34, 290, 250), (29, 65), (5.5, 9),
        titles=(f"upper loop shifted by −{lift:.2f} mm", INPUT, OUTPUT), ticks=((30, 40, 50, 60), (6, 7, 8, 9)),
    )  # fmt: skip
    (u, lower), (_, upper) = shapes
    for part, colour in ((slice(0, 40), "heat"), (slice(40, 80), "cool")):
        right.line(u[part], lower[part], f"s-{colour}")
        right.dots(u[part][::4], (upper - lift)[part][::4], f"f-{colour}", 3)
    for k, words in enumerate(("lines: the lower loop", "dots: the upper loop")):
        right.add_text(31, 8.7, words, "small f-ink", (0, 16 * k))
    return picture
