"""The critique of a model: does anything exceed the noise, and which candidates gain more than noise would?

The gain of every candidate is scaled by the spread of its gains on null data, (g − q50)/(q95 − q50). The largest is
compared with the largest of each null data set (maximum statistic of Westfall and Young). So the probability of any
false alarm is α for any number of candidates, as far as null data resemble real residuals. They lack the misfit of a
density, so what exceeds them is searched for effects, but is an alarm only by the calibrated p (``calibration``).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

from smarig.core import counted
from smarig.diagnosis.critique.calibration import calibrated_p, calibrated_threshold
from smarig.diagnosis.critique.candidates import Candidate, generic, named, whitened
from smarig.diagnosis.refit.refit import Refit, refit
from smarig.plant import EffectType
from smarig.preisach import sensitivities
from smarig.replay import PlantModel, Prediction, Timeline, predict

Array = NDArray[np.float64]
NULL_DATA_SETS = 400
ALPHA = 0.03
MIN_SPREAD_NATS = 1.5  # nats: about the gain of one free strength by chance


@dataclass(frozen=True, eq=False)
class CandidateScore:
    """A candidate's gain (nats), the median and 95 % point of its gains on null data, and the scaled gain."""

    candidate: Candidate
    gain: float
    median: float
    high: float

    @property
    def net(self) -> float:
        """Gain beyond the median on null data."""
        return self.gain - self.median

    @property
    def standard(self) -> float:
        """Gain in units of its spread on null data."""
        return self.net / max(self.high - self.median, MIN_SPREAD_NATS)


@dataclass(frozen=True, eq=False)
class Critique:
    """The critique of a plant model with its present effects: scores, and thresholds of the largest score.

    ``threshold`` and ``p_value`` compare it with null data, ``alarm_threshold`` and ``calibrated_p`` with wires without
    an effect. ``named_traces`` are the named candidates with raw traces.
    """

    timeline: Timeline
    plant_model: PlantModel
    prediction: Prediction
    refitted: Refit
    scores: tuple[CandidateScore, ...]
    named_traces: tuple[Candidate, ...]
    threshold: float
    p_value: float
    calibrated_p: float
    alarm_threshold: float

    @property
    def silent(self) -> bool:
        """Whether nothing exceeds null data, so that no effect is searched for."""
        return self.largest.standard <= self.threshold

    @property
    def alarm(self) -> bool:
        """Whether so much stands out that hardly any wire without an effect shows it."""
        return self.largest.standard > self.alarm_threshold

    @property
    def largest(self) -> CandidateScore:
        """The largest score."""
        return max(self.scores, key=lambda s: s.standard)

    def best(self, count: int, *, generic: bool = False) -> list[CandidateScore]:
        """The named or generic candidates that gain most, each followed by the one that stands out most."""
        kind = [s for s in self.scores if s.candidate.generic is generic and s.net > 0]
        by_gain = sorted(kind, key=lambda s: -s.net)
        by_standard = sorted(kind, key=lambda s: -s.standard)
        found = {id(s): s for pair in zip(by_gain, by_standard) for s in pair}
        return list(found.values())[:count]


def critique(
    timeline: Timeline,
    plant_model: PlantModel,
    effect_types: Sequence[EffectType],
    *,
    count: int = NULL_DATA_SETS,
    alpha: float = ALPHA,
    seed: int = 0,
    warm_start: Critique | None = None,
    all_nuisances: bool = False,
    noise_of: Critique | None = None,
) -> Critique:
    """Compare a plant model with a timeline and with ``count`` null data sets at the level α.

    ``warm_start``: refine the noise of another critique of the same wire, without the present effects, and use its
    traces, which hardly depend on them. ``noise_of``: use the noise of another critique. ``all_nuisances``: use the
    least noise, by allowing all nuisance terms at once.
    """
    present = {effect.kind.name for effect in plant_model.catalogue_effects}
    absent = tuple(kind for kind in effect_types if kind.name not in present)
    prediction = predict(timeline, plant_model)
    named_traces = (
        _named_traces(timeline, plant_model, absent)
        if warm_start is None
        else tuple(c for c in warm_start.named_traces if c.kind in absent)
    )
    slope = (
        np.array([s[-1] for s in sensitivities(plant_model.hysteresis, prediction.states)])
        * prediction.output_slope
    )
    raw_candidates = [*named_traces, *generic(timeline, plant_model, prediction, slope)]
    nuisance_terms = [traces for c in raw_candidates for traces in c.typical]
    refitted = refit(
        timeline,
        prediction,
        plant_model,
        nuisance_terms,
        warm_start and warm_start.refitted,
        all_nuisances=all_nuisances,
        noise_of=noise_of and noise_of.refitted,
    )
    null_readings = null_data(prediction, plant_model, refitted, count, seed)
    scores, standard = [], []
    for candidate in (whitened(c, refitted) for c in raw_candidates):
        by_chance = candidate.gain(null_readings)
        median, high = np.quantile(by_chance, [0.5, 0.95])
        score = CandidateScore(candidate, float(candidate.gain(refitted.data)[0]), float(median), float(high))
        scores.append(score)
        standard.append((by_chance - median) / max(high - median, MIN_SPREAD_NATS))
    largest = np.sort(np.max(standard, axis=0))
    observed_largest = max(s.standard for s in scores)
    threshold = float(largest[min(int(np.ceil((count + 1) * (1 - alpha))), count) - 1])
    p = (1 + int(np.sum(largest >= observed_largest))) / (count + 1)
    return Critique(
        timeline=timeline,
        plant_model=plant_model,
        prediction=prediction,
        refitted=refitted,
        scores=tuple(scores),
        named_traces=named_traces,
        threshold=threshold,
        p_value=p,
        calibrated_p=calibrated_p(observed_largest, largest),
        alarm_threshold=calibrated_threshold(alpha, largest),
    )


@lru_cache(maxsize=2)  # the second pass of a diagnosis criticises the same plant model with other noise
def _named_traces(
    timeline: Timeline, plant_model: PlantModel, effect_types: tuple[EffectType, ...]
) -> tuple[Candidate, ...]:
    """The candidates of effects, with raw traces."""
    return tuple(named(timeline, plant_model, predict(timeline, plant_model), effect_types))


def null_data(
    prediction: Prediction, plant_model: PlantModel, refitted: Refit, count: int, seed: int
) -> Array:
    """Whitened stacked readings (N, count) of null data."""
    rng = np.random.default_rng([seed, 0x5EED])
    noise = refitted.noise
    hysteresis_input_K, t, at = prediction.hysteresis_input_K, prediction.t_s, prediction.tick_index
    h, initial = plant_model.hysteresis, plant_model.initial
    temperature_noises = _ornstein_uhlenbeck(t, noise.correlation_s, count, rng)
    size, n = refitted.scale.size, at.size
    y = np.empty((size, count))
    undisturbed = prediction.outputs_along(h, initial, hysteresis_input_K)[at]
    for k in counted(range(count), count):
        deviation = (
            prediction.outputs_along(
                h, initial, hysteresis_input_K + noise.temperature_K * temperature_noises[k], count
            )[at]
            - undisturbed
        )
        y[:n, k] = (
            refitted.fitted + prediction.output_slope * deviation + rng.standard_normal(n) * noise.white
        )
        if noise.encoder.size:
            y[:n, k] += noise.encoder @ rng.standard_normal(noise.encoder.shape[1])
        y[n:, k] = rng.standard_normal(size - n) * refitted.scale[n:]
    scaled = y / refitted.scale[:, None]
    return solve_triangular(refitted.factor, scaled, lower=True, check_finite=False)


def _ornstein_uhlenbeck(t_s: Array, correlation_s: float, count: int, rng: np.random.Generator) -> Array:
    """Ornstein–Uhlenbeck noise of unit variance at times (m,), (count, m)."""
    decay = np.exp(-np.diff(t_s, prepend=t_s[:1]) / correlation_s)
    innovations = rng.standard_normal((t_s.size, count)) * np.sqrt(1 - decay**2)[:, None]
    value = rng.standard_normal(count)
    for k, d in enumerate(decay.tolist()):
        value = innovations[k] = value * d + innovations[k]
    return innovations.T.copy()
