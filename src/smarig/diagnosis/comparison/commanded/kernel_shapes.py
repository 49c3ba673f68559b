"""Shapes of a smooth dependence on one variable, and the variables of a record that a verdict can name.

"walk" has errors that grow with the travel since the last saturation: minor loops that do not return, as in no Preisach
operator. "fading" has errors that go with the recent motion of the output, which a frame, a sensor or a wire forgets
with time: a Preisach operator remembers extrema, whenever they were.
"""

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.replay import PlantModel, Prediction

TIME_SHARES = (1 / 60, 1 / 15, 1 / 4)  # of the record's duration: correlation times
RANK_LENGTH = 0.15  # correlation length of other variables, in shares of their ranks
SATURATED_SHARE = 0.02  # of the output's range: nearer to an end counts as saturated
PLAUSIBLE_ROOM_K = 0.1  # most fluctuation of the room that is noise; more hides what has a cause
SIZES = 10.0 ** np.linspace(-9, 1, 41)  # s², strokes² or K², tried while candidates are screened
WALK, FADING, HISTORY = "walk", "fading", "history"
PLAIN = {WALK: HISTORY, FADING: HISTORY, "branch": HISTORY}  # the variable that a verdict names
FADING_STEPS = (0.5, 2.0, 8.0)  # times a step's duration: time constants of a memory that fades


def falling(z: Array, length: float) -> Array:
    """exp(−|z − z'|/length), (n, n)."""
    return np.exp(-np.abs(z[:, None] - z[None, :]) / length)


def ranks(z: Array) -> Array:
    """The share of distinct values up to each, (n,)."""
    values, place = np.unique(np.round(z, 9), return_inverse=True)
    return ((np.arange(values.size) + 0.5) / values.size)[place]


def walk_kernel(session: NDArray[np.int64], t_s: Array, output: Array) -> Array:
    """A random walk along the travel since the last saturation, (n, n)."""
    low, high = float(output.min()), float(output.max())
    span = (high - low) or 1.0
    near = SATURATED_SHARE * span
    saturated = (output < low + near) | (output > high - near)
    travel, section = np.zeros(output.size), np.zeros(output.size, dtype=np.int64)
    order = np.lexsort((t_s, session))
    for before, k in zip(order[:-1].tolist(), order[1:].tolist()):
        begins = saturated[k] or session[k] != session[before]
        section[k] = section[before] + int(begins)
        travel[k] = 0.0 if begins else travel[before] + abs(output[k] - output[before]) / span
    return np.equal.outer(section, section) * np.minimum.outer(travel, travel)


def recent_motion(prediction: Prediction, plant_model: PlantModel, tau_s: float) -> Array:
    """The output less its exponential mean over the last ``tau_s``, at each coupled reading (n,), in strokes.

    z(t) = ∫ e^(−(t − s)/τ) dy(s): each motion counts until it is forgotten.
    """
    hysteresis, path = plant_model.hysteresis, prediction.hysteresis_input_K
    y = prediction.outputs_along(hysteresis, plant_model.initial, path) / abs(plant_model.stroke)
    moved, kept = np.diff(y, prepend=y[0]), np.exp(-np.diff(prediction.t_s, prepend=0.0) / tau_s)
    moved[[*prediction.session_starts]] = kept[[*prediction.session_starts]] = 0.0
    z, all_z = 0.0, []
    for step, share in zip(moved.tolist(), kept.tolist()):
        z = (z + step) * share
        all_z.append(z)
    return np.array(all_z)[prediction.tick_index]
