"""Figures of first-order curves, the Everett function, the density with its reversible part, and energy."""

import numpy as np

from figures.canvas import Panel, Picture
from figures.memory import INPUT, KELVIN, OUTPUT, RANGE, TRAVEL, WIRE, graph, plane
from smarig import Preisach
from smarig.preisach import thesis_surface
from smarig.theory import loop_area

REVERSALS_K = (27.8, 43.5, 62.7, 85.3, 111.4, 174.1)  # of the thesis's partition


def everett() -> Picture:
    """Six descending curves; F as a drop of one of them, and as a triangle in the Preisach plane."""
    picture = Picture(
        740, 330, "First-order descending curves, and the Everett function as a drop and as a triangle."
    )
    left = graph(picture, 54, "curves from α down to β")
    rise = np.linspace(0, WIRE.upper, 180)
    left.line(rise, WIRE.y(rise, rise), "s-heat")
    for alpha in REVERSALS_K:
        beta = np.linspace(0, alpha, 120)
        left.line(beta, WIRE.y(alpha, beta), "s-cool")
    alpha, beta = 85.3, 35.0
    top, low = float(WIRE.y(alpha, alpha)), float(WIRE.y(alpha, beta))
    left.line([beta, alpha], [top, top], "thin dash s-ink")
    left.line([alpha + 6, alpha + 6], [top, low], "thick s-model")
    left.line([beta, alpha + 6], [low, low], "thin dash s-ink")
    left.add_text(alpha, top, "α", "end f-ink", (-2, -5))
    left.add_text(beta, low, "β", "end f-ink", (-4, 10))
    left.add_text(alpha + 6, (top + low) / 2, f"F = {top - low:.2f} mm", "f-model", (7, 5))
    right = plane(picture, (430, 34, 290, 250), "F(α, β) is the weight of a triangle")
    right.area([beta, beta, alpha], [beta, alpha, alpha], "wash f-model")
    right.line([beta, beta, alpha], [beta, alpha, alpha], "s-model")
    right.dots([beta], [alpha], "f-model", 4)
    right.add_text(beta, alpha, f"(β, α) = ({beta:g}, {alpha:g})", "f-ink", (4, -10))
    return picture


def density() -> Picture:
    """μ over the Preisach plane, and the major loop with and without g."""
    picture = Picture(
        740,
        330,
        "The density of the one-wire rig's surface, and the loop with and without its reversible part.",
    )
    left = plane(picture, (54, 34, 270, 250), "μ (red positive, blue negative)")
    edges = np.linspace(0, WIRE.upper, 71)
    middle = (edges[1:] + edges[:-1]) / 2
    alpha, beta = np.meshgrid(middle, middle, indexing="ij")
    mu = np.where(alpha > beta, WIRE.density(alpha, beta), np.nan)
    top = float(np.nanmax(mu))
    for sign, look in ((mu, "f-heat"), (-mu, "f-cool")):
        left.cells(edges, sign, look, top, least=0.01 * top)
    left.line(RANGE, RANGE, "thin s-grey")
    left.add_text(174, 0, f"full colour: {top:.4f} mm/K²", "small end f-grey", (-8, -10))
    right = graph(picture, 420, "major loop with and without g", 300)
    u = np.linspace(0, WIRE.upper, 240)
    up = WIRE.y(u, u)
    wire = Preisach(WIRE)
    wire.step(WIRE.upper)
    down = wire.follow(u[::-1])
    g = np.concatenate(
        [[0.0], np.cumsum(np.diff(u) * (WIRE.reversible(u[1:]) + WIRE.reversible(u[:-1])) / 2)]
    )
    right.line(u, up, "s-heat")
    right.line(u[::-1], down, "s-cool")
    right.line(u, up - g, "dash s-heat")
    right.line(u[::-1], down - g[::-1] - (down - g[::-1])[-1], "dash s-cool")
    share = g[-1] / (WIRE.y_upper - WIRE.y_lower)
    right.add_text(
        174, 0.6, f"dashed: μ alone, stroke {100 * share:.1f} % too small", "small end f-ink", (-8, 0)
    )
    return picture


def energy() -> Picture:
    """The area of a loop, which is the energy of a cycle, and the areas of all loops of two surfaces."""
    picture = Picture(
        740, 288, "Areas of all loops of two surfaces: those of one are not negative, some of the other are."
    )
    low, high = 25.0, 90.0
    left = Panel(
        picture, (54, 34, 196, 204), RANGE, (-0.5, 13.2),
        titles=("one loop", INPUT, OUTPUT), ticks=(KELVIN, TRAVEL),
    )  # fmt: skip
    u = np.linspace(low, high, 80)
    wire = Preisach(WIRE)
    wire.simulate([high, low])
    up, down = wire.follow(u), wire.follow(u[::-1])
    left.area(np.concatenate([u, u[::-1]]), np.concatenate([up, down]))
    left.line(u, up, "s-heat")
    left.line(u[::-1], down, "s-cool")
    area = float(loop_area(WIRE, high, low))
    left.add_text(high, up[-1], f"∮ u dy = {area:.0f} mm·K", "f-ink", (-40, 84))
    for k, name in enumerate(("one_e", "one_p")):
        _loop_areas(picture, 304 + 226 * k, name, "M (K)" if k == 0 else "")
    return picture


def _loop_areas(picture: Picture, left: float, name: str, beside: str) -> None:
    """A(M, m) of all loops m ↔ M of one surface, with separate scales for each sign."""
    chosen = thesis_surface(name)
    panel = plane(picture, (left, 34, 204, 204), f"loop areas of {name}", ("m (K)", beside))
    edges = np.linspace(0, chosen.upper, 45)
    middle = (edges[1:] + edges[:-1]) / 2
    area = np.array([[_area(chosen, M, m) for m in middle] for M in middle])
    panel.cells(edges, area, "f-model", float(np.nanmax(area)), 8)
    panel.cells(edges, -np.where(area < -1e-9, area, np.nan), "f-heat", 0.05, 4)
    panel.line(RANGE, RANGE, "thin s-grey")
    words = "no negative area" if np.nanmin(area) > -1e-9 else "red: negative areas"
    panel.add_text(174, 0, words, "small end f-ink", (-8, -10))


def _area(chosen, M: float, m: float) -> float:
    return float(loop_area(chosen, M, m)) if m < M else float("nan")
