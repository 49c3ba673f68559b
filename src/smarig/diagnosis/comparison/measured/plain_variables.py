"""Smooth discrepancies in one plain variable: of the output, the gain, the input, and the width of the loop.

    k̃ = HkH,    k̃ · (1, ŷŷᵀ, ggᵀ, (g d)(g d)ᵀ),    g: local slope ∂y/∂v,  d: direction

Each is centred, for the constant part is the density's, and every variable would win alike.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.diagnosis.comparison.measured.acting_effects import CONDITION_LENGTH, centred
from smarig.diagnosis.comparison.measured.reading_problem import ReadingProblem, alike

Array = NDArray[np.float64]
LENGTH = 0.35  # of the variable's range
NEEDS_CLOCK = ("rate", "speed", "time", "since")
VARIABLES = ("rate", "speed", "time", "cycle", "history", "since", "stress", "run")
BETWEEN_RUNS = ("stress", "run")


@dataclass(frozen=True, eq=False)
class Surface:
    """Output ``level`` (m,) of a fit, centred, and its ``slope`` (m,) along the input, of a size like the level's."""

    level: Array
    slope: Array


def testable_variables(problem: ReadingProblem) -> list[str]:
    """The variables that change over the training readings; "run" only where no stress says what differs."""
    names = [n for n in VARIABLES if n in problem.variables]
    names = [n for n in names if problem.clock or n not in NEEDS_CLOCK]
    names = [n for n in names if np.ptp(problem.variables[n][problem.train]) > 1e-9]
    return [n for n in names if not (n == "run" and "stress" in names)]


def variable_parts(problem: ReadingProblem, name: str, surface: Surface) -> list[Array]:
    """Covariances (m, m) of the discrepancies in a variable."""
    z = problem.variables[name]
    length = CONDITION_LENGTH if name == "stress" else LENGTH
    k = centred((z[:, None] == z) * 1.0 if name == "run" else alike(z, length), problem.train)
    width = surface.slope * problem.variables["direction"]
    return [k, *(k * np.outer(f, f) for f in (surface.level, surface.slope, width))]
