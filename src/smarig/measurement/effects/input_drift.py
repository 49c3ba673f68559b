"""The recorded input drifts against the one that acts, steadily, as of an integrator or of a reference that ages.

v = u + d (t − t₀),    t₀: start of the run
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
TRIED_SHARES = (-0.5, -0.25, -0.12, -0.06, -0.03, 0.0, 0.03, 0.06, 0.12, 0.25, 0.5)  # of the range, in a run


def _parameters(records: Sequence[InputRecord]) -> tuple[SearchedParameter, ...] | None:
    """The drift d; every run needs a clock, and one several cycles."""
    hours = hours_of_cycles(records, FEWEST_CYCLES)
    if hours is None:
        return None
    per_h = max(float(np.ptp(r.u)) for r in records) / hours
    return (SearchedParameter("drift_per_h", "input unit per h", tuple(s * per_h for s in TRIED_SHARES)),)


def _change(p: Values, record: InputRecord) -> RecordChange:
    hours = record.elapsed / 3600
    return RecordChange(record.u + p["drift_per_h"] * hours, RecordChange.none(record).terms)


input_drift = MeasurementEffectType(
    name="input_drift",
    summary="The recorded input drifts steadily against the one that acts.",
    looks_like="each loop is shifted along the input against the one before, by time and not by cycle",
    confused_with=("output_drift", "ratcheting", "ambient_drift"),
    separated_by="a point of calibration before and after the run",
    depends_on=("time", "cycle"),
    parameters=_parameters,
    change=_change,
)
