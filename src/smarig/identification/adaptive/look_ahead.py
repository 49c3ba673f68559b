"""The plan that teaches most per second of rig time, a few holds deep.

Greedy choice of single points fails: a peak teaches little, the fall it opens teaches much. So all moves are
tried, the best continued, and the sequence with the best ratio of information to time is taken. A Gaussian
belief shrinks by what is asked, not by what is answered, so a plan can be judged before it is run.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from smarig.identification.adaptive.belief import Belief
from smarig.identification.adaptive.path import Path, moved, rows

Array = NDArray[np.float64]
DEPTH, WIDTH = 4, 24  # holds of a plan; plans continued after each hold but the first
Cost = Callable[[float, float], float]


@dataclass(frozen=True, eq=False)
class Plan:
    """A hold at the end of a plan: where it leaves the memory, and gain and time of the whole plan.

    ``reached`` and ``told`` (n,) are C x and C W C x of its observation x, with C as the holds before leave it;
    ``size`` and ``worth`` are x·C·x + noise² and x·C·W·C·x. ``gain`` is Σ worth/size, counts².
    """

    path: Path
    before: "Plan | None" = None
    gain: float = 0.0
    cost_s: float = 0.0
    reached: Array = field(default_factory=lambda: np.empty(0))
    told: Array = field(default_factory=lambda: np.empty(0))
    size: float = 1.0
    worth: float = 0.0

    @property
    def rate(self) -> float:
        """Variance taken off the mean, per second."""
        return self.gain / self.cost_s if self.cost_s else 0.0

    @property
    def inputs(self) -> tuple[float, ...]:
        """What to hold, in order."""
        return () if self.before is None else (*self.before.inputs, self.path[-1])

    def chain(self) -> "Iterator[Plan]":
        """The holds of the plan, in order."""
        if self.before is not None:
            yield from self.before.chain()
            yield self


def best_plan(belief: Belief, path: Path, levels: Array, cost: Cost) -> Plan:
    """The sequence of up to ``DEPTH`` moves between ``levels`` with the greatest gain per second."""
    plans = [Plan(path)]
    best = plans[0]
    for depth in range(DEPTH):
        tried = _continued(plans, belief, levels.tolist(), cost)
        tried.sort(key=lambda plan: -plan.rate)
        if not tried:
            break
        best = tried[0] if tried[0].rate > best.rate else best
        plans = _distinct(tried, WIDTH if depth else len(tried))
    return best


def _distinct(plans: list[Plan], most: int) -> list[Plan]:
    """The first ``most`` plans that leave different memories."""
    kept: dict[Path, Plan] = {}
    for plan in plans:
        if len(kept) < most:
            kept.setdefault(plan.path, plan)
    return list(kept.values())


def _continued(plans: list[Plan], belief: Belief, levels: list[float], cost: Cost) -> list[Plan]:
    """All plans with one more hold, at each level."""
    paths = [[moved(plan.path, u) for u in levels if u != plan.path[-1]] for plan in plans]
    x = rows(belief.triangle, [path for some in paths for path in some])
    dense, reached, told = x.toarray(), x @ belief.covariance, x @ belief.shared
    found, at = [], 0
    for plan, some in zip(plans, paths):
        one = slice(at, at := at + len(some))
        found += _with_one_more(plan, some, dense[one], reached[one], told[one], belief.noise, cost)
    return found


def _with_one_more(
    before: Plan, paths: list[Path], x: Array, reached: Array, told: Array, noise: float, cost: Cost
) -> list[Plan]:
    """A plan continued to each path: rows x (k, n) and their C x, C W C x before anything of the plan is held."""
    for hold in before.chain():  # rank-one downdates of C and C W C, applied to these rows only
        by, also = (x @ hold.reached)[:, None], (x @ hold.told)[:, None]
        told = told - by * (hold.told - hold.reached * (hold.worth / hold.size)) / hold.size
        told -= also * hold.reached / hold.size
        reached = reached - by * hold.reached / hold.size
    size = np.einsum("ij,ij->i", x, reached) + noise**2
    worth = np.einsum("ij,ij->i", x, told)
    gain, here = before.gain + worth / size, before.path[-1]
    return [
        Plan(
            path,
            before,
            float(gain[k]),
            before.cost_s + cost(here, path[-1]),
            reached[k],
            told[k],
            float(size[k]),
            float(worth[k]),
        )
        for k, path in enumerate(paths)
    ]
