"""Intervals of searched parameters from the scores of their trials.

    p(θ) ∝ E_a exp(Σ_b a_b s_b(θ) / T)

a are resampled shares of the blocks, so an interval is that of the scores and of the choice of blocks; between trials
the scores are linear in θ, or in log θ if all have one sign.
"""

import numpy as np
from numpy.typing import NDArray

from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis, Trial
from smarig.diagnosis.comparison.weights import CREDIBLE, Weights

Array = NDArray[np.float64]
POINTS = 400
DRAWS = 200


def interval(hypothesis: ComparedHypothesis, parameter: str, weights: Weights) -> tuple[float, float]:
    """The central 95 % of a parameter, with the others at their best for each value."""
    first: dict[tuple[float, ...], Trial] = {}
    for trial in hypothesis.trials:  # the first of its values: later ones were fitted with other slopes
        first.setdefault(tuple(trial.parameters.values()), trial)
    scores: dict[float, Array] = {}
    for trial in sorted(first.values(), key=lambda t: t.score):
        scores[trial.parameters[parameter]] = trial.log_scores
    values = np.array(sorted(scores))
    if values.size < 2:
        return float(values[0]), float(values[0])
    logarithmic = bool(np.all(values > 0))
    x = np.log(values) if logarithmic else values
    grid = np.linspace(x[0], x[-1], POINTS)
    totals = weights.shares[:DRAWS] @ np.array([scores[v] for v in values.tolist()]).T / weights.temperature
    density = np.zeros(POINTS)
    for row in totals:
        p = np.exp(np.interp(grid, x, row - row.max()))
        density += p / p.sum()
    cumulative = np.cumsum(density) / density.sum()
    low, high = np.interp([(1 - CREDIBLE) / 2, (1 + CREDIBLE) / 2], cumulative, grid)
    return (float(np.exp(low)), float(np.exp(high))) if logarithmic else (float(low), float(high))
