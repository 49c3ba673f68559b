"""Work as an Everett function: the moments of ν over triangles, computed from F alone.

A rising input that sweeps Ω does the work ∬_Ω α dν, and a falling one −∬_Ω β dν (thesis (7.2)). For the triangle with
corner (α, β) both follow from F by parts, without derivative or density:

    up(α, β)   = ∬ α′ dν = α F(α, β) − ∫_β^α F(v, β) dv            work of rising from β to α
    down(α, β) = ∬ β′ dν = β F(α, β) + ∫_β^α F(α, v) dv            work returned when falling from α to β
    A(α, β)    = up − down = ∫_β^α [F(α, β) − F(α, v) − F(v, β)] dv    area of the loop β ↔ α

ν contains the reversible part g, which adds ∫ v g(v) dv to both moments and cancels in A. The integrals are
Gauss–Legendre sums on panels that end where F is not smooth: exact for tables (piecewise linear along a line) and relay
measures (piecewise constant), exact to rounding for surfaces.
"""

from collections.abc import Callable
from functools import singledispatch

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smarig.core import NOT_NUMBERS, Array, UsageError
from smarig.preisach import Everett, Mirrored, RelayMeasure

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)
_PANELS = 24  # panels over a smooth surface's range: 12 nodes on each are exact to rounding for every Table 5.1 surface


@singledispatch
def breaks(hysteresis: Everett) -> Array:
    """Inputs at which F is not smooth along either axis, and the ends of the range; rising, shape (n,).

    These are relay thresholds, table nodes, or an even division if derivatives never jump. A hysteresis without
    ``kinks`` is assumed to be smooth.
    """
    kinks = np.asarray(getattr(hysteresis, "kinks", ()), dtype=float)
    even = np.linspace(hysteresis.lower, hysteresis.upper, 2 if kinks.size else _PANELS + 1)
    return np.unique(np.concatenate([kinks[(kinks > even[0]) & (kinks < even[-1])], even]))


@breaks.register
def _breaks_of_relays(hysteresis: RelayMeasure) -> Array:
    return np.unique(np.concatenate([hysteresis.alpha, hysteresis.beta]))


@breaks.register
def _breaks_of_mirrored(hysteresis: Mirrored) -> Array:
    return -breaks(hysteresis.image)[::-1]


@singledispatch
def rounding(hysteresis: Everett) -> float:
    """Possible error of a computed work or loop area: 1e-13 of the largest output range times the largest input."""
    u = breaks(hysteresis)
    output_changes = np.abs(np.tril(hysteresis.swept(np.maximum(u[:, None], u), u)))
    return 1e-13 * _largest_input(u) * float(output_changes.max())


@rounding.register
def _rounding_of_relays(hysteresis: RelayMeasure) -> float:
    return 2e-13 * _largest_input(breaks(hysteresis)) * float(np.abs(hysteresis.mass).sum())


def _largest_input(u: Array) -> float:
    return float(np.abs(u).max() + np.ptp(u))


def integral(f: Callable[[Array, NDArray[np.intp]], Array], a: Array, b: Array, cuts: Array) -> Array:
    """∫_a^b f(v, k) dv for intervals k with a ≤ b, shape (n,), each split at ``cuts``.

    ``f`` takes points (p, q) and, as a column (p, 1), the interval to which each row belongs.
    """
    first = np.searchsorted(cuts, a, side="right")
    count = np.maximum(np.searchsorted(cuts, b, side="left") - first, 0) + 1
    k = np.repeat(np.arange(a.size), count)
    step = np.arange(k.size) - np.repeat(np.cumsum(count) - count, count)
    padded = np.append(cuts, np.inf)
    at = first[k] + step
    start = np.where(step == 0, a[k], padded[np.maximum(at - 1, 0)])
    stop = np.minimum(b[k], padded[np.minimum(at, cuts.size)])
    half = 0.5 * (stop - start)[:, None]
    values = f(0.5 * (stop + start)[:, None] + half * _NODES, k[:, None])
    return np.bincount(k, weights=(values * half) @ _WEIGHTS, minlength=a.size).astype(float)


def up(hysteresis: Everett, alpha: ArrayLike, beta: ArrayLike) -> Array:
    """∬ α′ dν over the triangles with corners (α, β): work of rising from β to α. Broadcasts."""
    a, b, shape = _flat(alpha, beta)
    under = integral(lambda v, k: hysteresis.swept(v, b[k]), b, a, breaks(hysteresis))
    return (a * hysteresis.swept(a, b) - under).reshape(shape)


def down(hysteresis: Everett, alpha: ArrayLike, beta: ArrayLike) -> Array:
    """∬ β′ dν over the triangles with corners (α, β): work returned when falling from α to β. Broadcasts."""
    a, b, shape = _flat(alpha, beta)
    under = integral(lambda v, k: hysteresis.swept(a[k], v), b, a, breaks(hysteresis))
    return (b * hysteresis.swept(a, b) + under).reshape(shape)


def loop_area(hysteresis: Everett, upper: ArrayLike, lower: ArrayLike) -> Array:
    """A(M, m) = 2∬_{m≤β≤α≤M} μ(α − β) dα dβ: work lost in one cycle m → M → m, ∮ u dy. Broadcasts.

    In output times input units (mm·K, deg·K). Zero for M = m; independent of g. UsageError unless
    u₋ ≤ m ≤ M ≤ u₊.

    >>> from smarig.preisach import thesis_surface
    >>> bool(loop_area(thesis_surface("one_e"), 104.5, 59.0) > 0 > loop_area(thesis_surface("one_p"), 104.5, 59.0))
    True
    """
    a, b, _ = _flat(upper, lower)
    low, high = hysteresis.lower, hysteresis.upper
    inside = (low <= b) & (b <= a) & (a <= high)  # false for NaN
    if not inside.all():
        k = int(np.argmin(inside))
        raise UsageError(f"A loop needs {low:g} ≤ m ≤ M ≤ {high:g}, got m = {b[k]} and M = {a[k]}.")
    return area(hysteresis, upper, lower)


def area(hysteresis: Everett, upper: ArrayLike, lower: ArrayLike) -> Array:
    """The formula of ``loop_area`` for any M and m, because a search for the minimum may leave the triangle."""
    a, b, shape = _flat(upper, lower)

    def rectangle(v: Array, k: NDArray[np.intp]) -> Array:
        return hysteresis.swept(a[k], b[k]) - hysteresis.swept(a[k], v) - hysteresis.swept(v, b[k])

    return integral(rectangle, b, a, breaks(hysteresis)).reshape(shape)


def moments_on(hysteresis: Everett, levels: Array) -> tuple[Array, Array]:
    """up(u_i, u_j) and down(u_i, u_j) for j ≤ i on rising levels (n,), shape (n, n); zero above the diagonal.

    Each cell of each line is integrated once: n² integrals for all n² loops.
    """
    n = levels.size
    cells = np.arange(n - 1)
    line, cell = (x.ravel() for x in np.meshgrid(np.arange(n), cells, indexing="ij"))
    cuts = breaks(hysteresis)

    def summed(f: Callable[[Array, NDArray[np.intp]], Array], keep: NDArray[np.bool_]) -> Array:
        """Running integrals along each line, shape (line, n)."""
        parts = np.zeros(line.size)
        wanted = np.flatnonzero(keep)
        chosen = line[wanted], cell[wanted]
        parts[wanted] = integral(
            lambda v, k: f(v, chosen[0][k]), levels[chosen[1]], levels[chosen[1] + 1], cuts
        )
        return np.hstack([np.zeros((n, 1)), np.cumsum(parts.reshape(n, n - 1), axis=1)])

    rows = summed(lambda v, k: hysteresis.swept(levels[k], v), cell < line)
    columns = summed(lambda v, k: hysteresis.swept(v, levels[k]), cell >= line).T
    edges = np.tril(hysteresis.swept(np.maximum(levels[:, None], levels), levels))
    rising = levels[:, None] * edges - (columns - np.diag(columns))
    falling = levels * edges + (np.diag(rows)[:, None] - rows)
    return np.tril(rising, -1), np.tril(falling, -1)


def areas_on(hysteresis: Everett, levels: Array) -> Array:
    """A(u_i, u_j), j ≤ i, on rising levels (n,); shape (n, n), zero on and above the diagonal."""
    rising, falling = moments_on(hysteresis, levels)
    return rising - falling


def _flat(alpha: ArrayLike, beta: ArrayLike) -> tuple[Array, Array, tuple[int, ...]]:
    try:
        a, b = np.broadcast_arrays(np.asarray(alpha, dtype=float), np.asarray(beta, dtype=float))
    except NOT_NUMBERS:
        raise UsageError("The ends of loops must be numbers, in arrays that broadcast.") from None
    return a.ravel(), b.ravel(), a.shape
