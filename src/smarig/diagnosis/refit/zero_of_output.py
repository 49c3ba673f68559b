"""The zero of an identified hysteresis: that of the runs it was identified from.

A diagnosis estimates zeros together with the density, so a density says nothing of the zero by itself. A model file has
one, and ``verify`` adds nothing to it for the training runs and their session.
"""

from dataclasses import replace

import numpy as np

from smarig.preisach import FodTable
from smarig.replay import PlantModel, Timeline, predict


def with_zero_of_runs(timeline: Timeline, plant_model: PlantModel) -> PlantModel:
    """The plant model with the mean error removed at the settled points that share the zero of the first run.

    A hysteresis that is no table was given with its zero, and keeps it.
    """
    h = plant_model.hysteresis
    if not isinstance(h, FodTable):
        return plant_model
    error = timeline.settled.value - predict(timeline, plant_model).values["settled"]
    same_zero = timeline.zero == timeline.zero[0] if timeline.zero.size else np.ones(error.size, dtype=bool)
    shift = float(np.mean(error[same_zero]))
    return replace(plant_model, hysteresis=FodTable(h.nodes, h.values + shift, h.unit))
