"""Fits of learned terms: linear ones with the measure, those at the input by Gauss–Newton steps.

A shift f of the input changes the output by ∂y/∂v f to first order. Each step fits the increments of all values at the
knots together with the measure, then follows the changed input exactly.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, root_mean_square
from smarig.identification import (
    SMOOTHINGS,
    Comparison,
    MeasuredFit,
    MeasuredHypothesis,
    fit_measured,
    held_out_errors,
    local_slope,
    measured_problem,
)
from smarig.measurement import LEVEL, LearnedTerm, branch_directions, variable_of

STEPS = 5  # Gauss–Newton
CONVERGED = 1e-3  # relative change of the error
LEAST_SMOOTHING = 0.005  # of that of the plain model: a term permits one step less, not two
LEARNED = "learned"


@dataclass(frozen=True, eq=False)
class LearnedFit:
    """Learned terms, and the hypothesis of a model with them."""

    terms: tuple[LearnedTerm, ...]
    hypothesis: MeasuredHypothesis

    @property
    def coefficients(self) -> int:
        """Number of free values."""
        return sum(len(t.knots) - 1 for t in self.terms)


def levels(fit: MeasuredFit) -> Array:
    """Outputs (m,) of the hysteresis with the zero of the first record, without terms."""
    of_reading = fit.zeros[fit.problem.observations.zero]
    return fit.predicted - fit.problem.terms @ fit.amplitudes - of_reading + fit.zeros[0]


def readings_of(fit: MeasuredFit, variable: str) -> Array:
    """A variable (m,) at the readings."""
    if variable == LEVEL:
        return levels(fit)
    plan = fit.problem.plan
    return plan.of([variable_of(r, variable) for r in plan.records])


def columns(fit: MeasuredFit, term: LearnedTerm) -> Array:
    """Changes of the output (m, knots − 1) by each value of a term, to first order at a fit."""
    plan, functions = fit.problem.plan, term.functions(readings_of(fit, term.variable))
    if term.form == "output":
        return functions
    if term.form == "output_gain":
        return functions * (levels(fit) - term.centre)[:, None]
    slope = local_slope(fit)
    if term.form == "play":
        slope = -slope * plan.of([branch_directions(r) for r in plan.records])
    if term.form == "input_gain":
        slope = slope * (plan.of([r.u for r in plan.records]) - term.centre)
    return functions * slope[:, None]


def linear(comparison: Comparison, at: MeasuredFit, terms: Sequence[LearnedTerm]) -> MeasuredHypothesis:
    """The hypothesis in which the values of all terms (at least one) are free, to first order at a fit; those at the
    input are free beyond their present values.
    """
    joined = np.hstack([columns(at, term) for term in terms])
    fit = _fitted(comparison, terms, joined, at)
    errors = held_out_errors(fit.problem, comparison.smoothing, comparison.train)
    return MeasuredHypothesis((), errors, fit, LEARNED)


def _fitted(
    comparison: Comparison, terms: Sequence[LearnedTerm], joined: Array, near: MeasuredFit
) -> MeasuredFit:
    present = [t for t in terms if any(t.values)]
    problem = measured_problem(comparison.plan, learned=present, extra_terms=joined, weight=comparison.weight)
    return fit_measured(problem, comparison.smoothing, comparison.train, near=near)


def refined(comparison: Comparison, start: MeasuredFit, terms: Sequence[LearnedTerm]) -> LearnedFit:
    """The terms with their best values, found from a fit without them, and errors on held-out blocks for which the
    values were estimated without these blocks, to first order.
    """
    at, best = start, (np.inf, start, terms)
    for _ in range(STEPS):
        free = _fitted(comparison, terms, np.hstack([columns(at, t) for t in terms]), at)
        terms = _moved(terms, free.amplitudes)
        at = _with_outputs(comparison, terms, free)
        error = _error(comparison, at)
        if error > (1 - CONVERGED) * best[0]:
            break
        best = error, at, terms
    return min(
        (
            _finished(replace(comparison, smoothing=s), best[1], best[2])
            for s in SMOOTHINGS
            if s >= LEAST_SMOOTHING * comparison.smoothing
        ),
        key=lambda found: found.hypothesis.rms,
    )


def _finished(comparison: Comparison, near: MeasuredFit, terms: Sequence[LearnedTerm]) -> LearnedFit:
    """The fit at the smoothing of a comparison, with the errors on held-out blocks."""
    at = _with_outputs(comparison, terms, near)
    terms = _moved([t for t in terms if t.enters == "output"], at.amplitudes, others=terms)
    errors = linear(comparison, at, terms).errors
    return LearnedFit(tuple(terms), MeasuredHypothesis((), errors, at, LEARNED))


def _with_outputs(comparison: Comparison, terms: Sequence[LearnedTerm], at: MeasuredFit) -> MeasuredFit:
    """The fit with the terms at the input as they are, and free values of those at the output."""
    joined = [columns(at, t) for t in terms if t.enters == "output"]
    return _fitted(comparison, terms, np.hstack([np.empty((len(comparison.plan), 0)), *joined]), at)


def _error(comparison: Comparison, fit: MeasuredFit) -> float:
    return root_mean_square((comparison.weight * fit.error)[comparison.train])


def _moved(
    terms: Sequence[LearnedTerm], amplitudes: Array, others: Sequence[LearnedTerm] = ()
) -> list[LearnedTerm]:
    """Terms with their new values: those at the output replaced, those at the input added to. ``others`` (all terms, of
    which ``terms`` are some) keeps the rest.
    """
    moved, first = {}, 0
    for term in terms:
        own = amplitudes[first : first + len(term.knots) - 1]
        first += own.size
        moved[id(term)] = term.with_values(
            own if term.enters == "output" else np.array(term.values[1:]) + own
        )
    return [moved.get(id(t), t) for t in (others or terms)]


def empty_term(
    fit: MeasuredFit, variable: str, form: str, count: int, within: NDArray[np.bool_], place: float = 0.5
) -> LearnedTerm:
    """A term with up to ``count`` knots at quantiles of its variable, all values 0.

    Knots that fall together are merged, so a variable with few values has a knot at each. ``place`` is where the centre
    of a gain lies, from 0 at the smallest to 1 at the largest value of the second variable.
    """
    z = readings_of(fit, variable)[within]
    span = float(np.ptp(z)) or 1.0
    values = np.unique(np.round((z - z.min()) / (1e-3 * span))) * 1e-3 * span + z.min()
    knots = values if values.size <= count else np.quantile(z, np.linspace(0, 1, count))
    knots = knots[np.concatenate([[True], np.diff(knots) > 1e-3 * span])]
    second = _second(fit, form)[within]
    centre = float(second.min() + place * np.ptp(second))
    return LearnedTerm(variable, form, tuple(knots.tolist()), (0.0,) * knots.size, centre)


def _second(fit: MeasuredFit, form: str) -> Array:
    """The second variable (m,) of a gain; 0 for other forms."""
    if form == "output_gain":
        return levels(fit)
    plan = fit.problem.plan
    return plan.of([r.u for r in plan.records]) if form == "input_gain" else np.zeros(len(plan))
