"""The readings that depend on the output, as one Gaussian problem: what a density, zeros and noise can make of them."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix

from smarig.core import Array
from smarig.diagnosis.refit.density_prior import SMOOTHING, DensityPrior, density_prior
from smarig.diagnosis.refit.memory_noise import memory_slopes
from smarig.diagnosis.refit.moved_density import without_effects
from smarig.diagnosis.refit.reading_noise import encoder_error_traces, output_rate, reading_scales
from smarig.diagnosis.refit.variance_components import ReadingCovariance, bounds_of
from smarig.preisach import Everett
from smarig.replay import OUTPUT_DEPENDENT_KINDS, PlantModel, Prediction, Timeline, predict


@dataclass(frozen=True, eq=False)
class CoupledReadings:
    """Residuals ``y`` (n,) of the readings that depend on the output, and the covariances that may explain them.

    ``scale`` (n,) divides each reading. ``slopes`` (n, p) and ``times`` (p,) belong to the remembered inputs
    (``memory_slopes``). ``zero_scale`` (n,) is the scale of positions of the first session, else 0.
    """

    y: Array
    scale: Array
    covariance: ReadingCovariance
    prior: DensityPrior
    slopes: csr_matrix
    times: Array
    zero_scale: Array

    @property
    def free(self) -> Array:
        """Covariance (n, n) of free constants."""
        return self.covariance.free


def coupled_readings(
    timeline: Timeline,
    prediction: Prediction,
    plant_model: PlantModel,
    contribution: Array | None = None,
    prior: Everett | DensityPrior | None = None,
    smoothing: float = SMOOTHING,
) -> CoupledReadings:
    """The coupled readings of a simulated timeline.

    ``contribution`` is ``effect_contribution`` where it is known. ``prior``: the density that the prior is about, if
    not that of the plant model, or the prior itself; ``smoothing`` that of the prior.
    """
    coupled = [r for r in timeline.all_readings if r.kind in OUTPUT_DEPENDENT_KINDS]
    y = np.concatenate([r.value - prediction.values[r.kind] for r in coupled])
    h = plant_model.hysteresis
    if contribution is None:
        contribution = effect_contribution(timeline, prediction, plant_model)
    white, free, scale, slope = reading_scales(
        timeline, prediction, plant_model, coupled, output_rate(prediction, plant_model), contribution
    )
    scaled_error = encoder_error_traces(timeline, plant_model, coupled) / scale[:, None]
    free += scaled_error @ scaled_error.T
    about = prior if isinstance(prior, DensityPrior) else density_prior(prediction, prior or h, smoothing)
    full_output = y + prediction.output_slope * (
        prediction.output - h.y_lower
    )  # for any hysteresis, not only for changes of this one
    is_moving = np.concatenate([np.full(len(r), float(r.kind == "moving")) for r in coupled])
    slopes, times = memory_slopes(h, prediction)
    return CoupledReadings(
        y=y,
        scale=scale,
        covariance=ReadingCovariance(
            y=full_output / scale,
            shapes=about.covariances,
            free=free,
            white=white,
            is_moving=is_moving,
            slope=slope,
            bounds=bounds_of(timeline, plant_model),
        ),
        prior=about,
        slopes=slopes,
        times=times,
        zero_scale=scale * ((white < 1.0) & (prediction.session == 0)),
    )


def effect_contribution(timeline: Timeline, prediction: Prediction, plant_model: PlantModel) -> Array:
    """The change of each coupled reading (n,) by the effects of the plant model that no density would make."""
    if not plant_model.effects:
        return np.zeros(prediction.output.size)
    plain = predict(timeline, without_effects(timeline, plant_model, prediction))
    return np.concatenate(
        [
            prediction.values[r.kind] - plain.values[r.kind]
            for r in timeline.all_readings
            if r.kind in OUTPUT_DEPENDENT_KINDS
        ]
    )
