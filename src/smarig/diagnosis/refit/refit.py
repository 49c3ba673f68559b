"""The refit of density and noise: what data leave unexplained by any density of the hysteresis.

    y = Γ[u] + e,    Γ of any smooth density (``density_prior``),    e ~ N(0, Σ)     ⇒     y ~ N(0, C)

The smoothness of the density and the size of the noise maximise the likelihood. The trace t of an effect then
explains ½ (tᵀC⁻¹y)²/(tᵀC⁻¹t) nats more than a new density alone.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_solve, cholesky, solve_triangular

from smarig.core import Array
from smarig.diagnosis.drive_statistics import DriveStatistics
from smarig.diagnosis.refit.coupled_readings import coupled_readings
from smarig.diagnosis.refit.density_posterior import DensityPosterior
from smarig.diagnosis.refit.density_prior import SMOOTHING, DensityPrior
from smarig.diagnosis.refit.memory_noise import memory_covariance
from smarig.diagnosis.refit.reading_noise import independent_block, session_means
from smarig.diagnosis.refit.variance_components import (
    LOG_FLUCTUATION_START,
    START,
    ReadingCovariance,
)
from smarig.preisach import Everett
from smarig.replay import OUTPUT_DEPENDENT_KINDS, PlantModel, Prediction, Timeline


@dataclass(frozen=True, eq=False)
class NoiseEstimate:
    """Standard deviations: ``white`` (n,) of each coupled reading by itself, of temperature (K), and of settled
    positions.

    ``moving`` is the typical one of moving positions, 0 if none was read.
    """

    white: Array
    temperature_K: float
    correlation_s: float
    settled: float
    moving: float = 0.0


@dataclass(frozen=True, eq=False)
class Refit:
    """The stacked, whitened readings of a timeline: ``factor`` (N, N) is the Cholesky factor of C.

    ``scale`` (N,) divides each reading. ``data`` (N,) are the readings so divided, and whitened. The first ``coupled``
    of them depend on the output. ``log_components`` are log₁₀ of the variances of the density's parts, s_m, s₀ and s_T.
    ``posterior`` is the posterior of the density.
    """

    factor: Array
    scale: Array
    data: Array
    noise: NoiseEstimate
    log_evidence: float
    coupled: int
    log_components: Array
    posterior: DensityPosterior

    def centred(self, rest: Array, timeline: Timeline) -> Array:
        """Whitened (N,) residuals, without the free constants of independent blocks, as in ``data``."""
        at = 0
        rest = rest.copy()
        for r in timeline.all_readings:
            if r.kind not in OUTPUT_DEPENDENT_KINDS and r.kind != "current":
                rest[at : at + len(r)] -= session_means(rest[at : at + len(r)], r, timeline)
            at += len(r)
        return self.whitened(rest)

    def whitened(self, traces: Array) -> Array:
        """L⁻¹ of traces in the readings' units, (N,) or (N, m)."""
        scaled = traces / (self.scale if traces.ndim == 1 else self.scale[:, None])
        return solve_triangular(self.factor, scaled, lower=True, check_finite=False)


def refit(
    timeline: Timeline,
    prediction: Prediction,
    plant_model: PlantModel,
    warm_start: "Refit | None" = None,
    contribution: Array | None = None,
    prior: Everett | DensityPrior | None = None,
    smoothing: float = SMOOTHING,
    *,
    from_both_sides: bool = True,
) -> Refit:
    """The maximum-likelihood smoothness and noise for a simulated timeline, and its readings whitened by them.

    ``warm_start``: start at the result of another refit. ``contribution``: ``effect_contribution``, if it is known.
    ``prior``, ``smoothing``: as in ``coupled_readings``. ``from_both_sides``: of what imitates what (``likeliest``).
    """
    readings = coupled_readings(timeline, prediction, plant_model, contribution, prior, smoothing)
    y, scale, reading_covariance = readings.y, readings.scale, readings.covariance
    free, output_slope, is_moving = readings.free, reading_covariance.slope, reading_covariance.is_moving
    span, n = abs(plant_model.stroke), y.size
    memories = [
        (seconds, memory_covariance(readings.slopes, readings.times, seconds) / span**2)
        for seconds in _correlations_s(timeline, warm_start)
    ]
    start = START if warm_start is None else warm_start.log_components
    cost, found, correlation, memory = _over_correlation_times(
        reading_covariance, memories, start, from_both_sides=from_both_sides
    )
    *variances, _, s0, s_T = 10.0**found
    noise_part, density = (
        reading_covariance.noise_covariance(memory, found),
        reading_covariance.density(found),
    )
    C = output_slope[:, None] * density * output_slope + free + noise_part
    others = [
        independent_block(r, timeline, prediction)
        for r in timeline.all_readings
        if r.kind not in OUTPUT_DEPENDENT_KINDS
    ]
    factor, scales, data = _stacked([(C, scale, y), *others])
    whitened = solve_triangular(factor, data / scales, lower=True, check_finite=False)
    independent_cost = float(
        0.5 * whitened[n:] @ whitened[n:] + np.log(np.diag(factor)[n:] * scales[n:]).sum()
    )
    about = readings.prior
    deviation = reading_covariance.y - output_slope * about.outputs(about.mass)
    dual_weights = cho_solve((factor[:n, :n], True), deviation, check_finite=False)
    sd = np.sqrt(np.diag(noise_part) - s_T**2 * output_slope**2 * np.diag(memory)) * scale
    moving_sd = float(np.median(sd[is_moving > 0])) if is_moving.any() else 0.0
    return Refit(
        factor=factor,
        scale=scales,
        data=whitened,
        noise=NoiseEstimate(sd, s_T, correlation, span * s0, moving_sd),
        log_evidence=-cost - float(np.log(scale).sum()) - independent_cost,  # of readings in their own units
        coupled=n,
        log_components=found,
        posterior=DensityPosterior(
            prior=about.bare,
            variances=np.array(variances),
            output_slope=output_slope,
            factor=factor[:n, :n],
            free=free,
            dual_weights=dual_weights,
            outputs=density @ (output_slope * dual_weights),
            zero_scale=readings.zero_scale,
            stroke=span,
            y_lower=plant_model.hysteresis.y_lower,
            unit=timeline.unit,
        ),
    )


def _correlations_s(timeline: Timeline, warm_start: "Refit | None") -> tuple[float, ...]:
    """Correlation times to try for remembered noise."""
    if warm_start is not None:
        return (warm_start.noise.correlation_s,)
    return DriveStatistics(timeline).correlations_s()


def _over_correlation_times(
    reading_covariance: ReadingCovariance,
    memories: Sequence[tuple[float, Array]],
    start_components: Array,
    *,
    from_both_sides: bool,
) -> tuple[float, Array, float, Array]:
    """(cost, variances, correlation time, remembered noise per K²) of the likeliest correlation time."""
    best: tuple[float, Array, float, Array] | None = None
    for seconds, memory in memories:
        start = start_components if best is None else np.append(best[1][:-1], LOG_FLUCTUATION_START)
        cost, found = reading_covariance.likeliest(memory, start, from_both_sides=from_both_sides)
        if best is None or cost < best[0]:
            best = (cost, found, seconds, memory)
    assert best is not None  # noqa: S101 - at least one correlation time is tried
    return best


def _stacked(blocks: list[tuple[Array, Array, Array]]) -> tuple[Array, Array, Array]:
    size = sum(y.size for _, _, y in blocks)
    factor, at = np.zeros((size, size)), 0
    for C, _, y in blocks:
        factor[at : at + y.size, at : at + y.size] = cholesky(C, lower=True, check_finite=False)
        at += y.size
    return factor, np.concatenate([s for _, s, _ in blocks]), np.concatenate([y for _, _, y in blocks])
