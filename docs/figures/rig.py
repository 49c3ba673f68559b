"""Figures of the thermal lag and of initialisation, drawn with the noise-free twin and its surfaces."""

import math

import numpy as np

from figures.canvas import Panel, Picture, staircase
from figures.memory import OUTPUT
from smarig import Preisach, Twin
from smarig.preisach import thesis_surface

NEAR_K, WINDOW_S = 0.01, 25.0  # of ``Settled``
TWO = thesis_surface("two_e")
SPAN = (-TWO.upper, TWO.upper)
SIGNED = (-150, -75, 0, 75, 150)


def lag() -> Picture:
    """The step response to a current with its settled window, and slow and fast loops of the current."""
    picture = Picture(
        740, 330, "The wire follows a step with its time constant; fast loops drift, slow loops close."
    )
    _step(picture)
    right = Panel(
        picture, (424, 34, 290, 250), (36, 104), (0, 13),
        titles=("loops of the current, 0.5 to 0.75 A", "steady temperature of the current (K)", OUTPUT),
        ticks=((40, 60, 80, 100), (4, 6, 8, 10)),
    )  # fmt: skip
    for loop_s, look in ((8.0, "s-third"), (480.0, "s-ink")):
        right.line(*_loops(loop_s), look)
    right.add_text(46, 11.9, "5 loops of 8 min", "small f-ink")
    right.add_text(42, 7.3, "5 loops of 8 s", "small f-third")
    return picture


def _step(picture: Picture) -> None:
    twin = Twin.named("one_wire_twin", seed=1)
    for _ in range(1200):
        twin.step(0.5)
    y = np.array([twin.step(0.7)[0].position for _ in range(800)])
    t = np.arange(1, 801) / 10
    tau = twin.actuator.tau_s
    u0, u1 = twin.actuator.input_for(0.5), twin.actuator.input_for(0.7)
    near = tau * math.log((u1 - u0) / NEAR_K)
    panel = Panel(
        picture, (54, 34, 290, 250), (0, 80), (5.2, 11),
        titles=(f"a step from {u0:.1f} to {u1:.1f} K", "time after the step (s)", OUTPUT),
        ticks=((0, 20, 40, 60, 80), (6, 8, 10)),
    )  # fmt: skip
    panel.area([near, near, near + WINDOW_S, near + WINDOW_S], [5.2, 11, 11, 5.2], "wash f-model")
    panel.line([tau, tau], [5.2, 11], "thin dash s-grey")
    panel.dots(t[::4], y[::4], "f-cool", 1.6)
    panel.add_text(tau, 7.4, f"τ = {tau:.1f} s", "small f-grey", (5, 0))
    panel.add_text(near, 6.4, "window of 25 s,", "small f-model", (5, 0))
    panel.add_text(near, 6.4, "mean recorded", "small f-model", (5, 16))
    panel.add_text(near, 5.4, f"within {NEAR_K} K", "small end f-grey", (-5, 0))


def _loops(loop_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Steady temperature of the current, and position of the noise-free twin, in five triangular loops."""
    twin = Twin.named("one_wire_twin", noise=False)
    half = round(loop_s / 2 / twin.period_s)
    rise = np.linspace(0, 0.75, half + 1)[1:]
    down = np.linspace(0.75, 0.5, half + 1)[1:]
    current = np.concatenate([rise, *[np.concatenate([down, down[::-1]])] * 5])
    y = np.array([twin.step(float(i))[0].position for i in current])
    steady = np.array([twin.actuator.input_for(float(i)) for i in current])
    every = max(1, half // 40)
    return steady[half - 1 :: every], y[half - 1 :: every]


def initialisation() -> Picture:
    """The state after a decaying oscillation near B*; the state B_ℓ; and ψ(ℓ)."""
    picture = Picture(740, 300, "A decaying oscillation leaves a fine staircase near the anhysteretic state.")
    swing = [185 * (1 - k / 36) * (-1) ** k for k in range(1, 37)]
    first = _plane(picture, 54, "after 18 decaying cycles", "α (K)")
    beta, alpha = staircase([-185.0, 185.0, *swing])
    first.area([-185, *beta], [-185, *alpha], "wash f-heat")
    first.line(beta, alpha, "s-ink")
    first.line([-185, 0], [185, 0], "dash s-model")
    first.add_text(-60, 130, "B*: α = −β", "f-model", (4, 0))
    centre = 40.0
    second = _plane(picture, 290, f"the state B_ℓ, ℓ = {centre:g} K", "")
    second.area([-185, -185, 2 * centre - 185, centre], [-185, 185, 185, centre], "wash f-heat")
    second.line([2 * centre - 185, centre], [185, centre], "thick s-model")
    second.dots([centre], [centre], "f-ink", 4)
    second.add_text(centre, centre, "(ℓ, ℓ)", "f-ink", (8, 14))
    third = Panel(
        picture, (566, 34, 160, 214), SPAN, (-18, 20),
        titles=("output ψ(ℓ) of B_ℓ", "ℓ (K)", "angle (°)"), ticks=((-150, 0, 150), (-10, 0, 10)),
    )  # fmt: skip
    wire = Preisach(TWO)
    places = np.linspace(*SPAN, 120)
    third.line(places, [wire.go_to_diagonal(float(c)) for c in places], "s-model")
    zero = wire.go_to_diagonal(0.0)
    third.dots([0], [zero], "f-ink", 4)
    third.add_text(0, zero, f"{zero:.2f}°", "small f-ink", (8, 10))
    return picture


def _plane(picture: Picture, left: float, title: str, beside: str) -> Panel:
    ticks = (SIGNED[::2], SIGNED[::2] if beside else ())
    panel = Panel(picture, (left, 34, 204, 214), SPAN, SPAN, titles=(title, "β (K)", beside), ticks=ticks)
    panel.line(SPAN, SPAN, "thin s-grey")
    return panel
