"""Figures of the repetition of an interrupted step and of the lease, with the one-wire twin."""

import math

import numpy as np

from figures.canvas import Panel, Picture
from figures.memory import WIRE, graph, loop
from smarig import Preisach, Twin


def repeating() -> Picture:
    """An interrupted step repeated from the cold state, and after the input path that restores the memory."""
    picture = Picture(
        740,
        350,
        "Repeated from the cold state, a step ends at a wrong position; with restored memory it ends at the right one.",
    )
    return_path_K = [110.0, 38.0, 58.0]
    should = float(Preisach(WIRE).simulate(return_path_K)[-1])
    cold = float(Preisach(WIRE).simulate([110.0, 38.0, 50.0, 0.0, 58.0])[-1])
    back = float(Preisach(WIRE).simulate([110.0, 38.0, 50.0, 0.0, 110.0, 38.0, 58.0])[-1])
    left = graph(picture, 54, "cooled, step repeated")
    loop(left, return_path_K[:2], "thin dash")
    loop(left, [*return_path_K[:2], 50.0, 0.0], "thin dash", 2)
    loop(left, [*return_path_K[:2], 50.0, 0.0, 58.0], "thick", 4)
    right = graph(picture, 420, "cooled, memory restored, step repeated")
    loop(right, [0.0, *return_path_K[:2]], "thin dash")
    loop(right, [0.0, *return_path_K], "thick", 3)
    for panel, reached, words in (
        (left, cold, f"{cold - should:+.2f} mm"),
        (right, back, "correct position"),
    ):
        panel.dots([58.0], [should], "f-model", 5)
        panel.dots([58.0], [reached], "f-ink", 3)
        panel.add_text(58, reached, words.replace("-", "−"), "f-ink", (10, 14))
    left.add_text(58, should, "correct position", "f-model", (10, 4))
    picture.add_text(
        54, 342, "dashed: earlier inputs and restoring path; thick: the repeated step", "small f-grey"
    )
    return picture


def lease() -> Picture:
    """The host stops at 0.8 A: the amplifier holds the current for its lease, then the wire cools."""
    picture = Picture(
        740,
        270,
        "After the last command of the host the current flows for one lease; then it is zero and the wire cools.",
    )
    t = np.arange(0, 31) / 10
    output = np.array([_silent(float(s)) for s in t])
    twin = Twin.named("one_wire_twin")
    lease_s, tau = twin.file.lease_s, twin.actuator.tau_s
    hot = twin.actuator.input_for(0.8)
    left = Panel(
        picture, (58, 34, 290, 180), (-1, 3), (0, 1.15),
        titles=("amplifier", "time since the last command (s)", "current (A)"),
        ticks=((-1, 0, 1, 2, 3), (0, 0.4, 0.8)),
    )  # fmt: skip
    left.area([0, 0, lease_s, lease_s], [0, 1.15, 1.15, 0], "wash f-third")
    ends = np.concatenate([[-1.0], np.repeat(t[1:-1], 2), t[-1:]])
    left.line(ends, np.repeat(output[1:], 2))
    left.dots(np.arange(-10, 1) / 10, np.full(11, 0.92), "f-cool", 2)
    left.add_text(-1, 0.92, "host", "small f-cool", (4, -8))
    left.add_text(lease_s / 2, 0.1, f"lease, {lease_s:g} s", "small middle f-ink")
    right = Panel(
        picture, (430, 34, 290, 180), (-5, 30), (0, 130),
        titles=("wire", "time since the last command (s)", "T above ambient (K)"),
        ticks=((0, 10, 20, 30), (0, 50, 100)),
    )  # fmt: skip
    s = np.linspace(-5, 30, 141)
    right.area([0, 0, lease_s, lease_s], [0, 130, 130, 0], "wash f-third")
    right.line(s, [hot * math.exp(-max(v - lease_s, 0) / tau) for v in s], "s-heat")
    right.add_text(lease_s + tau, hot / math.e, f"τ = {tau:.1f} s", "small f-heat", (8, -4))
    return picture


def _silent(seconds: float) -> float:
    """The output of the twin (A) at a time after the last command."""
    twin = Twin.named("one_wire_twin", noise=False)
    for _ in range(5):
        twin.step(0.8)
    twin.idle(seconds)
    return twin.output_A
