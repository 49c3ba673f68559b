"""The first step of §5.4.2: one sigmoid per first-order curve, and its parameters against α.

    ȳ_α(β) = b₁/(1 + e^{−b₂(β + b₃)}) + b₄

The simplex of the thesis did not converge on curves with few points, because nearly straight data do not determine
four parameters. Here such curves are reported instead, and bounds limit the parameters of the others (Fig. 5.16).
"""

from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.optimize import least_squares

from smarig.core import Array, spaced
from smarig.identification.fod_data import DescendingCurve, FodData
from smarig.preisach import sigmoid

NAMES = ("b1", "b2", "b3", "b4")
FEWEST_POINTS = 5
_STEEPEST = 200.0  # upper bound of b₂ times the range


@dataclass(frozen=True, eq=False)
class CurveFit:
    """Sigmoid of one curve: ``b`` (4,) and standard errors (4,); both None if the curve is too short.

    ``determined`` is false if a standard error exceeds half of b₁ or b₂, or half the range for b₃.
    """

    curve: int
    alpha: float
    points: int
    b: Array | None
    standard_error: Array | None
    sse: float
    determined: bool


@dataclass(frozen=True, eq=False)
class CurveFits:
    """All curves in order of measurement, with the noise σ of the residuals (NaN without degrees of freedom)."""

    curves: tuple[CurveFit, ...]
    sigma: float
    freedom: int
    unit: str

    @property
    def too_short(self) -> tuple[float, ...]:
        """α of the curves whose points do not determine the four parameters."""
        return tuple(c.alpha for c in self.curves if not c.determined)

    def against_alpha(self) -> tuple[Array, Array, Array]:
        """α (m,), b (m, 4) and standard errors (m, 4) of the determined curves: Fig. 5.16."""
        good = [c for c in self.curves if c.determined]
        alpha = np.array([c.alpha for c in good])
        b = np.array([c.b for c in good], dtype=float).reshape(-1, 4)
        return alpha, b, np.array([c.standard_error for c in good], dtype=float).reshape(-1, 4)

    def __repr__(self) -> str:
        short = ", ".join(f"{a:g}" for a in self.too_short)
        return (
            f"CurveFits({len(self.curves)} curves, σ {self.sigma:.3g}{spaced(self.unit)}; "
            f"undetermined at α = {short or 'none'})"
        )


def fit_curves(data: FodData) -> CurveFits:
    """Least-squares sigmoids of every curve, with standard errors from the pooled noise."""
    span, height = data.upper - data.lower, float(np.ptp(data.y)) if len(data) else 0.0
    rough = [(d, _least_squares_fit(d, data, span, height)) for d in data.descending_curves()]
    freedom = sum(d.beta.size - 4 for d, b in rough if b is not None)
    sse = sum(float(np.sum(_residuals(b, d) ** 2)) for d, b in rough if b is not None)
    sigma = float(np.sqrt(sse / freedom)) if freedom else float("nan")
    return CurveFits(tuple(_with_errors(d, b, sigma, span) for d, b in rough), sigma, freedom, data.unit)


def _residuals(b: Array, d: DescendingCurve) -> Array:
    return b[0] * sigmoid(b[1] * (d.beta + b[2])) + b[3] - d.y


def _jacobian(b: Array, d: DescendingCurve) -> Array:
    s = sigmoid(b[1] * (d.beta + b[2]))
    slope = b[0] * s * (1 - s)
    return np.column_stack([s, slope * (d.beta + b[2]), slope * b[1], np.ones_like(s)])


def _least_squares_fit(d: DescendingCurve, data: FodData, span: float, height: float) -> Array | None:
    """Least squares within bounds of a few times the range; None for short curves."""
    if d.beta.size < FEWEST_POINTS or height == 0.0:
        return None
    low = np.array([-5 * height, 0.1 / span, -(data.upper + span), float(data.y.min()) - 5 * height])
    high = np.array([5 * height, _STEEPEST / span, -(data.lower - span), float(data.y.max()) + 5 * height])
    found = least_squares(
        _residuals,
        np.clip(_start(d, span), low, high),
        jac=_jacobian,
        args=(d,),
        bounds=(low, high),
        x_scale="jac",
        max_nfev=200,
    )
    return found.x


def _start(d: DescendingCurve, span: float) -> Array:
    """The best start on a grid of (b₂, b₃), with (b₁, b₄) solved for each: the sigmoid is linear in those."""
    best, least = np.zeros(4), np.inf
    for steep, middle in product(np.array([3, 6, 12, 25, 50]) / span, np.linspace(d.beta[-1], d.beta[0], 7)):
        s = sigmoid(steep * (d.beta - middle))
        off = s - s.mean()
        b1 = float(off @ d.y) / max(float(off @ off), 1e-12)
        b4 = float(d.y.mean() - b1 * s.mean())
        sse = float(np.sum((b1 * s + b4 - d.y) ** 2))
        if sse < least:
            best, least = np.array([b1, steep, -middle, b4]), sse
    return best


def _with_errors(d: DescendingCurve, b: Array | None, sigma: float, span: float) -> CurveFit:
    if b is None:
        return CurveFit(
            curve=d.curve,
            alpha=d.alpha,
            points=d.beta.size,
            b=None,
            standard_error=None,
            sse=float("nan"),
            determined=False,
        )
    J = _jacobian(b, d)
    scale = np.maximum(np.linalg.norm(J, axis=0), 1e-300)
    if np.linalg.cond(J / scale) < 1e8:
        inverse = np.linalg.inv((J / scale).T @ (J / scale))
        error = sigma * np.sqrt(np.diag(inverse)) / scale
    else:
        error = np.full(4, np.inf)
    # Straight data determine neither height and steepness separately nor the point of inflection.
    determined = bool(np.all(error[:2] < 0.5 * np.abs(b[:2])) and error[2] < span / 2)
    return CurveFit(
        curve=d.curve,
        alpha=d.alpha,
        points=d.beta.size,
        b=b,
        standard_error=error,
        sse=float(np.sum(_residuals(b, d) ** 2)),
        determined=determined,
    )
