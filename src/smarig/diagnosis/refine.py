"""An explanation at its best: all parameters of an effect fitted to everything at once, by Gauss–Newton.

    minimise ‖L⁻¹ (y − f(θ))‖² over θ within its bounds;  f(θ): the story retold, density deviations are free in C

so nothing is linear in the strength here, and the interval of θ carries what the density could do instead. Knows one
effect at a time, on top of those already accepted.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.diagnosis.refit import Refit
from smarig.diagnosis.retelling import Subject, retold
from smarig.diagnosis.story import Story
from smarig.model.effect import Kind, Planted

Array = NDArray[np.float64]
ROUNDS = 8
_STEP = 0.02  # of a parameter's typical size, for slopes
_DONE = 0.02  # nats
NORMAL_95 = 1.96


@dataclass(frozen=True, eq=False)
class Refined:
    """An effect with its values, 95 % intervals, gain in nats over the base, and the whitened rest (N,)."""

    planted: Planted
    intervals: dict[str, tuple[float, float]]
    gain: float
    rest: Array

    @property
    def name(self) -> str:
        """Of the effect."""
        return self.planted.kind.name


def refined(start: Planted, story: Story, subject: Subject, refitted: Refit) -> Refined:
    """The effect at the parameters of least squares, from a start; bounds hold."""
    kind = start.kind
    data = np.concatenate([r.value for r in story.kinds])
    moved = _fitted_parameters(kind)

    def rest(x: Array) -> Array:
        told = retold(story, subject, [_at(kind, start, moved, x)])
        return refitted.centred(data - told.stacked(story), story)

    x = np.array([start.values[name] for name in moved])
    x, r, J = _descend(rest, x, *_bounds(kind, moved))
    before = float(refitted.data @ refitted.data)
    n = refitted.data.size
    gain = 0.5 * n * float(np.log(before / (r @ r)))
    spread = _spread(J, float(r @ r) / n)
    ends = {
        name: (float(v - NORMAL_95 * s), float(v + NORMAL_95 * s)) for name, v, s in zip(moved, x, spread)
    }
    return Refined(_at(kind, start, moved, x), ends, gain, r)


def _fitted_parameters(kind: Kind) -> list[str]:
    """The strength, and whatever the critic tries several values of."""
    return [p.name for p in kind.parameters if p is kind.primary or len(p.tries) > 1]


def _at(kind: Kind, start: Planted, names: list[str], x: Array) -> Planted:
    return kind(**{**start.values, **dict(zip(names, x.tolist()))})


def _bounds(kind: Kind, names: list[str]) -> tuple[Array, Array, Array]:
    by_name = {p.name: p for p in kind.parameters}
    low = np.array([by_name[n].lower for n in names])
    high = np.array([by_name[n].upper for n in names])
    size = np.array([abs(by_name[n].typical) or 0.1 * (by_name[n].upper - by_name[n].lower) for n in names])
    return low, high, size


def _descend(
    rest: Callable[[Array], Array], x: Array, low: Array, high: Array, size: Array
) -> tuple[Array, Array, Array]:
    """Levenberg–Marquardt with clipped steps: (x, residual, Jacobian) where it ends."""
    r = rest(x)
    J = _jacobian(rest, x, r, low, high, size)
    damping = 1e-3
    for _ in range(ROUNDS):
        normal = J.T @ J
        step = np.linalg.lstsq(normal + damping * np.diag(np.diag(normal) + 1e-12), -J.T @ r, rcond=None)[0]
        trial = np.clip(x + step, low, high)
        new = rest(trial)
        better = float(r @ r - new @ new)
        if better <= 0:
            damping *= 10
            if damping > 1e3:
                break
            continue
        x, r, damping = trial, new, damping / 5
        if better < 2 * _DONE:
            break
        J = _jacobian(rest, x, r, low, high, size)
    return x, r, J


def _jacobian(
    rest: Callable[[Array], Array], x: Array, r: Array, low: Array, high: Array, size: Array
) -> Array:
    columns = []
    for k in range(x.size):
        step = np.zeros(x.size)
        step[k] = _STEP * size[k] if x[k] + _STEP * size[k] <= high[k] else -_STEP * size[k]
        columns.append((rest(np.clip(x + step, low, high)) - r) / step[k])
    return np.column_stack(columns)


def _spread(J: Array, variance: float) -> Array:
    normal = J.T @ J
    return np.sqrt(np.maximum(np.diag(np.linalg.pinv(normal)) * variance, 0.0))
