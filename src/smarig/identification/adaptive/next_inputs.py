"""The choice of the next holds by expected information about the Preisach measure per minute of rig time.

It fits ``positive`` to all results, takes the remaining uncertainty of the surface, and plans a few holds ahead.
Holds that did not settle change the memory, but are not used as readings. The choice depends on the results only,
so the same results give the same choice.

The search for the plan of a few holds with the most information per second of rig time.

A greedy choice of single points fails: a peak gives little information, but the fall after it gives much. So all
moves are tried, the best are continued, and the sequence with the best ratio of information to time is taken. The
posterior covariance of a Gaussian process depends on the inputs only, not on the readings, so a plan can be
evaluated before it is run.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from smarig.core import Array, Settled
from smarig.identification.adaptive.memory_path import (
    MemoryPath,
    corners,
    duration_s,
    path_after,
    paths_along,
    rows,
)
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


MAX_HOLDS, BEAM_WIDTH = 4, 24  # holds of a plan; plans continued after each hold but the first
HoldCost = Callable[[float, float], float]


@dataclass(frozen=True, eq=False)
class HoldPlan:
    """The last hold of a plan: the memory after it, and gain and time of the whole plan.

    ``covariance_x`` and ``reduction_x`` (n,) are C x and C W C x of its observation x, with C after the earlier
    holds. ``predictive_variance`` and ``variance_reduction`` are x·C·x + noise² and x·C·W·C·x. ``gain`` is Σ
    variance_reduction/predictive_variance, counts².
    """

    path: MemoryPath
    before: "HoldPlan | None" = None
    gain: float = 0.0
    cost_s: float = 0.0
    covariance_x: Array = field(default_factory=lambda: np.empty(0))
    reduction_x: Array = field(default_factory=lambda: np.empty(0))
    predictive_variance: float = 1.0
    variance_reduction: float = 0.0

    @property
    def rate(self) -> float:
        """Reduction of the mean variance per second."""
        return self.gain / self.cost_s if self.cost_s else 0.0

    @property
    def inputs(self) -> tuple[float, ...]:
        """The inputs to hold, in order."""
        return () if self.before is None else (*self.before.inputs, self.path[-1])

    def chain(self) -> "Iterator[HoldPlan]":
        """The holds of the plan, in order."""
        if self.before is not None:
            yield from self.before.chain()
            yield self


def best_plan(posterior: SurfacePosterior, path: MemoryPath, levels: Array, cost: HoldCost) -> HoldPlan:
    """The sequence of up to ``MAX_HOLDS`` moves between ``levels`` with the greatest gain per second."""
    plans = [HoldPlan(path)]
    best = plans[0]
    for depth in range(MAX_HOLDS):
        candidates = _extended_plans(plans, posterior, levels.tolist(), cost)
        candidates.sort(key=lambda plan: -plan.rate)
        if not candidates:
            break
        best = candidates[0] if candidates[0].rate > best.rate else best
        plans = _distinct(candidates, BEAM_WIDTH if depth else len(candidates))
    return best


def _distinct(plans: list[HoldPlan], most: int) -> list[HoldPlan]:
    """The first ``most`` plans that lead to different memories."""
    kept: dict[MemoryPath, HoldPlan] = {}
    for plan in plans:
        if len(kept) < most:
            kept.setdefault(plan.path, plan)
    return list(kept.values())


def _extended_plans(
    plans: list[HoldPlan], posterior: SurfacePosterior, levels: list[float], cost: HoldCost
) -> list[HoldPlan]:
    """All plans continued by one hold, at each level."""
    paths = [[path_after(plan.path, u) for u in levels if u != plan.path[-1]] for plan in plans]
    x = rows(posterior.triangle, [path for some in paths for path in some])
    dense, covariance_x, reduction_x = x.toarray(), x @ posterior.covariance, x @ posterior.shared_reduction
    found, at = [], 0
    for plan, some in zip(plans, paths):
        one = slice(at, at := at + len(some))
        found += _extend_plan(
            before=plan,
            paths=some,
            x=dense[one],
            covariance_x=covariance_x[one],
            reduction_x=reduction_x[one],
            noise=posterior.noise,
            cost=cost,
        )
    return found


def _extend_plan(
    before: HoldPlan,
    paths: list[MemoryPath],
    x: Array,
    covariance_x: Array,
    reduction_x: Array,
    noise: float,
    cost: HoldCost,
) -> list[HoldPlan]:
    """A plan continued to each path: rows x (k, n), with their C x and C W C x before the first hold of the plan."""
    for hold in before.chain():  # rank-one downdates of C and C W C, for these rows only
        by, also = (x @ hold.covariance_x)[:, None], (x @ hold.reduction_x)[:, None]
        reduction_x = (
            reduction_x
            - by
            * (hold.reduction_x - hold.covariance_x * (hold.variance_reduction / hold.predictive_variance))
            / hold.predictive_variance
        )
        reduction_x -= also * hold.covariance_x / hold.predictive_variance
        covariance_x = covariance_x - by * hold.covariance_x / hold.predictive_variance
    predictive_variance = np.einsum("ij,ij->i", x, covariance_x) + noise**2
    variance_reduction = np.einsum("ij,ij->i", x, reduction_x)
    gain, here = before.gain + variance_reduction / predictive_variance, before.path[-1]
    return [
        HoldPlan(
            path=path,
            before=before,
            gain=float(gain[k]),
            cost_s=before.cost_s + cost(here, path[-1]),
            covariance_x=covariance_x[k],
            reduction_x=reduction_x[k],
            predictive_variance=float(predictive_variance[k]),
            variance_reduction=float(variance_reduction[k]),
        )
        for k, path in enumerate(paths)
    ]
