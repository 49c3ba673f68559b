"""What varies with what in the training records: causes that these data cannot part, whatever their scores.

A variable that is constant within each run, and steps between runs, is confounded with every other such variable: with
two or three runs, any of them explains what differs. The recorded condition of an effect is set on purpose, so the
variables that follow it are its consequences.
"""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from smarig.diagnosis.comparison.compared_hypothesis import Part
from smarig.diagnosis.comparison.measured.reading_problem import ReadingProblem
from smarig.measurement import measurement_effect_types

Array = NDArray[np.float64]
OVER_CYCLES = ("time", "cycle")
WITHIN = 0.1  # of a variable's variance: less of it lies within the runs
RATE_RATIO = 1.5  # of the fast to the slow tenth of the readings: less is one rate


def at_one_rate(problem: ReadingProblem) -> bool:
    """Whether the input changes at one rate throughout, but for its turns: a lag is then a part of every loop."""
    slow, fast = np.quantile(problem.variables["speed"][problem.train], [0.1, 0.9])
    return bool(fast - slow < np.log10(RATE_RATIO))


def between_runs(problem: ReadingProblem) -> set[str]:
    """The variables whose values differ between the training runs and hardly within one."""
    train = problem.train
    runs = problem.record[train]
    if np.unique(runs).size < 2:
        return set()
    return {
        n for n, z in problem.variables.items() if n != "direction" and _share_within(z[train], runs) < WITHIN
    }


def _share_within(z: Array, runs: NDArray[np.int64]) -> float:
    total = float(np.var(z))
    if not total:
        return np.inf
    means = np.array([z[runs == r].mean() for r in np.unique(runs)])
    return float(np.mean((z - means[np.searchsorted(np.unique(runs), runs)]) ** 2)) / total


def confounded(problem: ReadingProblem, parts: Iterable[Part]) -> dict[Part, tuple[Part, ...]]:
    """The parts that these data cannot part from a part."""
    fixed = between_runs(problem)
    within = [p for p in parts if _steps_with(p) in fixed]
    effects = [p for p in within if p.kind == "effect"]
    return {p: tuple(q for q in effects if q != p) for p in within if len(effects) > 1}


def _steps_with(part: Part) -> str:
    """The variable by which a part would differ between runs; what grows with time or cycles goes on within them."""
    kind = next((k for k in measurement_effect_types() if k.name == part.name), None)
    variable = (kind.by_condition or kind.depends_on[0]) if kind else part.name
    return "" if kind and variable in OVER_CYCLES else variable
