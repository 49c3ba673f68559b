"""The output drifts while a run lasts: a sensor that warms up, a mount that settles, a zero that creeps.

y ← y + b (1 − exp(−t/τ)),    t: time since the run began;    a steady drift if τ is much longer than the run
"""

from collections.abc import Sequence

import numpy as np

from smarig.measurement.input_record import InputRecord, hours_of_cycles
from smarig.measurement.measurement_effect import (
    MeasurementEffectType,
    RecordChange,
    SearchedParameter,
    Values,
)

FEWEST_CYCLES = 3.0  # with fewer, a drift is a part of the loop
TRIED_SHARES = np.array(
    [0.05, 0.1, 0.2, 0.4, 0.8, 2.0, 10.0]
)  # of the longest run; the last is a steady drift


def _parameters(records: Sequence[InputRecord]) -> tuple[SearchedParameter, ...] | None:
    """The time constant τ; every run needs a clock, and one several cycles."""
    hours = hours_of_cycles(records, FEWEST_CYCLES)
    if hours is None:
        return None
    return (
        SearchedParameter("time_constant_h", "h", tuple((hours * TRIED_SHARES).tolist()), open_above=True),
    )


def _change(p: Values, record: InputRecord) -> RecordChange:
    hours = record.elapsed / 3600
    return RecordChange(record.u, -np.expm1(-hours / p["time_constant_h"])[:, None])


output_drift = MeasurementEffectType(
    name="output_drift",
    summary="The output drifts while a run lasts, steadily or ever more slowly.",
    looks_like="loops do not close; each is shifted against the one before, by time and not by cycle",
    confused_with=("input_drift", "ratcheting", "walking", "ambient_drift"),
    separated_by="a rest of an hour: drift goes on, ratcheting stops",
    depends_on=("time", "cycle"),
    parameters=_parameters,
    change=_change,
    bounds={"time_constant_h": (1e-6, 1e9)},
    additive=True,
    amplitudes=lambda _u, y: (("amplitude", y),),
)
