"""Whether an effect closes loops: what a model misses at the ends of the input, visit after visit.

At the ends of its range the input has erased the memory and the output is flat, so neither the measure nor the noise of
the input matters there. An output that differs from one visit to the next depends on something else. Over all readings
such a drift can hide in the noise of steep branches.
"""

import numpy as np
from numpy.typing import NDArray

from smarig.identification import MeasuredHypothesis

Array = NDArray[np.float64]
END_SHARE = 0.05  # of the input's range: readings this close to an end of it
FEWEST_VISITS = 10  # blocks with such a reading
LARGE_SHARE = 0.01  # of the output's range: a smaller error at the ends needs no cause
LEAST_GAIN = 0.4  # of the error at the ends
PROGRESSING = ("cycle", "time")


def closes_loops(tried: MeasuredHypothesis, start: MeasuredHypothesis) -> bool:
    """Whether the effect that a hypothesis adds changes the output with cycles or time, and removes most of the error
    at the ends of the input, without more error elsewhere.
    """
    kind = tried.effects[-1].kind
    if not kind.additive or not set(kind.depends_on) & set(PROGRESSING) or tried.rms > start.rms:
        return False
    before, after = end_squares(start), end_squares(tried)
    if before.size < FEWEST_VISITS or _root(before) < LARGE_SHARE * _output_range(start):
        return False
    return _root(after) < (1 - LEAST_GAIN) * _root(before)


def end_error(hypothesis: MeasuredHypothesis) -> float:
    """Rms error on left-out blocks at the ends of the input."""
    return _root(end_squares(hypothesis))


def end_squares(hypothesis: MeasuredHypothesis) -> Array:
    """Mean square error at the ends of the input, of each left-out block that comes there (k,)."""
    plan, known = hypothesis.fit.problem.plan, np.isfinite(hypothesis.errors)
    u = plan.of([r.u for r in plan.records])
    low, high = float(u[known].min()), float(u[known].max())
    near = END_SHARE * (high - low)
    at_end = known & ((u <= low + near) | (u >= high - near))
    block = np.unique(plan.block[at_end], return_inverse=True)[1]
    return np.bincount(block, hypothesis.errors[at_end] ** 2) / np.bincount(block)


def _output_range(hypothesis: MeasuredHypothesis) -> float:
    return float(np.ptp(hypothesis.fit.problem.plan.y[np.isfinite(hypothesis.errors)]))


def _root(squares: Array) -> float:
    return float(np.sqrt(np.mean(squares)))
