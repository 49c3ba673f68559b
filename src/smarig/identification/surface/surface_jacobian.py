"""Derivatives of the surface (5.5) by its parameters, in closed form.

    y = y₋ + D s/S,   D = y₊ − y₋,   s = A(α) [σ(x₄(β + f)) − σ(x₄(u₋ + f))],   S = s(u₊, u₊)
    ∂y/∂p = D (∂s/∂p · S − s · ∂S/∂p)/S²,   ∂y/∂y₊ = s/S,   ∂y/∂y₋ = 1 − s/S

Knows no data.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smarig.preisach.hysteresis.fod_surface import FodSurface, sigmoid

Array = NDArray[np.float64]


def jacobian(surface: FodSurface, alpha: ArrayLike, beta: ArrayLike) -> Array:
    """∂y/∂(x…, y_upper, y_lower) at points (k,), shape (k, parameters); thesis (5.5)."""
    a, b = np.asarray(alpha, dtype=float), np.asarray(beta, dtype=float)
    top = np.array([surface.upper])
    s, ds = surface.shape(a, b), _shape_gradient(surface, a, b)
    at_top, d_top = surface.shape(top, top)[0], _shape_gradient(surface, top, top)[0]
    share = s / at_top
    by_x = (surface.y_upper - surface.y_lower) * (ds - share[:, None] * d_top) / at_top
    return np.column_stack([by_x, share, 1 - share])


def _shape_gradient(surface: FodSurface, a: Array, b: Array) -> Array:
    """∂s/∂x, shape (k, len(x))."""
    x2, x3, x4 = surface.x[:3]
    f, _ = surface.shift(a)
    amplitude = sigmoid(x2 * (a + x3))
    here, rest = sigmoid(x4 * (b + f)), sigmoid(x4 * (surface.lower + f))
    bell, bell_rest = here * (1 - here), rest * (1 - rest)
    rise = amplitude * (1 - amplitude) * (here - rest)
    by_x4 = amplitude * (bell * (b + f) - bell_rest * (surface.lower + f))
    by_f = amplitude * x4 * (bell - bell_rest)
    return np.column_stack([rise * (a + x3), rise * x2, by_x4, by_f[:, None] * _shift_gradient(surface, a)])


def _shift_gradient(surface: FodSurface, a: Array) -> Array:
    """∂f/∂(x₅…), shape (k, 1 or 3)."""
    one = np.ones_like(a)
    if surface.form == "constant":
        return one[:, None]
    if surface.form == "parabolic":
        return np.column_stack([a * a, a, one])
    decay = np.exp(-surface.x[4] * a)
    return np.column_stack([decay, -surface.x[3] * a * decay, one])
