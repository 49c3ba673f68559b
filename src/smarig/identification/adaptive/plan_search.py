"""The search for the plan of a few holds with the most information per second of rig time.

A greedy choice of single points fails: a peak gives little information, but the fall after it gives much. So all
moves are tried, the best are continued, and the sequence with the best ratio of information to time is taken. The
posterior covariance of a Gaussian process depends on the inputs only, not on the readings, so a plan can be
evaluated before it is run.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from smarig.core import Array
from smarig.identification.adaptive.memory_path import MemoryPath, path_after, rows
from smarig.identification.adaptive.surface_posterior import SurfacePosterior

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
