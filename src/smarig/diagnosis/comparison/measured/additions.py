"""A candidate: effects and variables added to the plain model, fitted to the readings and scored by blocks."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from smarig.core import Array, root_mean_square
from smarig.diagnosis.comparison.block_predictions import left_out, log_t_density
from smarig.diagnosis.comparison.compared_hypothesis import Part, Trial
from smarig.diagnosis.comparison.gaussian_fit import LEVEL, GaussianFit, fit_gaussian
from smarig.diagnosis.comparison.measured.acting_effects import acting_inputs, added_parts
from smarig.diagnosis.comparison.measured.plain_variables import Surface, variable_parts
from smarig.diagnosis.comparison.measured.positive_prior import PositiveDensity, PositivePrior, positive_prior
from smarig.diagnosis.comparison.measured.reading_problem import ReadingProblem
from smarig.measurement import LearnedTerm, MeasurementEffect

Rows = NDArray[np.int64]
SLOPE_SIZE = 0.3  # of the output's standard deviation: slopes are comparable with the level
FIRST_SIZE, ADDED_SIZE, BLOCK_SIZE, NOISE_SIZE = 0.3, 0.005, 1e-3, 1e-4
SMALL = 1e-2


@dataclass(frozen=True)
class Addition:
    """What is added to the plain model: effects with their values, and variables, of which some move the input by
    ``laws``.
    """

    effects: tuple[MeasurementEffect, ...] = ()
    variables: tuple[str, ...] = ()
    laws: tuple[LearnedTerm, ...] = ()

    @property
    def parts(self) -> tuple[Part, ...]:
        """The parts of a hypothesis."""
        effects = [Part("effect", e.kind.name) for e in self.effects]
        return (*effects, *(Part("variable", v) for v in self.variables))

    def with_effect(self, effect: MeasurementEffect) -> "Addition":
        """With one more effect."""
        return replace(self, effects=(*self.effects, effect))

    @property
    def moves_input(self) -> bool:
        """Whether an effect or a law changes the input that acts."""
        return bool(self.laws) or any(not e.kind.additive for e in self.effects)


@dataclass(frozen=True, eq=False)
class KeptAddition:
    """A fitted candidate without its covariances, for those of all candidates would fill the memory.

    ``output`` (m,) is predicted from the training readings, and ``added`` (m,) the share of the candidate's own parts.
    ``common`` is the number of sizes before theirs. ``run_error`` is the rms of the errors of each training run
    predicted from the others.
    """

    candidate: Addition
    relays: PositiveDensity
    common: int
    sizes: Array
    dual: Array
    error: Array
    output: Array
    added: Array
    run_error: float
    problem: ReadingProblem

    @property
    def noise(self) -> float:
        """Standard deviation of a reading, at least that of its rounding."""
        return max(float(np.sqrt(self.sizes[-1])), self.problem.rounding)

    @property
    def rms(self) -> float:
        """Of the left-out errors."""
        return float(np.sqrt(np.nanmean(self.error**2)))

    @property
    def misfit(self) -> float:
        """Rms of what the model leaves of the training readings that it is fitted to."""
        return root_mean_square((self.problem.y - self.output)[self.problem.train])

    def held_out_error(self) -> Array:
        """Errors of the held-out readings."""
        return (self.problem.y - self.output)[~self.problem.train]

    def surface(self) -> Surface:
        """Level and slope at all readings; those of training readings from blocks left out."""
        problem, level = self.problem, self.output.copy()
        level[problem.train] = problem.y[problem.train] - self.error
        slope = self.relays.slope(problem, self.dual)
        own = slope[problem.train]
        size = SLOPE_SIZE * float(problem.y[problem.train].std())
        size /= max(root_mean_square(own), 1e-12)
        return Surface(level - level[problem.train].mean(), slope * size)


@dataclass(frozen=True, eq=False)
class FittedAddition:
    """A candidate with its covariances (m, m): ``common`` of every hypothesis, ``own`` of its parts."""

    candidate: Addition
    prior: PositivePrior
    common: tuple[Array, ...]
    own: tuple[Array, ...]
    fit: GaussianFit
    problem: ReadingProblem

    def kept(self) -> KeptAddition:
        """What is asked of the candidate once others are fitted."""
        n, fit = len(self.common), self.fit
        return KeptAddition(
            candidate=self.candidate,
            relays=self.prior.relays,
            common=n,
            sizes=fit.sizes,
            dual=fit.dual,
            error=fit.error,
            output=LEVEL * float(fit.dual.sum()) + self._explained((*self.common, *self.own), fit.sizes),
            added=self._explained(self.own, fit.sizes[n:]),
            run_error=self._run_error(),
            problem=self.problem,
        )

    def _explained(self, matrices: Sequence[Array], sizes: Array) -> Array:
        """What covariances times ``sizes`` explain of the training readings, at all readings (m,)."""
        train = self.problem.train
        parts = [s * (k[:, train] @ self.fit.dual) for s, k in zip(sizes, matrices)]
        return np.add.reduce(parts) if parts else np.zeros(train.size)

    def _run_error(self) -> float:
        runs = self.problem.record[self.problem.train]
        error, _ = left_out(
            self.fit.precision, self.fit.dual, [np.flatnonzero(runs == r) for r in np.unique(runs)]
        )
        return root_mean_square(error)

    @property
    def score(self) -> float:
        """Log predictive density of all blocks, in nats."""
        return float(self._scores([self._unseen(rows) for rows in self.problem.unseen]).sum())

    def trial(self) -> Trial:
        """The trial of the hypothesis; its state is what is kept of the fit."""
        values = {k: v for e in self.candidate.effects for k, v in e.values.items() if k != "reference"}
        squares = [float(np.sum(self.fit.error[b] ** 2)) for b in self.problem.blocks]
        unseen = [self._unseen(rows) for rows in self.problem.unseen]
        return Trial(values, self._scores(unseen), np.r_[squares, [q for _, q in unseen]], self.kept())

    def _scores(self, unseen: Sequence[tuple[float, float]]) -> Array:
        return np.r_[self.fit.scores, [s for s, _ in unseen]]

    def _unseen(self, rows: Rows) -> tuple[float, float]:
        """(log predictive density, sum of squared errors) of the held-out readings at ``rows`` of m."""
        train, sizes = self.problem.train, self.fit.sizes
        matrices = (*self.common, *self.own, self.problem.within_block)
        cross = LEVEL + np.add.reduce([s * k[rows][:, train] for s, k in zip(sizes, matrices)])
        own = LEVEL + np.add.reduce([s * k[np.ix_(rows, rows)] for s, k in zip(sizes, matrices)])
        values, vectors = eigh(own - cross @ self.fit.precision @ cross.T, check_finite=False)
        variance = np.maximum(values, 0.0) + sizes[-1]  # differences of large numbers may be negative
        error = self.problem.y[rows] - cross @ self.fit.dual
        square = float(np.sum((vectors.T @ error) ** 2 / variance))
        score = log_t_density(square, rows.size, -0.5 * float(np.log(variance).sum()))
        return score, float(error @ error)


@dataclass(frozen=True, eq=False)
class SearchBasis:
    """What candidates of one search share: the problem, a fit without them, and its surface.

    ``target`` (m,) is what the density alone has to explain.
    """

    problem: ReadingProblem
    prior: PositivePrior
    surface: Surface | None
    sizes: Array
    target: Array

    def of(self, fitted: KeptAddition) -> "SearchBasis":
        """With the density and the slopes of a fit: those of the plain model contain the errors that it explains."""
        target, candidate = self.problem.y - fitted.added, fitted.candidate
        inputs = acting_inputs(self.problem, candidate.effects, candidate.laws)
        prior = positive_prior(self.problem, inputs, target, self.prior)
        sizes = np.r_[fitted.sizes[: fitted.common], fitted.sizes[-2:]]
        return SearchBasis(self.problem, prior, fitted.surface(), sizes, target)

    @cached_property
    def slope_noise(self) -> list[Array]:
        """Covariance (m, m) of the noise of the input."""
        return [np.diag(self.surface.slope**2)] if self.surface is not None else []

    def fitted(
        self,
        candidate: Addition,
        iterations: int,
        *,
        same_input: bool = False,
        near: KeptAddition | None = None,
    ) -> FittedAddition:
        """A candidate with sizes found from those of the basis (``iterations`` 0 keeps them).

        ``same_input``: the basis's density is that of the input that the candidate moves. ``near``: a fit of the same
        parts with other values, to start from its sizes.
        """
        problem, prior = self.problem, self.prior
        if candidate.moves_input and not same_input:
            prior = positive_prior(
                problem, acting_inputs(problem, candidate.effects, candidate.laws), self.target
            )
        common = (prior.covariance, *problem.always, *self.slope_noise)
        own: list[Array] = []
        if self.surface is not None:
            for effect in candidate.effects:
                own += added_parts(problem, effect, self.surface.shapes(problem))
            for name in candidate.variables:
                own += variable_parts(problem, name, self.surface)
        at = np.ix_(problem.train, problem.train)
        matrices = [*common, *own, problem.within_block]
        n = len(common)
        sizes = np.r_[self.sizes[:n], [ADDED_SIZE] * len(own), self.sizes[-2:]]
        if near is not None:
            sizes = near.sizes
        fit = fit_gaussian(
            problem.y[problem.train], [k[at] for k in matrices], problem.blocks, sizes, iterations
        )
        return FittedAddition(candidate, prior, common, tuple(own), fit, problem)


def first_basis(problem: ReadingProblem, iterations: int) -> tuple[SearchBasis, FittedAddition]:
    """The basis of the plain model, and the plain model."""
    prior = positive_prior(problem, acting_inputs(problem, ()), problem.y)
    count = 1 + len(problem.always)
    sizes = np.r_[FIRST_SIZE, [SMALL] * (count - 1), BLOCK_SIZE, NOISE_SIZE]
    rough = SearchBasis(problem, prior, None, sizes, problem.y)
    first = rough.fitted(Addition(), iterations)
    surface = first.kept().surface()
    sizes = np.r_[first.fit.sizes[:-2], BLOCK_SIZE / 10, first.fit.sizes[-2:]]
    basis = replace(rough, surface=surface, sizes=sizes)
    base = basis.fitted(Addition(), iterations)
    return replace(basis, sizes=base.fit.sizes), base
