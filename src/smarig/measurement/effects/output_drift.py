"""The output drifts steadily while a run lasts: a sensor that warms up, a clamp that slips, a zero that creeps.

y ← y + b t,    t: hours since the run began
"""

from collections.abc import Sequence

from smarig.measurement.input_record import InputRecord
from smarig.measurement.measurement_effect import (
    MeasurementEffectType,
    RecordChange,
    SearchedParameter,
    Values,
)

FEWEST_CYCLES = 3.0  # with fewer, a drift is a part of the loop


def _parameters(records: Sequence[InputRecord]) -> tuple[SearchedParameter, ...] | None:
    """Nothing is searched; every run needs a clock, and one several cycles."""
    if not all(r.clock for r in records):
        return None
    return () if max(float(r.cycle[-1] - r.cycle[0]) for r in records) >= FEWEST_CYCLES else None


def _change(p: Values, record: InputRecord) -> RecordChange:  # noqa: ARG001
    return RecordChange(record.u, ((record.t - record.t[0]) / 3600)[:, None])


output_drift = MeasurementEffectType(
    name="output_drift",
    summary="The output drifts steadily while a run lasts.",
    looks_like="loops do not close; each is shifted against the one before by the same amount per hour",
    confused_with=("ratchet_strain", "walking", "ambient_drift"),
    separated_by="a rest of an hour: drift goes on, ratcheting stops",
    depends_on=("time", "cycle"),
    parameters=_parameters,
    change=_change,
    amplitudes=lambda _u, y: (("rate", f"{y}/h"),),
)
