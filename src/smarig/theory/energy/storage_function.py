"""A sufficient test, exact per kind, whether the thesis's storage function Q_r (7.1) is valid beyond μ ≥ 0.

Along a sweep Q_r(B) + ∫u dy − Q_r(B₁) changes by a strip moment. A fall at u > 0 or a rise at u < 0 only returns stored
energy. With β⁺ = max(β, 0) and α⁻ = min(α, 0), Thm 7.4 holds with storage Q_r if for all m < M

    rise at M > 0:   2∫_m^M μ(M, β)(M − β⁺) dβ ≥ 0        fall at m < 0:   2∫_m^M μ(α, m)(α⁻ − m) dα ≥ 0

and Q_r ≥ 0. Non-negative strips of ν are sufficient for the latter: ∂_βy(M, β) ≥ 0 for β > 0, ∂_αF(α, m) ≥ 0 for α < 0.
Then Q_r is also the available storage, because the return to zero extracts all of it, and every state at u = 0 has
none. The model is passive with zero bias (Thm 8.1), whatever the sign of μ. The result False means "not proved".
"""

from functools import singledispatch
from numbers import Integral

import numpy as np

from smarig.core import UsageError
from smarig.preisach import Everett, FodSurface, RelayMeasure, sigmoid
from smarig.theory.energy.loop_area_bounds import DensityCells
from smarig.theory.energy.moments import breaks, moments_on


@singledispatch
def recoverable_energy_is_storage(hysteresis: Everett, cells: int = 512) -> bool:
    """Whether Q_r is proved to be a storage function, by verified bounds (surface) or exactly (relays).

    >>> from smarig.preisach import thesis_surface
    >>> recoverable_energy_is_storage(thesis_surface("two_e")), recoverable_energy_is_storage(thesis_surface("two_p"))
    (True, False)
    """
    _check_cells(cells)
    raise UsageError(
        f"Whether Q_r is a storage function of a {type(hysteresis).__name__} cannot be decided. "
        "Give an analytic surface or a measure of relays."
    )


def _check_cells(cells: int) -> None:
    if not (isinstance(cells, Integral) and cells >= 1):
        raise UsageError(f"The number of cells must be a whole number, 1 or more, got {cells!r:.40}.")


@recoverable_energy_is_storage.register
def _surface(hysteresis: FodSurface, cells: int = 512) -> bool:
    _check_cells(cells)
    cut = DensityCells.of(hysteresis, cells)
    below, above, h = cut.levels[:-1], cut.levels[1:], cut.h
    beta_up = (np.maximum(above, 0) ** 2 - np.maximum(below, 0) ** 2) / 2  # ∫ β⁺ over a cell
    alpha_down = (np.minimum(above, 0) ** 2 - np.minimum(below, 0) ** 2) / 2  # ∫ α⁻ over a cell
    rise = cut.across(
        np.maximum(h * np.maximum(below, 0)[:, None] - beta_up, 0.0),
        np.maximum(h * np.maximum(above, 0)[:, None] - beta_up, 0.0),
    )
    fall = cut.along(
        np.maximum(alpha_down[:, None] - h * np.minimum(above, 0), 0.0),
        np.maximum(alpha_down[:, None] - h * np.minimum(below, 0), 0.0),
    )
    verified = rise[above > 0].min(initial=0.0) >= 0 and fall[:, below < 0].min(initial=0.0) >= 0
    return bool(verified and _strips_are_positive(hysteresis, cut))


def _strips_are_positive(surface: FodSurface, cut: DensityCells) -> bool:
    """∂_βy is c·a·x₄·s(1 − s), of one sign; ∂_αF = g(α) + 2∫_m^α μ(α, β) dβ is bounded below for α < 0."""
    if surface.amplitude * surface.x[2] < 0:
        return False
    below, above = cut.levels[:-1], cut.levels[1:]
    x2, x3, x4 = surface.x[:3]
    first = np.minimum(sigmoid(x2 * (below + x3)), sigmoid(x2 * (above + x3)))
    f = np.sort(np.stack([surface.shift(below)[0], surface.shift(above)[0]]), axis=0)
    z = np.stack([x4 * (below + f[0]), x4 * (above + f[1])])
    bell = np.minimum(*(0.25 / np.cosh(np.minimum(np.abs(z) / 2, 300.0)) ** 2))
    # the values of f at the ends of a cell are its range only where f does not turn
    turns = bool(surface.surface_form.value_turns(surface.x[3:]))
    reversible = np.zeros(below.size) if turns else surface.amplitude * x4 * first * bell
    whole = np.full(cut.low.shape, cut.h)
    strips = cut.across(whole, whole) + reversible[:, None]
    return bool(np.tril(strips)[above <= 0].min(initial=0.0) >= 0)


@recoverable_energy_is_storage.register
def _relays(hysteresis: RelayMeasure, cells: int = 512) -> bool:
    """The same strips, threshold by threshold, from the triangle moments. Nothing changes between thresholds."""
    del cells
    levels = np.unique(np.append(breaks(hysteresis), 0.0))
    levels = np.concatenate([[levels[0] - 1], levels, [levels[-1] + 1]])
    up, down = moments_on(hysteresis, levels)
    outputs = np.tril(hysteresis.swept(np.maximum(levels[:, None], levels), levels))
    zero, k = int(np.searchsorted(levels, 0.0)), np.arange(levels.size)
    rise = np.diff(up, axis=0) - np.diff(down[:, np.maximum(k, zero)], axis=0)
    fall = np.diff(down, axis=1) - np.diff(up[np.minimum(k, zero)], axis=1)
    above = k[:-1, None] >= k  # a rise from level i to i + 1, its strip ending at a level j below
    below = k[:, None] > k[:-1]  # a fall from level j + 1 to j, its strip ending at a level i above
    least = [
        np.where(above, rise, 0.0)[zero:].min(initial=0.0),
        np.where(below, fall, 0.0)[:, :zero].min(initial=0.0),
        np.where(above, np.diff(outputs, axis=0), 0.0)[:zero].min(initial=0.0),
        np.where(below, -np.diff(outputs, axis=1), 0.0)[:, zero:].min(initial=0.0),
    ]
    return bool(min(least) >= -1e-12 * np.abs(hysteresis.mass).sum() * np.abs(levels).max())
