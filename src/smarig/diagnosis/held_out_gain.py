"""The gain of the extended model on held-out runs, in blocks of one excursion each.

    R = (rms_base² − rms_extended²) / (rms_base² − floor²)        the removable share of the error's square

An extended model below the floor is so by chance, and is its own floor: no share exceeds 1.

Both models have densities identified from the same training runs, so R is the share of the effects alone. The zero
of the encoder is estimated on the training runs too. Each position has the weight 1/σ². σ² is its noise plus the
variance of the density that the training runs leave; floor² is the mean of σ². ``settled_rms`` counts settled points
only, all with one weight, as ``verify`` does: its figures can be compared with those of ``verify``.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, solve_triangular

from smarig.core import Array, root_mean_square
from smarig.diagnosis.refit.density_prior import density_prior
from smarig.diagnosis.refit.memory_noise import memory_covariance, memory_slopes
from smarig.diagnosis.refit.reading_noise import FREE_ZERO_SD
from smarig.diagnosis.refit.refit import NoiseEstimate
from smarig.record import Run
from smarig.replay import PlantModel, Prediction, Timeline, build_timeline, predict

DRAWS = 2000
LEAST_BLOCKS = 5  # the interval from fewer holds R less than eight times of ten


@dataclass(frozen=True, eq=False)
class HeldOutGain:
    """Errors (k,) of both models at held-out positions, their blocks (k,), and the floor of any model's error.

    ``weight`` (k,), or None for equal weights, is 1/σ² of each reading. It keeps readings that the training runs
    cannot predict from dominating the others. ``original_error`` (k,) is the error of the given model. ``settled`` (k,)
    marks the settled points; None if all are.
    """

    base_error: Array
    extended_error: Array
    block: NDArray[np.int64]
    floor: float
    weight: Array | None = None
    original_error: Array | None = None
    settled: NDArray[np.bool_] | None = None

    def to_json(self) -> dict[str, Any]:
        """The object ``held_out`` of the command line."""
        return {
            "given": self.original,
            "base": self.base,
            "extended": self.extended,
            "noise_floor": self.floor,
            "removable_share": self.removable_share,
            "ci95": self.interval(),
            "blocks": self.blocks,
        }

    def without_extension(self) -> "HeldOutGain":
        """The same if no extended model is offered: the errors are those of the base model."""
        return replace(self, extended_error=self.base_error)

    @property
    def original(self) -> float | None:
        """Rms error of the given model, or None if it was not computed."""
        return None if self.original_error is None else root_mean_square(self.original_error, self.weight)

    @property
    def base(self) -> float:
        """Rms error of the base model."""
        return root_mean_square(self.base_error, self.weight)

    @property
    def extended(self) -> float:
        """Rms error of the extended model."""
        return root_mean_square(self.extended_error, self.weight)

    def settled_rms(self, error: Array) -> float:
        """Rms of errors (k,) of a model at the settled points, all with one weight: the measure of ``verify``."""
        return root_mean_square(error if self.settled is None else error[self.settled], None)

    @property
    def blocks(self) -> int:
        """Number of blocks."""
        return np.unique(self.block).size

    @property
    def removable_share(self) -> float | None:
        """R, or None if the base model is at the floor already."""
        return _share(self.base, self.extended, self.floor)

    @property
    def by_chance(self) -> bool:
        """Whether nothing may be gained: the interval of R reaches 0. Of few blocks, nobody knows."""
        interval = self.interval()
        return interval is not None and interval[0] <= 0.0

    def interval(self, seed: int = 0) -> tuple[float, float] | None:
        """95 % interval of R by resampling the blocks with replacement; None of few blocks, which say little of it,
        and without an extended model.
        """
        if self.blocks < LEAST_BLOCKS or np.array_equal(self.base_error, self.extended_error):
            return None
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
        is_known = [s for s in shares if s is not None]
        if len(is_known) < DRAWS / 2:
            return None
        low, high = np.quantile(is_known, [0.025, 0.975])
        return float(low), float(high)


def held_out_gain(
    train: Sequence[Run],
    held_out: Sequence[Run],
    base: PlantModel,
    extended: PlantModel,
    noise: NoiseEstimate,
    variances: Array | None = None,
    original: PlantModel | None = None,
) -> HeldOutGain:
    """The errors of both plant models at the settled and moving positions of the held-out runs.

    Both models are simulated along all runs. ``variances`` (parts,) belong to the density about that of the
    extended model; None if none is left. ``original`` is the given model, for comparison.
    """
    timeline = build_timeline([*train, *held_out], base.actuator.tau_s).positions_only
    if not noise.moving:  # the uncertainty of moving positions is unknown
        sessions = tuple(replace(session, other_readings=()) for session in timeline.sessions)
        timeline = replace(timeline, other_readings=(), sessions=sessions)
    held_out_ids = {id(run) for run in held_out}
    step = np.concatenate([r.step for r in timeline.all_readings])
    is_held_out = np.isin(
        timeline.run, [k for k, run in enumerate(timeline.runs) if id(run) in held_out_ids]
    )[step]
    value, session = np.concatenate([r.value for r in timeline.all_readings]), timeline.session[step]
    weighted = len(timeline.all_readings) > 1 or variances is not None
    extended_prediction = predict(timeline, extended)
    covariance = _noise(timeline, extended_prediction, extended, noise)
    square = np.diag(covariance).copy()
    if variances is not None:
        square[is_held_out] = _predictive_variance(
            extended_prediction, extended, covariance, variances, is_held_out
        )
    weight = 1 / square if weighted else np.ones(square.size)
    errors = []
    for prediction in (
        predict(timeline, base),
        extended_prediction,
        *([predict(timeline, original)] if original else []),
    ):
        error = value - prediction.stacked(timeline)
        errors.append((error - _zeros(error, weight, is_held_out, session))[is_held_out])
    square, weight = square[is_held_out], weight[is_held_out]
    floor = float(np.sqrt(np.average(square, weights=weight)))
    weight = weight if weighted else None
    kinds = np.repeat(
        [r.kind == "settled" for r in timeline.all_readings], [len(r) for r in timeline.all_readings]
    )
    return HeldOutGain(
        errors[0],
        errors[1],
        timeline.block[step][is_held_out],
        floor,
        weight,
        errors[2] if original else None,
        kinds[is_held_out],
    )


def _zeros(error: Array, weight: Array, is_held_out: NDArray[np.bool_], session: NDArray[np.int64]) -> Array:
    """The encoder's zero (k,) from the training runs of the same session, or from the held-out run if there are
    none.
    """
    zeros = np.empty(error.size)
    for k in np.unique(session):
        own_sd = session == k
        zero_readings = own_sd & ~is_held_out if np.any(own_sd & ~is_held_out) else own_sd
        zeros[own_sd] = np.average(error[zero_readings], weights=weight[zero_readings])
    return zeros


def _noise(
    timeline: Timeline, extended_prediction: Prediction, plant_model: PlantModel, noise: NoiseEstimate
) -> Array:
    """Covariance (k, k) of the noise at positions: their own noise and the remembered noise."""
    J, times = memory_slopes(plant_model.hysteresis, extended_prediction)
    own_sd = [
        np.full(len(r), noise.settled if r.kind == "settled" else noise.moving) for r in timeline.all_readings
    ]
    square = np.concatenate(own_sd) ** 2
    return noise.temperature_K**2 * memory_covariance(J, times, noise.correlation_s) + np.diag(square)


def _predictive_variance(
    extended_prediction: Prediction,
    plant_model: PlantModel,
    noise: Array,
    variances: Array,
    is_held_out: NDArray[np.bool_],
) -> Array:
    """Variance (k,) of held-out positions given all others, due to the uncertain density."""
    shapes = density_prior(extended_prediction, plant_model.hysteresis).covariances
    C = noise + plant_model.stroke**2 * np.sum([w * shape for w, shape in zip(variances, shapes)], axis=0)
    is_known = ~is_held_out
    zero = (FREE_ZERO_SD * plant_model.stroke) ** 2  # common to all positions
    factor = cholesky(C[np.ix_(is_known, is_known)] + zero, lower=True, check_finite=False)
    shared = C[np.ix_(is_known, is_held_out)] + zero
    explained = np.sum(solve_triangular(factor, shared, lower=True, check_finite=False) ** 2, axis=0)
    return np.maximum(np.diag(C)[is_held_out] + zero - explained, np.diag(noise)[is_held_out])


def _share(base: float, extended: float, floor: float) -> float | None:
    if base <= floor:
        return None
    return (base**2 - extended**2) / (base**2 - min(floor, extended) ** 2)
