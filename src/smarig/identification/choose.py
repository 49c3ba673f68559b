"""Which kind of surface predicts curves it has not seen? The "best" of ``identify``.

Whole curves are held out, in up to five groups; the highest and the lowest stay, because nothing could
interpolate to them. A simpler kind is chosen when it predicts within 10 % of the best.
Knows no validation run: those only judge.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.errors import DataError
from smarig.identification.fod_data import FodData
from smarig.identification.fod_table_data import curve_table
from smarig.identification.surface_fit import SurfaceFit, Weights, fit_surface
from smarig.preisach.fod_surface import FORMS, FodSurface
from smarig.preisach.forc_table import ForcTable

Array = NDArray[np.float64]
LEVELS = (("constant",), ("parabolic", "exponential"), ("table",))  # by rising freedom
KINDS = tuple(kind for level in LEVELS for kind in level)
# Over 25 seeds of the one-wire constant surface a freer kind was never luckier than 7 %.
AS_GOOD = 1.1
GROUPS = 5
FEWEST_CURVES = 4
MOST_POINTS = 1500  # surfaces are compared on at most about this many points: magnetic data has thousands


@dataclass(frozen=True)
class Choice:
    """The chosen kind, and the rms error on held-out curves of every kind, in the data's unit."""

    kind: str
    held_out_rms: dict[str, float]
    curves: int


def choose(data: FodData, *, anchor: bool = False, weights: Weights = "residual") -> Choice:
    """Compare constant, parabolic, exponential and table by held-out curves.

    Raises DataError when there are fewer than four curves, or no kind can be fitted.
    """
    alphas = np.unique([d.alpha for d in data.descents()])
    if alphas.size < FEWEST_CURVES:
        raise DataError(
            f"Choosing the best surface holds out curves and needs at least {FEWEST_CURVES}; there are "
            f"{alphas.size}: name a surface instead."
        )
    held = alphas[1:-1]
    errors = {kind: e for kind in KINDS if (e := _held_out(data, kind, held, anchor, weights)) is not None}
    if not errors:
        raise DataError("No kind of surface could be fitted with curves held out: name a surface instead.")
    rms = {kind: float(np.sqrt(e.mean())) for kind, e in errors.items()}
    return Choice(_simplest(rms), rms, held.size)


def _simplest(rms: dict[str, float]) -> str:
    """The best kind among the simplest that come within ``AS_GOOD`` of the best of all."""
    enough = AS_GOOD * min(rms.values())
    for level in LEVELS:
        good = [kind for kind in level if rms.get(kind, np.inf) <= enough]
        if good:
            return min(good, key=lambda kind: rms[kind])
    return min(rms, key=lambda kind: rms[kind])


def _held_out(data: FodData, kind: str, held: Array, anchor: bool, weights: Weights) -> Array | None:
    """Mean square error of each held-out curve, (curves,); None when the kind cannot be fitted."""
    errors = np.full(held.size, np.nan)
    whole: SurfaceFit | None = None
    try:
        if kind in FORMS:
            data = _thinned(data)
            whole = fit_surface(data, kind, anchor=anchor, weights=weights)
        for group in range(min(GROUPS, held.size)):
            out = np.arange(held.size) % GROUPS == group
            train = data.where(~np.isin(data.alpha, held[out]))
            surface = _fitted(train, whole, anchor, weights)
            for k in np.flatnonzero(out):
                mine = data.alpha == held[k]
                errors[k] = np.mean((surface.y(data.alpha[mine], data.beta[mine]) - data.y[mine]) ** 2)
    except DataError:
        return None
    return errors


def _thinned(data: FodData) -> FodData:
    """Every k-th point of the curves, their first and last ones kept."""
    stride = -(-len(data) // MOST_POINTS)
    if stride == 1:
        return data
    edge = np.flatnonzero(np.diff(data.curve)) + 1
    keep = np.arange(len(data)) % stride == 0
    keep[np.concatenate([[0], edge, edge - 1, [len(data) - 1]])] = True
    return data.where(keep)


def _fitted(
    train: FodData, whole: SurfaceFit | None, anchor: bool, weights: Weights
) -> FodSurface | ForcTable:
    """The training curves' surface, beginning at the fit to all curves; their table when there is none."""
    if whole is None:
        return curve_table(train)
    return fit_surface(train, whole.surface.form, anchor=anchor, weights=weights, start=whole).surface
