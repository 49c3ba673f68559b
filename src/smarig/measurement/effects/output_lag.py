"""The output follows the recorded input late: a wire that is slower than the thermometer beside it.

τ dv/dt = u − v,    v(0) = u(0);    exact for an input that is linear between rows
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from smarig.measurement.input_record import InputRecord, input_noise_sd
from smarig.measurement.lag_search import lags_to_try
from smarig.measurement.measurement_effect import (
    MeasurementEffectType,
    RecordChange,
    SearchedParameter,
    Values,
)

Array = NDArray[np.float64]
TEMPERATURES = ("degC", "K")


def _parameters(records: Sequence[InputRecord]) -> tuple[SearchedParameter, ...] | None:
    """The lag, for recorded temperatures only: elsewhere a loop that depends on the rate has many causes."""
    if any(r.input_unit not in TEMPERATURES for r in records):
        return None
    tries = lags_to_try(records)
    return None if tries is None else (SearchedParameter("lag_s", "s", tries),)


def _change(p: Values, record: InputRecord) -> RecordChange:
    if not p["lag_s"]:
        return RecordChange.none(record)
    period = float(np.median(np.diff(record.t)))
    noise = input_noise_sd(record.u) * float(np.sqrt(min(period / (2 * p["lag_s"]), 1.0)))
    return RecordChange(followed(record.u, record.t, p["lag_s"]), np.empty((len(record), 0)), noise)


def followed(u: Array, t: Array, lag_s: float) -> Array:
    """u (n,) at times t (n,) after a first-order lag.

    >>> followed(np.array([0.0, 1.0, 1.0]), np.array([0.0, 1e-9, 1.0]), 1.0).round(3).tolist()
    [0.0, 0.0, 0.632]
    """
    rate = np.diff(u) / np.diff(t)
    decay = np.exp(-np.diff(t) / lag_s)
    v, out = float(u[0]), [float(u[0])]
    for before, after, r, d in zip(u[:-1].tolist(), u[1:].tolist(), (rate * lag_s).tolist(), decay.tolist()):
        v = after - r + (v - before + r) * d
        out.append(v)
    return np.array(out)


output_lag = MeasurementEffectType(
    name="output_lag",
    summary="The output follows the recorded input late: a wire slower than its thermometer.",
    looks_like="loops are wider, the more the faster the input changes",
    confused_with=("wire_lag", "sensor_lag"),
    separated_by="a slower run, or a second sensor of the input",
    depends_on=("rate", "history"),
    parameters=_parameters,
    change=_change,
)
