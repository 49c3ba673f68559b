"""The joint density: the density identified together with effects.

    ν ← max(ν + E[δν | all positions], 0),     δν of the prior of ``density_prior`` about ν, likeliest sds

is repeated until the likelihood rises no more, because a prior in proportion to the density is only as good as that
density. The iteration starts from a positive measure fitted to settled positions.
"""

from dataclasses import replace

import numpy as np

from smarig.diagnosis.refit.moved_density import with_moved_density
from smarig.diagnosis.refit.refit import Refit, refit
from smarig.identification import Observations, fit_table, surface_through_states
from smarig.preisach import Everett, FodSurface
from smarig.replay import PlantModel, Prediction, Timeline, predict

START_SMOOTHING = 1e-14  # λ of the initial measure
MAX_ROUNDS = 5
AS_GOOD = 1.05  # times the error of another density: chance of the fit
MIN_ROUND_GAIN = 10.0  # nats: a round that gains less is the last; the next would gain a tenth of it


def joint_density(
    timeline: Timeline, plant_model: PlantModel, warm_start: Refit | None = None
) -> tuple[PlantModel, Refit]:
    """The plant model with a new density, and its readings refitted; ``warm_start``: start at the result of another
    refit.

    The density is identified from positions only: what other channels show is left to the effects.
    """
    return _alternated(timeline, _start(timeline, plant_model, warm_start))


def joint_density_from_best_start(
    timeline: Timeline, plant_model: PlantModel, original: Everett, warm_start: Refit | None = None
) -> tuple[PlantModel, Refit]:
    """``joint_density``, started from the given model's density or from a positive measure of settled positions.

    The likelier start is used. A given surface is fitted again along the inputs with effects; another density is moved
    to where effects move the input. It may be negative somewhere (Prop. 4.6); the measure is not affected by errors of
    the model.
    """
    rows = _settled_rows(timeline, predict(timeline, plant_model), plant_model)
    measure = replace(plant_model, hysteresis=fit_table(rows, START_SMOOTHING))
    surface = surface_through_states(rows, original) if isinstance(original, FodSurface) else None
    given = (
        replace(plant_model, hysteresis=surface)
        if surface is not None
        else with_moved_density(timeline, plant_model, original)
    )
    starts = [_start(timeline, one, warm_start) for one in (given, measure)]
    return _alternated(timeline, max(starts, key=lambda start: start[2].log_evidence))


def with_posterior_density(
    timeline: Timeline, plant_model: PlantModel, refitted: Refit, given: PlantModel | None = None
) -> PlantModel:
    """The plant model with the posterior density of its readings, with its own, or as ``given``: what fits best.

    A refit that fits worse than the given model has failed, and must not be diagnosed.
    """
    posterior = replace(plant_model, hysteresis=refitted.posterior.table())
    candidates = (plant_model, posterior, *([given] if given else []))
    return min(candidates, key=lambda s: settled_rms(timeline, s))


def with_density_for_effects(
    timeline: Timeline, plant_model: PlantModel, refitted: Refit, base: PlantModel
) -> PlantModel:
    """A plant model with effects and the density that fits best, or that of the base model, moved with the input.

    The latter if it fits as well: effects that only another channel shows leave the positions as they were.
    """
    own = with_posterior_density(timeline, plant_model, refitted)
    moved = with_moved_density(timeline, plant_model, base.hysteresis)
    return moved if settled_rms(timeline, moved) < AS_GOOD * settled_rms(timeline, own) else own


def settled_rms(timeline: Timeline, plant_model: PlantModel) -> float:
    """The rms error of a plant model at settled positions, with free zeros."""
    error = timeline.settled.value - predict(timeline, plant_model).values["settled"]
    own = [error[timeline.zero == z] for z in np.unique(timeline.zero)] if timeline.zero.size else [error]
    return float(np.std(np.concatenate([e - e.mean() for e in own])))


def _start(
    timeline: Timeline, plant_model: PlantModel, warm_start: Refit | None
) -> tuple[PlantModel, Prediction, Refit]:
    """A plant model, its prediction of the timeline, and its positions refitted."""
    prediction = predict(timeline, plant_model)
    return (
        plant_model,
        prediction,
        refit(timeline.positions_only, prediction.positions_only, plant_model, warm_start),
    )


def _alternated(timeline: Timeline, start: tuple[PlantModel, Prediction, Refit]) -> tuple[PlantModel, Refit]:
    """Rounds from a start, as long as they gain."""
    plant_model, prediction, refitted = start
    for _ in range(MAX_ROUNDS):
        next_fit = _start(
            timeline,
            replace(plant_model, hysteresis=refitted.posterior.table()),
            refitted,
        )
        gain_nats = next_fit[2].log_evidence - refitted.log_evidence
        if gain_nats > 0:
            plant_model, prediction, refitted = next_fit
        if gain_nats < MIN_ROUND_GAIN:
            break
    positions_alone = len(timeline.positions_only.all_readings) == len(timeline.all_readings)
    return plant_model, refitted if positions_alone else refit(timeline, prediction, plant_model, refitted)


def _settled_rows(timeline: Timeline, prediction: Prediction, plant_model: PlantModel) -> Observations:
    """The settled positions without what effects add to them, along the inputs with effects."""
    n = len(timeline.settled)
    y = timeline.settled.value - (prediction.values["settled"] - prediction.output[:n])
    h = plant_model.hysteresis
    rows = Observations.of_states(prediction.states[:n], y, timeline.block, (h.lower, h.upper), timeline.unit)
    return replace(rows, zero=timeline.zero - 1) if timeline.zero.size else rows
