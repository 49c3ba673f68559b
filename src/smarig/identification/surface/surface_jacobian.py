"""Derivatives of the surface (5.5) by its parameters, in closed form.

y = y₋ + D s/S,   D = y₊ − y₋,   s = A(α) [σ(x₄(β + f)) − σ(x₄(u₋ + f))],   S = s(u₊, u₊)
∂y/∂p = D (∂s/∂p · S − s · ∂S/∂p)/S²,   ∂y/∂y₊ = s/S,   ∂y/∂y₋ = 1 − s/S
"""

import numpy as np
from numpy.typing import ArrayLike

from smarig.core import Array
from smarig.preisach import FodSurface, sigmoid


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
    by_own = by_f[:, None] * surface.surface_form.jacobian(surface.x[3:], a)
    return np.column_stack([rise * (a + x3), rise * x2, by_x4, by_own])
