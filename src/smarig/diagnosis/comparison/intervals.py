"""Intervals of searched parameters from the scores of their trials.

    p(θ) ∝ E_a exp(Σ_b a_b s_b(θ) / T)

a are resampled shares of the blocks, so an interval is that of the scores and of the choice of blocks. Around the best
trial the scores are a parabola in θ, or in log θ if all have one sign; elsewhere they are linear between trials.
"""

import numpy as np

from smarig.core import Array
from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis, Trial
from smarig.diagnosis.comparison.weights import CREDIBLE, Weights

POINTS = 40  # between two trials
DRAWS = 200


def interval(hypothesis: ComparedHypothesis, parameter: str, weights: Weights) -> tuple[float, float]:
    """The central 95 % of a parameter, with the others at their best for each value."""
    first: dict[tuple[float, ...], Trial] = {}
    for trial in hypothesis.trials:  # the first of its values: later ones stand in another basis
        first.setdefault(tuple(trial.parameters.values()), trial)
    scores: dict[float, Array] = {}
    for trial in sorted(first.values(), key=lambda t: t.score):
        scores[trial.parameters[parameter]] = trial.log_scores
    values = np.array(sorted(scores))
    if values.size < 2:
        return float(values[0]), float(values[0])
    logarithmic = bool(np.all(values > 0))
    x = np.log(values) if logarithmic else values
    grid = np.unique(np.concatenate([np.linspace(a, b, POINTS) for a, b in zip(x, x[1:])]))
    spacing = np.gradient(grid)
    totals = weights.shares[:DRAWS] @ np.array([scores[v] for v in values.tolist()]).T / weights.temperature
    density = np.zeros(grid.size)
    for row in totals:
        p = np.exp(_between_trials(x, row - row.max(), grid)) * spacing
        density += p / p.sum()
    cumulative = np.cumsum(density) / density.sum()
    low, high = np.interp([(1 - CREDIBLE) / 2, (1 + CREDIBLE) / 2], cumulative, grid)
    return (float(np.exp(low)), float(np.exp(high))) if logarithmic else (float(low), float(high))


def _between_trials(x: Array, total: Array, grid: Array) -> Array:
    """Scores on a grid, with a parabola through the best trial and its neighbours; largest 0."""
    found, k = np.interp(grid, x, total), int(total.argmax())
    if 0 < k < x.size - 1:
        (a, b, c), (low, top, high) = x[k - 1 : k + 2], total[k - 1 : k + 2]
        inside = (grid >= a) & (grid <= c)
        z = grid[inside]
        bend = ((high - top) / (c - b) - (top - low) / (b - a)) / (c - a)
        found[inside] = low + (top - low) / (b - a) * (z - a) + bend * (z - a) * (z - b)
    return found - found.max()
