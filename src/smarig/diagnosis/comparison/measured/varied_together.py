"""What varies with what in the training records: causes that these data cannot part, whatever their scores.

A variable that is constant within each run, and steps between runs, is confounded with every other such variable: with
two or three runs, any of them explains what differs. The recorded condition of an effect is set on purpose, so the
variables that follow it are its consequences. Of two values of a condition, each set in runs of its own, an offset of
the input between runs does the same as the condition. Within the runs, what goes with the rate of an excursion cannot
be parted from what goes with time, if the rate rises or falls all the time.
"""

from collections.abc import Iterable
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.diagnosis.comparison.compared_hypothesis import Part
from smarig.diagnosis.comparison.measured.reading_problem import ReadingProblem
from smarig.measurement import ONE_RATE, measurement_effect_types

OVER_CYCLES, RATES = ("time", "cycle"), ("rate", "speed")
OFFSET, LAG = Part("effect", "input_offset"), Part("effect", "input_lag")
FEWEST_EXCURSIONS = 4  # fewer are in the order of time by chance
WITHIN = 0.1  # of a variable's variance: less of it lies within the runs


def at_one_rate(problem: ReadingProblem) -> bool:
    """Whether the input changes at one rate throughout, but for its turns: a lag is then a part of every loop."""
    slow, fast = np.quantile(problem.variables["speed"][problem.train], [0.1, 0.9])
    return bool(fast - slow < np.log10(ONE_RATE))


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
    fixed, parts = between_runs(problem), tuple(parts)
    within = [p for p in parts if _steps_with(p) in fixed]
    effects = [p for p in within if p.kind == "effect"]
    found = {p: rest for p in within if (rest := tuple(q for q in effects if _unparted(p, q)))}
    others = tuple(p for p in effects if p != OFFSET)
    if others and _two_conditions(problem):
        found |= {p: (*found.get(p, ()), OFFSET) for p in others} | {OFFSET: others}
    trending = _with_time(problem)
    over_time = [p for p in parts if _variable(p) in OVER_CYCLES]
    with_rate = [p for p in parts if _variable(p) in trending]
    for some, rest in ((over_time, with_rate), (with_rate, over_time)):
        found |= {p: (*found.get(p, ()), *rest) for p in some if rest}
    return found


def _unparted(part: Part, other: Part) -> bool:
    """Whether two parts that step between runs cannot be parted; a lag moves both branches apart, an offset alike."""
    return part != other and {part, other} != {OFFSET, LAG}


def _two_conditions(problem: ReadingProblem) -> bool:
    """Whether the runs differ in a condition of two values, and none returns to the first of them.

    Held-out runs count, too: only what goes with the condition predicts a third value, or the return to the first.
    """
    names = set.intersection(*(set(r.conditions) for r in problem.records))
    sets = [[r.conditions[name] for r in problem.records] for name in names]
    return any(len(set(values)) == 2 and sum(a != b for a, b in pairwise(values)) == 1 for values in sets)


def _with_time(problem: ReadingProblem) -> set[str]:
    """The variables that rise or fall all the time from excursion to excursion, though time is not what they are."""
    train = problem.train
    blocks, place = np.unique(problem.block[train], return_inverse=True)
    if blocks.size < FEWEST_EXCURSIONS or "time" not in problem.variables:
        return set()
    count = np.bincount(place)
    means = {
        n: np.bincount(place, problem.variables[n][train]) / count
        for n in (*RATES, "time")
        if n in problem.variables
    }
    order = {n: np.unique(z, return_inverse=True)[1] for n, z in means.items() if np.ptp(z)}
    time = order.pop("time")
    return {n for n, ranks in order.items() if np.corrcoef(ranks, time)[0, 1] ** 2 > 1 - WITHIN}


def _steps_with(part: Part) -> str:
    """The variable by which a part would differ between runs; what grows with time or cycles goes on within them."""
    variable = _variable(part)
    return "" if part.kind == "effect" and variable in OVER_CYCLES else variable


def _variable(part: Part) -> str:
    """The variable that a part acts through, or is."""
    kind = next((k for k in measurement_effect_types() if k.name == part.name), None)
    return (kind.by_condition or kind.depends_on[0]) if kind else part.name
