"""The figures of a fit for a model file, with the same names for every kind, and warnings for the user."""

from functools import singledispatch
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, spaced
from smarig.identification.density_report import DensityReport
from smarig.identification.fod_data import FodData
from smarig.identification.positive.observations import Observations
from smarig.identification.positive.positive_fit import PositiveFit
from smarig.identification.surface.choose_surface import FEWEST_CURVES
from smarig.identification.surface.surface_fit import ROOT_WEIGHT, MajorLoopWeighting, SurfaceFit
from smarig.preisach import ForcTable

NEGATIVE_MASS_RATIO = 1.25  # times the held-out error with masses of any sign: more than by chance


def plain(value: float) -> float | None:
    """A finite number, or None, for JSON."""
    return float(value) if np.isfinite(value) else None


def error_figures(error: Array, major: NDArray[np.bool_], root_weight: float) -> dict[str, float]:
    """rms, √Σe², √Σw e², Σe², Σw e² of errors (m,); ``root_weight`` multiplies those of the major loop (m,)."""
    sse = float(error @ error)
    weighted = float(np.sum((error * np.where(major, root_weight, 1.0)) ** 2))
    return {
        "rms": float(np.sqrt(sse / error.size)),
        "norm2": float(np.sqrt(sse)),
        "weighted_norm2": float(np.sqrt(weighted)),
        "sse": sse,
        "weighted_sse": weighted,
    }


def surface_figures(
    error: Array, data: FodData, fit: SurfaceFit | None, weights: MajorLoopWeighting, select: str | None
) -> dict[str, Any]:
    """Figures of a surface, or of a table (``fit`` None), over the FOD points."""
    return {
        **error_figures(error, data.major, ROOT_WEIGHT[weights]),
        "points": len(data),
        "curves": data.curves,
        "weights": weights,
        "select": select,
        "anchored": fit.anchored if fit else False,
        "converged": fit.converged if fit else None,
        "starts": fit.starts if fit else 0,
        "sigma": plain(fit.sigma) if fit else None,
        **({"slope_weight": fit.slope_weight} if fit and fit.slope_weight else {}),
    }


def positive_figures(
    fit: PositiveFit,
    observations: Observations,
    data: FodData,
    weights: MajorLoopWeighting,
    select: str | None,
) -> dict[str, Any]:
    """Figures of a positive measure over its observations; all points have equal weights in the fit."""
    error, major = _errors(fit, observations), _on_major_loop(observations)
    return {
        **error_figures(error, major, ROOT_WEIGHT[weights]),
        "points": len(observations),
        "curves": data.curves,
        "weights": weights,
        "select": select,
        "anchored": False,
        "converged": True,  # a convex programme, solved to rounding
        "starts": 1,
        "sigma": plain(fit.sigma),
        "smoothing": fit.smoothing,
        "freedom": fit.freedom,
        "cells": fit.cells,
        "at_zero": fit.at_zero,
        "rank": fit.rank,
        "null_space": fit.null_space,
        "held_out_rms": plain(fit.held_out.rms),
        "signed_held_out_rms": plain(fit.held_out.signed_rms),
        "stretch": fit.held_out.spread_factor,
        "reversible_share": plain(fit.reversible_share),
        "symmetric": fit.symmetric,
    }


def _errors(fit: PositiveFit, observations: Observations) -> Array:
    """Model minus measured values (m,): rows over the values at the nodes, y₋ and the free zeros."""
    cells = fit.triangle
    unknowns = [*fit.table.values[cells.i + 1, cells.j + 1], fit.table.y_lower, *fit.zeros]
    return observations.matrix(cells) @ np.array(unknowns) - observations.y


def _on_major_loop(observations: Observations) -> NDArray[np.bool_]:
    """Mask of observations (m,) in negative saturation, on the rise from it, or on the fall from positive
    saturation.

    After cancellation, and with the same output at u₋ for every curve, such a point has at most one term.
    """
    o = observations
    above = o.beta > o.lower
    corners, where = np.unique(np.stack([o.term, o.alpha, o.beta])[:, above], axis=1, return_inverse=True)
    term, alpha, beta = corners[:, np.bincount(where.ravel(), o.sign[above]) != 0]
    inside = (alpha != beta) & (alpha < o.upper)
    count = np.bincount(term.astype(np.int64), np.where(inside, 2, 1), minlength=len(o))
    count[[row for row, *_ in o.released]] = 2
    return count <= 1


# --- warnings --------------------------------------------------------------


def positive_warnings(fit: PositiveFit) -> list[str]:
    """Warnings on the cost of non-negativity, and if nothing could be held out."""
    held_out_error, found = fit.held_out, []
    if held_out_error.rms > NEGATIVE_MASS_RATIO * held_out_error.signed_rms:
        found.append(
            f"The data favour negative mass: {held_out_error.curves} held-out curves are predicted to "
            f"{held_out_error.rms:.3g}{spaced(fit.unit)} rms with μ ≥ 0 and to "
            f"{held_out_error.signed_rms:.3g}{spaced(fit.unit)} with masses of any sign, so non-negativity costs "
            f"{held_out_error.rms - held_out_error.signed_rms:.2g}{spaced(fit.unit)}."
        )
    if not fit.by_smoothing:
        found.append(
            f"There are fewer than {FEWEST_CURVES} curves to hold out, so the smoothing could not be chosen from "
            f"the data (λ = {fit.smoothing:.0g} was used), and intervals do not include the model's own error."
        )
    return found


def surface_warnings(
    image: object, data: FodData, fit: SurfaceFit | None, density: DensityReport
) -> list[str]:
    """Warnings on fits that did not converge or are not determined, and on cells of a table with negative mass."""
    found = []
    if fit and not fit.converged:
        found.append("The surface fit did not converge. Compare it with another surface before you use it.")
    if fit and not fit.determined:
        found.append("The data do not determine all parameters of the surface, so there are no intervals.")
    if not data.mirrored:
        found += _partition_warnings(image)
    if fit is None and density.negative_cells:
        found.append(
            f"{density.negative_cells} of the table's {density.cells} cells have negative mass. Noise of the "
            "readings does that too, so this alone does not prove μ < 0."
        )
    return found


@singledispatch
def _partition_warnings(image: object) -> list[str]:
    del image
    return []


@_partition_warnings.register
def _interpolated_warnings(image: ForcTable) -> list[str]:
    del image
    return ["The curves do not share one partition. The table is interpolated between them."]
