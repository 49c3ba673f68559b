"""Means of power and output over the last minutes, at the positions of a timeline: variables of learned terms.

    dz/dt = (x − z)/τ,    x: steady temperature of the present current, or output of the hysteresis

They forget, unlike the other plain variables: a supply that sags with its duty and a cord that recovers depend on them.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from smarig.plant import MEAN_LEVELS, MEAN_POWERS, JouleHeating
from smarig.replay import PlantModel, Prediction, Timeline

Array = NDArray[np.float64]


def means_of_minutes(timeline: Timeline, plant_model: PlantModel, prediction: Prediction) -> dict[str, Array]:
    """Each mean (n,) at settled and moving positions, by name."""
    at = prediction.positions_only.tick_index
    output = prediction.outputs_along(
        plant_model.hysteresis, plant_model.initial, prediction.hysteresis_input_K
    )
    heating = JouleHeating(plant_model.actuator, 0.1)
    power = np.array(
        [heating.source(i) for s in timeline.sessions or (timeline,) for i in s.ticks[1].tolist()]
    )
    return {
        name: np.concatenate(list(_means(prediction, x, tau_s, start)))[at]
        for x, start, means in ((power, 0.0, MEAN_POWERS), (output, None, MEAN_LEVELS))
        for name, tau_s in means.items()
    }


def _means(prediction: Prediction, x: Array, tau_s: float, start: float | None) -> Iterator[Array]:
    """The mean at the ticks of each session, from a start or from the first value."""
    begins = prediction.session_starts[1:]
    for t_s, values in zip(np.split(prediction.t_s, begins), np.split(x, begins)):
        mean, found = float(values[0]) if start is None else start, []
        decay = np.exp(-np.diff(t_s, prepend=t_s[0]) / tau_s)
        for value, left in zip(values.tolist(), decay.tolist()):
            mean = value + (mean - value) * left
            found.append(mean)
        yield np.array(found)
