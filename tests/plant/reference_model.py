"""The complete base model on one page, written from theory §1 and §3 alone: current in, position out.

Heating (5.1) in closed form over the whole record, the Preisach operator as an integral over its boundary,
and the pulley. It is slow and simple on purpose: every sample is computed from the whole history without a
stored memory, so that it can be compared with the thesis and with ``smarig.plant``.

    u = T₁ − T₂,   T(t) = Σ_k T_ss,k (e^(−(t−t_k)/τ) − e^(−(t−t_{k−1})/τ)),   T_ss = R i²/(hA)
    y(t) = y₋ + ∫_{u₋}^{u(t)} ∂_βy(b(β), β) dβ

b(β) is the boundary between P₊ and P₋ above β: the largest input since u was last ≤ β (since the start if it
never was), or the initial boundary where that is higher. ∂_βy(b, β) is ν of the strip β ≤ α ≤ b.
"""

import math
from itertools import pairwise

import numpy as np

from preisach.relay_reference import NODES, WEIGHTS, Printed

ARRANGEMENTS = {  # theory §3: mean R in Ω, length in m, kelvin above ambient at 1 A
    "gorbet_one_wire": {"R": 4.75, "L": 0.38, "T": 174.1, "two_wire": False},
    "gorbet_two_wire": {"R": 2.0, "L": 0.15, "T": 185.0, "two_wire": True},
}
DIAMETER_M, DENSITY, SPECIFIC_HEAT = 0.3e-3, 6450.0, 840.0


def input_along(rig: str, current_A: np.ndarray, dt_s: float) -> np.ndarray:
    """u (n,) in kelvin at the end of each tick of a piecewise constant current (n,), cold at the start."""
    wire = ARRANGEMENTS[rig]
    hA = wire["R"] / wire["T"]  # the steady state at 1 A gives the heat loss
    volume_m3 = math.pi / 4 * DIAMETER_M**2 * wire["L"]
    tau_s = DENSITY * SPECIFIC_HEAT * volume_m3 / hA
    steady = wire["R"] * np.asarray(current_A) ** 2 / hA
    if wire["two_wire"]:
        steady = np.where(np.asarray(current_A) < 0, -steady, steady)  # diodes: one wire at a time
    n = steady.size
    age_s = dt_s * (np.arange(n)[:, None] - np.arange(n))
    weight = np.where(age_s >= 0, np.exp(-age_s / tau_s) - np.exp(-(age_s + dt_s) / tau_s), 0.0)
    return weight @ steady


def output_along(surface: str, inputs: np.ndarray, anhysteretic: bool) -> np.ndarray:
    """y (n,) for inputs (n,), from negative saturation or from B* = {α = −β} with u = 0."""
    p = Printed(surface)
    past = [0.0 if anhysteretic else p.lower]
    outputs = []
    for u in np.clip(inputs, p.lower, p.upper).tolist():
        past.append(u)
        outputs.append(p.y_lower + _area(p, np.array(past), anhysteretic))
    return np.array(outputs)


def _area(p: Printed, past: np.ndarray, anhysteretic: bool) -> float:
    """∫ ∂_βy(b(β), β) dβ below the present input, between the inputs where b may jump."""
    u = past[-1]
    edges = np.unique(np.concatenate([past, -past, [p.lower]]))
    edges = edges[(edges >= p.lower) & (edges <= u)]
    total = 0.0
    for low, high in pairwise(edges):
        middle = (low + high) / 2
        visits = np.flatnonzero(past <= middle)
        since = past[visits[-1] :].max() if visits.size else past.max()
        if anhysteretic and not visits.size and -middle > since:
            total += _along_the_diagonal(p, low, high)
        else:
            total += p.y(since, high) - p.y(since, low)
    return total


def _along_the_diagonal(p: Printed, low: float, high: float) -> float:
    """∫ ∂_βy(−β, β) dβ, by Gauss quadrature in panels of at most 10 K."""
    edges = np.linspace(low, high, math.ceil((high - low) / 10) + 1)
    half = np.diff(edges)[:, None] / 2
    b = edges[:-1, None] + half * (1 + NODES)
    return float(np.sum(p.y_beta(-b, b) * WEIGHTS * half))


def counts_along(rig: str, position: np.ndarray, counts_per_rev: int = 2000) -> np.ndarray:
    """Encoder counts (n,), unrounded: the 3 cm pulley turns mm into angle; the two-wire rig reads degrees."""
    per_turn = 360.0 if ARRANGEMENTS[rig]["two_wire"] else math.pi * 30.0
    return position / per_turn * counts_per_rev
