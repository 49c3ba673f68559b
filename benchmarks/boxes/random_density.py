"""Random hystereses: non-negative densities of various shapes, as relays at continuous random thresholds.

They are mixtures of lognormal widths and normal centres, ridges along the diagonal, humps, and reversible
parts.
"""

from dataclasses import dataclass

import numpy as np

from benchmarks.boxes.relays import Array, RelayHysteresis
from benchmarks.boxes.wire import BoxWire

_FEWEST, _MOST = 20_000, 60_000
_SHAPES = ("bumps", "bumps", "bumps", "bumps", "ridge", "humps", "reversible")
_ODD_SHAPES = ("ridge", "humps", "reversible")


@dataclass(frozen=True)
class _Bump:
    """A part of a density in kelvin: widths α − β lognormal, centres normal (or uniform, for a ridge)."""

    weight: float
    width_K: float
    spread: float
    middle_K: float
    scatter_K: float
    even: bool = False

    def relays(self, rng: np.random.Generator, n: int) -> tuple[Array, Array]:
        width = self.width_K * np.exp(self.spread * rng.standard_normal(n))
        place = rng.uniform(-2, 2, n) if self.even else rng.standard_normal(n)
        middle = self.middle_K + self.scatter_K * place
        return middle + width / 2, middle - width / 2


def random_hysteresis(rng: np.random.Generator, wire: BoxWire, *, odd: bool) -> RelayHysteresis:
    """A hysteresis within the reach of the wire's current; ``odd``: with a shape that bumps do not have."""
    shape = str(rng.choice(_ODD_SHAPES if odd else _SHAPES))
    bumps = _bumps(rng, wire, shape)
    n = int(rng.integers(_FEWEST, _MOST))
    weights = np.array([bump.weight for bump in bumps])
    counts = rng.multinomial(n, weights / weights.sum())
    parts = [_within(bump, rng, int(k), wire) for bump, k in zip(bumps, counts) if k]
    alpha, beta = (np.concatenate(column) for column in zip(*parts))
    stroke = rng.uniform(60, 120) if wire.two_wire else rng.uniform(8, 14)
    mass = rng.integers(500, 1500, alpha.size).astype(float)
    return RelayHysteresis(alpha, beta, mass, stroke, -stroke / 2 if wire.two_wire else 0.0)


def _limits(wire: BoxWire) -> tuple[float, float]:
    """The range of relays: what full current switches with a margin, and what cold air undoes."""
    high = 0.86 * wire.reference_K
    return (-high, high) if wire.two_wire else (6.0, high)


def _bumps(rng: np.random.Generator, wire: BoxWire, shape: str) -> list[_Bump]:
    low, high = _limits(wire)
    middle = 0.0 if wire.two_wire else low + rng.uniform(0.4, 0.6) * (high - low)
    usual_K = rng.uniform(20, 60) if wire.two_wire else rng.uniform(6, 28)
    if shape == "ridge":
        ridge = _Bump(rng.uniform(0.3, 0.7), rng.uniform(1, 3), 0.3, middle, (high - low) / 6, even=True)
        return [ridge, _bump(rng, usual_K, middle)]
    if shape == "humps":
        apart = rng.uniform(0.1, 0.2) * (high - low)
        return [_bump(rng, usual_K, middle - apart, 0.4), _bump(rng, usual_K, middle + apart, 0.4)]
    bumps = [_bump(rng, usual_K, middle) for _ in range(int(rng.integers(1, 5)))]
    if shape == "reversible" or rng.random() < 0.3:
        total = sum(bump.weight for bump in bumps)
        share = rng.uniform(0.05, 0.25) * total
        bumps.append(_Bump(share, 0.05, 0.5, middle, rng.uniform(10, 20)))
    return bumps


def _bump(rng: np.random.Generator, usual_K: float, middle: float, nearer: float = 1.0) -> _Bump:
    """A bump near the centre, narrow (2 K) or broad."""
    scatter_K = rng.uniform(1.5, 3) if rng.random() < 0.3 else rng.uniform(4, 12)
    return _Bump(
        weight=rng.uniform(0.3, 1),
        width_K=usual_K * rng.uniform(0.6, 1.5),
        spread=rng.uniform(0.1, 0.5),
        middle_K=middle + nearer * rng.normal(0, 8),
        scatter_K=scatter_K,
    )


def _within(bump: _Bump, rng: np.random.Generator, n: int, wire: BoxWire) -> tuple[Array, Array]:
    """``n`` relays of a bump; those outside the reach of the current are drawn again."""
    low, high = _limits(wire)
    alpha, beta = bump.relays(rng, n)
    for _ in range(50):
        outside = (alpha > high) | (beta < low)
        if not outside.any():
            break
        alpha[outside], beta[outside] = bump.relays(rng, int(outside.sum()))
    keep = (alpha <= high) & (beta >= low)
    return alpha[keep], beta[keep]
