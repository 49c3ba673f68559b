"""The Preisach operator relay by relay as in its definition (3.1), and the thesis's surface as printed.

An independent reference for ``smarig.preisach``: it shares no code with it and has no stack. The plane is
cut into cells along a set of levels. An input that visits only levels switches whole cells, so a cell is one
relay that carries the cell's share of the measure ν of theory §1; cells on the diagonal α = β include the
reversible part. Cells cut by α + β = 2ℓ are two relays.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

# Table 5.1 as printed: x2, x3, x4, x5 (, x6, x7); form; smallest and largest input; output at either.
TABLE_5_1 = {
    "one_c": ((0.0483, -47.2120, 0.1041, -23.7060), "c", (0.0, 174.1), (0.0, 12.54)),
    "one_p": ((0.0439, -44.1660, 0.0996, -0.0010, 0.2392, -36.3101), "p", (0.0, 174.1), (0.0, 12.54)),
    "one_e": ((0.0394, -43.0003, 0.1034, 269.6849, 0.0765, -23.6099), "e", (0.0, 174.1), (0.0, 12.54)),
    "two_c": ((0.0255, -16.7731, 0.0330, 38.4726), "c", (-185.0, 185.0), (-16.5234, 18.1055)),
    "two_p": (
        (0.0297, -25.0694, 0.0344, 0.0017, -0.4900, 68.6903),
        "p",
        (-185.0, 185.0),
        (-16.5234, 18.1055),
    ),
    "two_e": (
        (0.0293, -24.2772, 0.0343, 27.2773, 0.0207, 36.0267),
        "e",
        (-185.0, 185.0),
        (-16.5234, 18.1055),
    ),
}
Curve = Callable[[float, float], float]
NODES, WEIGHTS = np.polynomial.legendre.leggauss(20)


@dataclass(frozen=True)
class Printed:
    """Surface (5.5) with its exponentials as printed, y_β and y_αβ differentiated by hand from them."""

    name: str

    @property
    def lower(self) -> float:
        """u̲"""
        return TABLE_5_1[self.name][2][0]

    @property
    def upper(self) -> float:
        """ū"""
        return TABLE_5_1[self.name][2][1]

    @property
    def y_lower(self) -> float:
        """y(ū, u̲)"""
        return TABLE_5_1[self.name][3][0]

    @property
    def range(self) -> float:
        """y(ū, ū) − y(ū, u̲)"""
        return TABLE_5_1[self.name][3][1] - self.y_lower

    def f(self, a):
        """f_c, f_p or f_e, and its slope."""
        x, form = TABLE_5_1[self.name][:2]
        if form == "c":
            return x[3] + 0 * a, 0 * a
        if form == "p":
            return x[3] * a**2 + x[4] * a + x[5], 2 * x[3] * a + x[4]
        return x[3] * np.exp(-x[4] * a) + x[5], -x[3] * x[4] * np.exp(-x[4] * a)

    def s(self, a, b):
        """The fraction of (5.5)."""
        x2, x3, x4 = TABLE_5_1[self.name][0][:3]
        f, _ = self.f(a)
        at_lower, at_b = np.exp(-x4 * (self.lower + f)), np.exp(-x4 * (b + f))
        return (at_lower - at_b) / ((1 + np.exp(-x2 * (a + x3))) * (1 + at_b) * (1 + at_lower))

    def y(self, a, b):
        """ỹ(α, β)"""
        return self.range * self.s(a, b) / self.s(self.upper, self.upper) + self.y_lower

    def y_beta(self, a, b):
        """∂ỹ/∂β"""
        x2, x3, x4 = TABLE_5_1[self.name][0][:3]
        e = np.exp(-x4 * (b + self.f(a)[0]))
        first = 1 / (1 + np.exp(-x2 * (a + x3)))
        return self.range / self.s(self.upper, self.upper) * first * x4 * e / (1 + e) ** 2

    def y_alpha_beta(self, a, b):
        """∂²ỹ/∂α∂β = 2μ"""
        x2, x3, x4 = TABLE_5_1[self.name][0][:3]
        f, slope = self.f(a)
        e, d = np.exp(-x4 * (b + f)), np.exp(-x2 * (a + x3))
        growth = x2 * d / (1 + d) ** 2 * x4 * e / (1 + e) ** 2
        drift = slope * x4**2 * e * (e - 1) / (1 + e) ** 3 / (1 + d)
        return self.range / self.s(self.upper, self.upper) * (growth + drift)


@dataclass
class Relays:
    """Relays (n,): up at ``alpha``, down at ``beta``, output change ``nu`` on switching up; ``on`` or not."""

    alpha: np.ndarray
    beta: np.ndarray
    nu: np.ndarray
    on: np.ndarray
    u: float

    def drive(self, inputs: Iterable[float], y_lower: float) -> np.ndarray:
        """Outputs y = y₋ + Σ ν over relays that are on, one relay at a time, no memory but theirs."""
        outputs = []
        for u in inputs:
            self.go(u)
            outputs.append(y_lower + self.nu[self.on].sum())
        return np.array(outputs)

    def go(self, u: float) -> None:
        """Move monotonically to u."""
        if u > self.u:
            self.on[self.alpha <= u] = True
        if u < self.u:
            self.on[self.beta >= u] = False
        self.u = u


def cells(levels: np.ndarray, y: Curve, centre: float | None, half: Curve | None = None) -> Relays:
    """Relays of an FOD surface y(α, β) on the cells of a level grid, masses by inclusion and exclusion.

    Start: negative saturation (``centre`` None) or B_ℓ = {α = 2ℓ − β}; then levels must lie in pairs
    about ℓ where both lie in the range, and ``half(a0, b0, a1)`` is the mass of a cut cell below the cut.
    """
    rows = []
    for i in range(1, len(levels)):
        a0, a1 = levels[i - 1], levels[i]
        for j in range(i):
            b0, b1 = levels[j], levels[j + 1]
            whole = y(a1, b1) - y(a1, b0)
            if j < i - 1:
                whole += y(a0, b0) - y(a0, b1)
            if centre is None:
                rows.append((a1, b0, whole, False))
            elif j < i - 1 and abs(a1 + b0 - 2 * centre) < 1e-9:
                below = half(a0, b0, a1)
                rows += [(a1, b0, below, True), (a1, b0, whole - below, False)]
            else:
                rows.append((a1, b0, whole, a1 + b1 <= 2 * centre + 1e-9 or a1 <= centre + 1e-9))
    alpha, beta, nu, on = (np.array(column) for column in zip(*rows))
    return Relays(alpha, beta, nu, on, levels[0] if centre is None else centre)


def lower_half(density: Curve) -> Callable[[float, float, float], float]:
    """∬ of ``density`` (α, β) over a square cell below its antidiagonal, by iterated Gauss quadrature."""

    def mass(a0: float, b0: float, a1: float) -> float:
        width = a1 - a0
        b = b0 + width * (NODES + 1) / 2
        height = width - (b - b0)
        a = a0 + height[:, None] * (NODES + 1) / 2
        inner = (density(a, b[:, None]) * WEIGHTS).sum(axis=1) * height / 2
        return float((inner * WEIGHTS).sum() * width / 2)

    return mass


def histories(levels: np.ndarray, seed: int) -> dict[str, np.ndarray]:
    """Inputs on levels that visit every corner of the memory, each kind under its name."""
    rng = np.random.default_rng(seed)
    n = len(levels)
    walk = np.clip(np.cumsum(rng.integers(-2, 3, 1500)) + n // 2, 0, n - 1)
    shrinking = [k for pair in zip(range(n - 1, n // 2, -1), range(n // 2), strict=False) for k in pair]
    growing = shrinking[::-1]
    nested = [n - 2, 1, n - 3, 2, n - 4, 3, n - 4, 2, n - 3, 1, n - 2, 4, n // 2]
    again = [n - 2, 3, n - 1, 2, n - 3, 0, n - 4, 3, n - 1, n - 1, 0, 0, n - 2, 1, n - 4]
    jump = [n - 3, n - 4, n - 2, n // 2, n // 2 + 1, n // 2 - 1]  # past the last maximum in one move
    indices = {
        "random": rng.integers(0, n, 1500),
        "walk": walk,
        "shrinking and growing": shrinking + growing + shrinking,
        "nested": nested * 2,
        "saturation again": again + nested,
        "one jump past the last maximum": jump,
    }
    return {name: levels[np.asarray(k)] for name, k in indices.items()}
