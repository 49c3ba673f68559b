"""Derivatives of the present output with respect to the present input and to every remembered extremum.

    y = y₀ + Σ_k ± F(corner k),   corner k between extremum k − 1 and extremum k (the last: the present input)

Each extremum moves two corners. They correspond to the strip swept on the way to it and the strip swept back by the
next move (∂F/∂α and ∂y/∂β of the hysteresis). These slopes propagate noise of past inputs through the memory.
"""

from collections.abc import Sequence
from typing import cast

import numpy as np

from smarig.core import Array, UsageError
from smarig.preisach.everett import Differentiable, Everett
from smarig.preisach.state import State


def sensitivity(hysteresis: Everett | Differentiable, state: State) -> Array:
    """∂y/∂(each of ``state.extrema``) and, last, ∂y/∂u of the present input; shape (len(extrema) + 1,).

    The slope of the base is 0, because saturation does not depend on inputs beyond u₋ and the centre ℓ of B_ℓ is not
    an input. ∂y/∂u is that of continuing in the direction of the last move. At a kink the slopes are one-sided.
    UsageError for relays, which have no slopes.

    >>> from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
    >>> from smarig.preisach.operator import Preisach
    >>> wire = Preisach.from_surface(thesis_surface("one_c"))
    >>> y = wire.simulate([90.0, 40.0])
    >>> sensitivity(wire.hysteresis, wire.state).round(4).tolist()     # base, maximum 90, present input
    [0.0, 0.0504, 0.165]
    """
    return sensitivities(hysteresis, [state])[0]


def sensitivities(hysteresis: Everett | Differentiable, states: Sequence[State]) -> list[Array]:
    """``sensitivity`` of each state, computed for all corners at once."""
    surface = _with_slopes(hysteresis)
    sizes = [len(state.extrema) + 1 for state in states]
    path = np.array([u for state in states for u in (*state.extrema, state.u)])
    slope = np.zeros(path.size)
    base = np.cumsum([0, *sizes[:-1]]) if states else np.empty(0, dtype=np.int64)
    strip = np.ones(path.size, dtype=bool)  # whether a strip was swept on the way to this point
    strip[base] = False
    for k, state in zip(base.tolist(), states):
        if state.diagonal:
            slope[k + 1] += _slope_leaving_diagonal(surface, path[k], path[k + 1])
            strip[k + 1] = False
    here = np.flatnonzero(strip)
    before, after = path[here - 1], path[here]
    rises = after > before
    alpha, beta = np.maximum(before, after), np.minimum(before, after)
    by_alpha = np.asarray(surface.strip_alpha(alpha, beta))
    by_beta = np.asarray(surface.strip_beta(alpha, beta))
    slope[here] += np.where(rises, by_alpha, by_beta)
    slope[here - 1] -= np.where(rises, by_beta, by_alpha)
    slope[base] = 0.0
    return np.split(slope, base[1:])


def _with_slopes(hysteresis: Everett | Differentiable) -> Differentiable:
    if np.size(getattr(hysteresis, "steps", ())) or not hasattr(hysteresis, "strip_alpha"):
        raise UsageError(
            f"{type(hysteresis).__name__} has no slopes. Sensitivities need a surface or a table."
        )
    return cast(Differentiable, hysteresis)


def _slope_leaving_diagonal(hysteresis: Differentiable, centre: float, u: float) -> float:
    """Slope of the output along the first move from B_ℓ. The strip ends at the mirror image of u."""
    here, image = np.array([u]), np.array([2 * centre - u])
    if u >= centre:
        return float(hysteresis.strip_alpha(here, np.maximum(image, hysteresis.lower))[0])
    return float(hysteresis.strip_beta(np.minimum(image, hysteresis.upper), here)[0])
