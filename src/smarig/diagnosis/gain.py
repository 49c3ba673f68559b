"""What the extended model gains, on blocks that nothing has touched: runs held out, excursion by excursion.

    R = (rms_base² − rms_extended²) / (rms_base² − floor²)        the removable share of the error's square

Both models have densities identified anew from the same training runs, so R is the effects' share alone; the
encoder's zero is met on the training runs too. A position counts by how well the training runs foretell it, 1/σ²:
σ² is its noise and what they leave open of the density, the floor² its mean. Knows no search.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, solve_triangular

from smarig.diagnosis import given
from smarig.diagnosis.free_density import free_density
from smarig.diagnosis.instruments import ANY
from smarig.diagnosis.noise import propagated, remembered
from smarig.diagnosis.refit import Noise
from smarig.record import Run
from smarig.story.retelling import Retelling, retold
from smarig.story.subject import Subject
from smarig.story.told import Story, told

Array = NDArray[np.float64]
DRAWS = 2000


@dataclass(frozen=True, eq=False)
class Gain:
    """Errors (k,) of both models at held-out positions, blocks (k,) they come in, and the floor of any model's.

    ``weight`` (k,), None for equal ones: a reading counts by how well it can be foretold (1/σ²), lest what the
    training runs tell nothing of drown the rest. ``given_error`` (k,) is that of the model as it was given.
    """

    base_error: Array
    extended_error: Array
    block: NDArray[np.int64]
    floor: float
    weight: Array | None = None
    given_error: Array | None = None

    @property
    def given(self) -> float | None:
        """Rms of the model as it was given, where that was asked."""
        return None if self.given_error is None else _rms(self.given_error, self.weight)

    @property
    def base(self) -> float:
        """Rms of the base."""
        return _rms(self.base_error, self.weight)

    @property
    def extended(self) -> float:
        """Rms of the extended model."""
        return _rms(self.extended_error, self.weight)

    @property
    def blocks(self) -> int:
        """Number of blocks."""
        return int(np.unique(self.block).size)

    @property
    def removable_share(self) -> float | None:
        """R; None where the base is at the noise floor already."""
        return _share(self.base, self.extended, self.floor)

    def interval(self, seed: int = 0) -> tuple[float, float] | None:
        """95 % of R when the blocks are drawn again with replacement."""
        names, rng = np.unique(self.block), np.random.default_rng([seed, 0xB10C])
        weight = np.ones(self.block.size) if self.weight is None else self.weight
        squares = np.array(
            [
                [np.sum((weight * e**2)[self.block == b]) for b in names]
                for e in (self.base_error, self.extended_error)
            ]
        )
        sizes = np.array([np.sum(weight[self.block == b]) for b in names])
        drawn = rng.integers(0, names.size, (DRAWS, names.size))
        base, extended = np.sqrt(squares[:, drawn].sum(axis=2) / sizes[drawn].sum(axis=1))
        shares = [_share(b, e, self.floor) for b, e in zip(base.tolist(), extended.tolist())]
        known = [s for s in shares if s is not None]
        if len(known) < DRAWS / 2:
            return None
        low, high = np.quantile(known, [0.025, 0.975])
        return float(low), float(high)


def measured_gain(
    train: Sequence[Run],
    held_out: Sequence[Run],
    base: Subject,
    extended: Subject,
    noise: Noise,
    variances: Array | None = None,
    given: Subject | None = None,
) -> Gain:
    """Both subjects live through all runs; positions of the held-out ones are judged, settled and on their way.

    ``variances`` (parts,) of the density about the extended subject's; None where none of it is left open; ``given``
    is the model as it was given, for comparison.
    """
    story = told([*train, *held_out], base.actuator.tau_s).placed
    if not noise.moving:  # how well a position on its way is known, nobody knows
        story = replace(story, others=())
    kept = {id(run) for run in held_out}
    step = np.concatenate([r.step for r in story.kinds])
    judged = np.isin(story.run, [k for k, run in enumerate(story.runs) if id(run) in kept])[step]
    value, sitting = np.concatenate([r.value for r in story.kinds]), story.sitting[step]
    weighted = bool(story.given) or len(story.kinds) > 1 or variances is not None
    whole = retold(story, extended)
    covariance = _noise(story, whole, extended, noise)
    square = np.diag(covariance).copy()
    if variances is not None and not story.given:
        square[judged] = _foretold(whole, extended, covariance, variances, judged)
    weight = 1 / square if weighted else np.ones(square.size)
    errors = []
    for told_so in (retold(story, base), whole, *([retold(story, given)] if given else [])):
        error = value - told_so.stacked(story)
        errors.append((error - _zeros(error, weight, judged, sitting))[judged])
    square, weight = square[judged], weight[judged]
    floor = float(np.sqrt(np.average(square, weights=weight)))
    weight = weight if weighted else None
    return Gain(errors[0], errors[1], story.block[step][judged], floor, weight, *errors[2:])


def _zeros(error: Array, weight: Array, judged: NDArray[np.bool_], sitting: NDArray[np.int64]) -> Array:
    """The encoder's zero (k,) as the training runs of each sitting have it, or its own where it has none."""
    zeros = np.empty(error.size)
    for k in np.unique(sitting):
        own = sitting == k
        met = own & ~judged if np.any(own & ~judged) else own
        zeros[own] = np.average(error[met], weights=weight[met])
    return zeros


def _noise(story: Story, whole: Retelling, subject: Subject, noise: Noise) -> Array:
    """Covariance (k, k) of the noise at positions: its own, and what the hysteresis remembers."""
    J, times = remembered(subject.hysteresis, whole)
    own = [np.full(len(r), noise.settled if r.kind == "settled" else noise.moving) for r in story.kinds]
    square = np.concatenate(own) ** 2
    if story.given:
        square = square + given.scatter(story, whole, subject) ** 2
    return noise.temperature_K**2 * propagated(J, times, noise.correlation_s) + np.diag(square)


def _foretold(
    whole: Retelling, subject: Subject, noise: Array, variances: Array, judged: NDArray[np.bool_]
) -> Array:
    """Variance (k,) of judged positions when all others are known, but for whatever the density may be."""
    path = whole.lived(subject.hysteresis, subject.initial, whole.felt_K)
    shapes = free_density(whole, subject.hysteresis, path, whole.output).covariances
    C = noise + subject.stroke**2 * np.sum([w * shape for w, shape in zip(variances, shapes)], axis=0)
    known = ~judged
    zero = (ANY * subject.stroke) ** 2  # is the same in all
    factor = cholesky(C[np.ix_(known, known)] + zero, lower=True, check_finite=False)
    shared = C[np.ix_(known, judged)] + zero
    told = np.sum(solve_triangular(factor, shared, lower=True, check_finite=False) ** 2, axis=0)
    return np.maximum(np.diag(C)[judged] + zero - told, np.diag(noise)[judged])


def _rms(error: Array, weight: Array | None) -> float:
    return float(np.sqrt(np.average(error**2, weights=weight)))


def _share(base: float, extended: float, floor: float) -> float | None:
    removable = base**2 - floor**2
    return (base**2 - extended**2) / removable if removable > 0 else None
