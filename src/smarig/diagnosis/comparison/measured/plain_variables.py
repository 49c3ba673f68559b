"""Smooth discrepancies in one plain variable: of the output, the gain, the input, and the width of the loop.

    k̃ = HkH,    k̃ · (1, ŷŷᵀ, ggᵀ, (g d)(g d)ᵀ),    g: local slope ∂y/∂v,  d: direction

Each is centred, for the constant part is the density's, and every variable would win alike.
"""

from dataclasses import dataclass

import numpy as np

from smarig.core import Array
from smarig.diagnosis.comparison.measured.acting_effects import CONDITION_LENGTH, centred
from smarig.diagnosis.comparison.measured.reading_problem import ReadingProblem, rough_kernel, smooth_kernel
from smarig.diagnosis.comparison.measured.varied_together import (
    OVER_CYCLES,
    WITHIN,
    at_one_rate,
    between_runs,
)

LENGTH = 0.35  # of the variable's range
NEEDS_CLOCK = ("rate", "speed", "time", "time_since_reversal")
VARIABLES = ("rate", "speed", "time", "cycle", "history", "time_since_reversal", "stress", "run")
FEWEST_CYCLES = 3  # of one record: with fewer, a drift is a part of the loop


@dataclass(frozen=True, eq=False)
class Surface:
    """Output ``level`` (m,) of a fit, centred, and its ``slope`` (m,) along the input, of a size like the level's."""

    level: Array
    slope: Array

    def shapes(self, problem: ReadingProblem) -> tuple[Array, Array, Array]:
        """What a change of the gain, of the input, and of the width of the loop looks like, (m,) each."""
        return self.level, self.slope, self.slope * problem.variables["direction"]


def testable_variables(problem: ReadingProblem) -> list[str]:
    """The variables that change over the training readings.

    "run" is one where no recorded condition says what differs between runs, a stress or a rate of each run.
    """
    names = [n for n in VARIABLES if n in problem.variables]
    names = [n for n in names if problem.clock or n not in NEEDS_CLOCK]
    names = [n for n in names if np.ptp(problem.variables[n][problem.train]) > 1e-9]
    if _most_cycles(problem) < FEWEST_CYCLES:
        names = [n for n in names if n not in OVER_CYCLES]
    if at_one_rate(problem):
        names = [n for n in names if n not in ("rate", "speed")]
    if _time_is_distance(problem):
        names = [n for n in names if n != "time_since_reversal"]
    known = "stress" in names or ("rate" in names and "rate" in between_runs(problem))
    return [n for n in names if not (n == "run" and known)]


def _time_is_distance(problem: ReadingProblem) -> bool:
    """Whether the time since a reversal is the distance of the input from it, as at one rate without holds."""
    z = {n: problem.variables[n][problem.train] for n in ("level", "history", "time_since_reversal")}
    distance, time = np.abs(z["level"] - z["history"]), 10 ** z["time_since_reversal"]
    return bool(np.corrcoef(distance, time)[0, 1] ** 2 > 1 - WITHIN)


def _most_cycles(problem: ReadingProblem) -> float:
    cycle = problem.variables["cycle"]
    return max(
        float(np.ptp(cycle[problem.record == r])) + 0.5 for r in np.unique(problem.record[problem.train])
    )


def variable_parts(problem: ReadingProblem, name: str, surface: Surface) -> list[Array]:
    """Covariances (m, m) of the discrepancies in a variable."""
    z, own = problem.variables[name], problem.variables[name][problem.train]
    if name in OVER_CYCLES:  # nothing is known beyond the training readings: the last value goes on
        z = np.clip(z, own.min(), own.max())
    length = CONDITION_LENGTH if name == "stress" else LENGTH
    if name == "run":
        k = (z[:, None] == z) * 1.0
    else:  # what time brings may come and go; what a rate or a load changes is smooth in it
        k = rough_kernel(z, length) if name in OVER_CYCLES else smooth_kernel(z, length)
    if name == "time":  # a clock that starts again tells where in the programme a reading is
        k = k * (problem.record[:, None] == problem.record)
    k = centred(k, problem.train)
    return [k, *(k * np.outer(f, f) for f in surface.shapes(problem))]
