"""Derivatives of the surface (5.5) by its parameters, in closed form.

y = y₋ + D s/S,   D = y₊ − y₋,   s = A(α) [σ(x₄(β + f)) − σ(x₄(u₋ + f))],   S = s(u₊, u₊)
∂y/∂p = D (∂s/∂p · S − s · ∂S/∂p)/S²,   ∂y/∂y₊ = s/S,   ∂y/∂y₋ = 1 − s/S

Slopes ∂y/∂β along first-order curves as residuals of a surface fit, beside the outputs (thesis §9.2).

    row of two neighbours β_i > β_{i+1} of a curve:   w h [(ŷ_i − ŷ_{i+1}) − (y_i − y_{i+1})]/(β_i − β_{i+1})

h is the mean spacing of the points, so that a row is an output and w = 1 gives slopes and outputs similar weight. The
difference quotient of the model is compared with that of the data, so nothing is differentiated numerically.

The starts of the surface fit: many coarse guesses, ranked with their linear part solved.

For given x the surface y₋ + c·s(α, β) is linear in (y₋, c), so a guess costs one 2 × 2 solve (variable projection).
Scales come from the range of the data.
"""

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csr_matrix

from smarig.core import Array
from smarig.identification.fod_data import FodData
from smarig.preisach import FodSurface, Parameters, sigmoid, surface_form


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


def slope_rows(data: FodData, weight: float) -> csr_matrix:
    """The rows as a matrix (m, k) that maps errors ŷ − y of the points (k,) to weighted slope errors (m,)."""
    first, second, width = [], [], []
    for alpha in np.unique(data.alpha):
        at = np.flatnonzero(data.alpha == alpha)
        at = at[np.argsort(-data.beta[at], kind="stable")]
        step = data.beta[at[:-1]] - data.beta[at[1:]]
        apart = step > 0  # a repeated reading has no slope
        first += at[:-1][apart].tolist()
        second += at[1:][apart].tolist()
        width += step[apart].tolist()
    m = len(width)
    if not m:
        return csr_matrix((0, len(data)))
    values = weight * float(np.mean(width)) / np.array(width)
    rows = np.tile(np.arange(m), 2)
    return csr_matrix((np.concatenate([values, -values]), (rows, first + second)), shape=(m, len(data)))


FLATTEST = 1e-6  # a smaller s(u₊, u₊) cannot be scaled to the measured height


def ranked_starts(form: str, data: FodData, root_weights: Array, fitted: Parameters) -> list[Parameters]:
    """The guesses of x of the form, best first; ``fitted`` are the x of the fitted form from which it is extended."""
    guesses = surface_form(form).starts(data.lower, data.upper, fitted)
    ends = (data.lower, data.upper, 0.0, 1.0)
    cost = [_projected_sse(FodSurface(form, x, *ends), data, root_weights) for x in guesses]
    return [guesses[k] for k in np.argsort(cost, kind="stable") if np.isfinite(cost[k])]


def _projected_sse(shape: FodSurface, data: FodData, root_weights: Array) -> float:
    if shape.shape(shape.upper, shape.upper) < FLATTEST:
        return np.inf
    s = shape.shape(data.alpha, data.beta)
    basis = np.column_stack([s, np.ones_like(s)]) * root_weights[:, None]
    target = data.y * root_weights
    solution = np.linalg.lstsq(basis, target, rcond=None)[0]
    return float(np.sum((target - basis @ solution) ** 2)) if solution[0] > 0 else np.inf
