"""The choice of the next holds by expected information about the Preisach measure per minute of rig time.

It fits ``positive`` to all results, takes the remaining uncertainty of the surface, and plans a few holds ahead.
Holds that did not settle change the memory, but are not used as readings. The choice depends on the results only,
so the same results give the same choice.
"""

from collections.abc import Sequence
from functools import partial

import numpy as np

from smarig.core import Array, Settled
from smarig.identification.adaptive.memory_path import MemoryPath, corners, duration_s, paths_along, rows
from smarig.identification.adaptive.plan_search import best_plan
from smarig.identification.adaptive.surface_posterior import (
    SurfacePosterior,
    density_amplitude,
    reading_noise_sd,
    surface_posterior,
)
from smarig.identification.positive import Observations, fit_positive
from smarig.identification.positive.observations import COMMON
from smarig.identification.positive.triangle import Triangle
from smarig.protocols import HoldResult, NextInputs, Setup

INTERVALS = 24  # of the triangle used for planning
SMOOTHING = 1e-12
_MIN_READINGS = 6  # readings needed before the measure is fitted
_PRIOR_REVERSIBLE_SHARE = 0.05  # prior share of the reversible part in the output range, before that


def informed_choice(setup: Setup, seen: Sequence[HoldResult], settle: Settled) -> NextInputs:
    """The next few holds by expected information per minute, and the predicted rms error now.

    Information is the reduction of the variance of y(α, β), averaged over the triangle (I-optimality).
    """
    ends = setup.lower_K, setup.upper_K
    paths = paths_along(ends[:1], tuple(float(np.clip(s.input_K, *ends)) for s in seen))
    good = [k for k, s in enumerate(seen) if s.settled and np.isfinite(s.counts)]
    counts = np.array([seen[k].counts for k in good])
    if not counts.size or np.ptp(counts) == 0:
        return NextInputs(
            () if counts.size > 2 else ends
        )  # the output does not move, or nothing has settled yet
    noise = reading_noise_sd((seen[k].counts_sd for k in good), (seen[k].n for k in good))
    posterior = _posterior([paths[k] for k in good], counts, noise, ends)
    plan = best_plan(posterior, paths[-1], posterior.triangle.nodes, partial(duration_s, setup, settle))
    return NextInputs(plan.inputs, posterior.rms / float(np.ptp(counts)))


def _posterior(
    paths: list[MemoryPath], counts: Array, noise: float, ends: tuple[float, float]
) -> SurfacePosterior:
    """The posterior from settled counts (m,) after these memories."""
    saturated = [k for k, path in enumerate(paths) if len(path) == 1]
    change = counts - (counts[saturated].mean() if saturated else counts.min())
    if counts.size < _MIN_READINGS:
        triangle = Triangle(np.linspace(*ends, INTERVALS + 1))
        on = triangle.i == triangle.j
        density = np.where(on, _PRIOR_REVERSIBLE_SHARE, 2 * (1 - _PRIOR_REVERSIBLE_SHARE)) * float(
            np.ptp(counts)
        )
    else:
        fit = fit_positive(observations(paths, counts, ends), intervals=INTERVALS, smoothing=SMOOTHING)
        triangle, density = fit.triangle, density_amplitude(fit.triangle, fit.masses)
        noise = max(noise, fit.sigma)  # the error of cells this wide counts as noise
    return surface_posterior(triangle, density, rows(triangle, paths), change, noise)


def observations(
    paths: list[MemoryPath], outputs: Array, ends: tuple[float, float], unit: str = "counts"
) -> Observations:
    """Outputs (m,) after known memories, as observations for ``positive``; a curve is a monotone branch."""
    term, sign, alpha, beta = corners(paths)
    turns = np.diff(np.sign(np.diff([path[-1] for path in paths]))) != 0
    curve = np.concatenate([[0], np.cumsum(turns), [np.sum(turns)]])[: outputs.size].astype(np.int64)
    common = np.full(outputs.size, COMMON)
    return Observations(outputs, curve, common, term, sign, alpha, beta, (), *ends, unit)
