"""A surface fitted to outputs after any histories, from an earlier fit: the smooth start of a density.

The output after a history is a signed sum of the surface at the corners of its staircase (``Observations``), so its
derivatives are the same sums of the surface's derivatives (``surface_jacobian``).
"""

from dataclasses import replace

import numpy as np
from scipy.optimize import least_squares

from smarig.core import Array, UsageError
from smarig.identification.positive.observations import Observations
from smarig.identification.surface.surface_jacobian import jacobian
from smarig.preisach import FodSurface

MAX_EVALUATIONS = 30


def surface_through_states(rows: Observations, start: FodSurface) -> FodSurface | None:
    """The surface of the form of ``start`` nearest to outputs (m,) in the least-squares sense, with free zeros.

    None if it cannot be fitted: too few outputs, histories from a diagonal state, or a fit that leads to no surface.
    """
    p = np.array([*start.x, start.y_upper, start.y_lower])
    if rows.released or len(rows) <= p.size + rows.offsets:
        return None
    corners, zeros = rows.corner_sums, rows.free_zeros

    def surface(q: Array) -> FodSurface:
        *x, upper, lower = q[: p.size].tolist()
        return replace(start, x=tuple(x), y_upper=upper, y_lower=lower)

    def residual(q: Array) -> Array:
        return corners @ surface(q).y(rows.alpha, rows.beta) + zeros @ q[p.size :] - rows.y

    def derivatives(q: Array) -> Array:
        return np.hstack([corners @ jacobian(surface(q), rows.alpha, rows.beta), zeros.toarray()])

    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        try:
            found = least_squares(
                residual,
                np.concatenate([p, np.zeros(rows.offsets)]),
                jac=derivatives,
                x_scale="jac",
                max_nfev=MAX_EVALUATIONS,
            )
        except (
            ValueError,
            UsageError,
        ):  # a step led to values that are no numbers, or to a surface of no height
            return None
    fitted = surface(found.x)
    same_direction = (fitted.y_upper - fitted.y_lower) * (start.y_upper - start.y_lower) > 0
    return fitted if same_direction and np.isfinite(found.x).all() else None
