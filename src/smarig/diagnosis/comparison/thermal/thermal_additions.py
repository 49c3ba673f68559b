"""A hypothesis about a thermal record as a Gaussian problem, with its blocks left out.

    reading = T(θ) + J δ + r + e + σ n + q,    e: errors within a block,    q: of the quantised reading

T(θ) has the effects of the hypothesis, J are the slopes of its plain parameters; δ may be as large as the range of the
temperature, or as gain and time constant themselves. r is a smooth dependence on a variable
z: of the thermometer, or of the heat through the wire's response S,

    k(z, z'),    S diag(w) k(z, z') diag(w) Sᵀ,    w: 1, drive, excess temperature, heating rate

which are a heat input, a gain, a loss and a heat capacity that depend on z.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from smarig.core import Array, root_mean_square
from smarig.diagnosis.comparison.compared_hypothesis import Part, Trial
from smarig.diagnosis.comparison.gaussian_fit import GaussianFit, fit_gaussian
from smarig.diagnosis.comparison.measured.reading_problem import rough_kernel, smooth_kernel
from smarig.diagnosis.comparison.thermal.balance_fit import PLAIN, FittedBalance, fit_balance
from smarig.diagnosis.comparison.thermal.heat_balance import wire_response
from smarig.diagnosis.comparison.thermal.thermal_problem import ThermalProblem

VARIABLES = ("time", "temperature", "power", "heating_rate")
LENGTH = 0.35  # of a variable's range
FIRST_SIZES = (1e-4, 1e-4, 1e-4)  # of errors within a block, short and long, and of the noise
ADDED_SIZE = 1e-4
LEAST_START = 1e-5  # a size that begins near zero stays there


@dataclass(frozen=True, eq=False)
class ThermalAddition:
    """What a hypothesis adds to the plain balance: parameters by name of the effect, and variables."""

    effects: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    variables: tuple[str, ...] = ()

    @property
    def parts(self) -> tuple[Part, ...]:
        """Its parts, effects first."""
        effects = [Part("effect", name) for name in self.effects]
        return (*effects, *(Part("variable", name) for name in self.variables))

    @property
    def values(self) -> dict[str, float]:
        """All parameters by name."""
        return {name: value for effect in self.effects.values() for name, value in effect.items()}


@dataclass(frozen=True, eq=False)
class FittedThermalAddition:
    """An addition with its balance, and its fit in units of the range of the temperature.

    ``trace`` (n,) is the predicted temperature, without errors of the thermometer and of the balance.
    """

    candidate: ThermalAddition
    balance: FittedBalance
    fit: GaussianFit
    problem: ThermalProblem
    trace: Array

    def trial(self) -> Trial:
        """The trial of the hypothesis; its state is this fit."""
        squares = [float(np.sum(self.fit.error[b] ** 2)) for b in self.problem.blocks]
        return Trial(self.candidate.values, self.fit.scores, np.array(squares), self)

    @property
    def noise(self) -> float:
        """What a reading scatters, short errors of the thermometer included."""
        return float(np.sqrt(self.fit.sizes[-1] + self.fit.sizes[-3] + self.problem.rounding))

    @cached_property
    def deviations(self) -> dict[str, float]:
        """Standard deviations of the plain parameters, with errors that are alike within a block."""
        *_, short, long, noise = self.fit.sizes.tolist()
        covariance = short * self.problem.within[0] + long * self.problem.within[1]
        covariance[np.diag_indices_from(covariance)] += noise + self.problem.rounding
        slopes = self.balance.slopes / self.problem.record.span
        variances = np.diag(np.linalg.pinv(slopes.T @ np.linalg.solve(covariance, slopes)))
        return dict(zip(PLAIN, np.sqrt(np.maximum(variances, 0.0)).tolist()))

    @cached_property
    def left_out_variance(self) -> Array:
        """Variance (n,) of each reading predicted without its block: large where no other block determines it."""
        found = np.empty(self.problem.block.size)
        for rows in self.problem.blocks:
            found[rows] = np.diag(np.linalg.inv(self.fit.precision[np.ix_(rows, rows)]))
        return found

    @property
    def block_error(self) -> float:
        """What the balance misses from block to block."""
        return float(np.sqrt(self.fit.sizes[-2]))


@dataclass(frozen=True, eq=False)
class ThermalBasis:
    """What candidates of one search share: the problem, the balance that variables act on, and sizes to start from."""

    problem: ThermalProblem
    balance: FittedBalance
    sizes: Array

    def of(self, fitted: FittedThermalAddition) -> "ThermalBasis":
        """The basis of candidates that extend a fit."""
        return ThermalBasis(self.problem, fitted.balance, fitted.fit.sizes[-3:])

    @cached_property
    def weighted_responses(self) -> list[Array]:
        """The wire's response (n, n) to a heat input, a gain, a loss and a heat capacity, each of unit mean square."""
        x, trace = self.problem.record, self.problem.record.temperature - self.balance.error
        response = wire_response(x, self.balance.balance.tau)
        excess = trace - x.bin_room - self.balance.balance.offset
        weights = (np.ones(trace.size), x.bin_drive, excess, np.gradient(trace, x.dt))
        return [_unit(response * w) for w in weights]

    def variable_parts(self, name: str) -> list[Array]:
        """Covariances (n, n) of a dependence on a variable."""
        z = self.problem.variables[name]
        k = rough_kernel(z, LENGTH) if name == "time" else smooth_kernel(z, LENGTH)
        return [k, *(r @ k @ r.T for r in self.weighted_responses)]

    def fitted(
        self, candidate: ThermalAddition, iterations: int, near: FittedThermalAddition | None = None
    ) -> FittedThermalAddition:
        """A candidate with sizes from those of the basis, or ``near`` a fit of the same parts (``iterations`` 0 keeps
        them).
        """
        x = self.problem.record
        start = near.balance if near is not None else self.balance
        balance = start if candidate.values == {} else fit_balance(x, candidate.values, start.balance)
        own = [k for name in candidate.variables for k in self.variable_parts(name)]
        sizes = near.fit.sizes if near is not None else np.r_[[ADDED_SIZE] * len(own), self.sizes]
        plain = balance.balance
        slopes = balance.slopes * [1.0, 1.0, plain.gain / x.span, plain.tau / x.span]
        plain_part = slopes @ slopes.T
        fit = fit_gaussian(
            balance.error / x.span,
            [*own, *self.problem.within],
            self.problem.blocks,
            np.maximum(sizes, LEAST_START) if iterations else sizes,
            iterations,
            plain_part + self.problem.rounding * np.eye(x.t.size),
        )
        moved = plain_part @ fit.dual + np.add.reduce([s * (k @ fit.dual) for s, k in zip(fit.sizes, own)])
        trace = (x.temperature - balance.error) / x.span + moved
        return FittedThermalAddition(candidate, balance, fit, self.problem, trace)


def _unit(response: Array) -> Array:
    size = root_mean_square(response.sum(axis=1))
    return response / (size or 1.0)


def testable_variables(problem: ThermalProblem) -> list[str]:
    """The variables that change."""
    return [n for n in VARIABLES if np.ptp(problem.variables[n]) > 0]


def first_basis(problem: ThermalProblem, iterations: int) -> tuple[ThermalBasis, FittedThermalAddition]:
    """The basis of the plain balance, and its fit."""
    rough = ThermalBasis(problem, problem.base, np.array(FIRST_SIZES))
    base = rough.fitted(ThermalAddition(), iterations)
    return rough.of(base), base
