"""The recorded inputs of two runs differ by an offset, as of a thermometer that was mounted again.

v = u + o_r,    o = 0 in the first run
"""

from collections.abc import Sequence

from smarig.measurement.input_record import InputRecord
from smarig.measurement.measurement_effect import (
    MeasurementEffectType,
    RecordChange,
    SearchedParameter,
    Values,
)

SAME_CONDITION = 0.1  # of the larger value
TRIED_SHARES = (-0.3, -0.2, -0.12, -0.07, -0.03, 0.0, 0.03, 0.07, 0.12, 0.2, 0.3)  # of the input's range


def _parameters(records: Sequence[InputRecord]) -> tuple[SearchedParameter, ...] | None:
    """One offset for each run but the first, if all were recorded under the same conditions."""
    if len(records) < 2 or any(_differ(records[0], r) for r in records[1:]):
        return None
    span = max(float(r.u.max() - r.u.min()) for r in records)
    tries = tuple(share * span for share in TRIED_SHARES)
    return tuple(SearchedParameter(r.name, "input unit", tries) for r in records[1:])


def _differ(a: InputRecord, b: InputRecord) -> bool:
    """Whether two runs were recorded under other conditions: these would be the cause."""
    p, q = a.conditions, b.conditions
    return any(abs(p[k] - q[k]) > SAME_CONDITION * max(abs(p[k]), abs(q[k])) for k in p.keys() & q.keys())


def _change(p: Values, record: InputRecord) -> RecordChange:
    offset, none = p.get(record.name, 0.0), RecordChange.none(record)
    return RecordChange(record.u + offset, none.terms) if offset else none


input_offset = MeasurementEffectType(
    name="input_offset",
    summary="The loops of runs are shifted along the input: its reading, the load or the specimen differs.",
    looks_like="the loop of one run is shifted along the input against that of another",
    confused_with=("stress_shift",),
    separated_by="one calibration point in each run, for example both at room temperature for an hour",
    depends_on=("run",),
    parameters=_parameters,
    change=_change,
)
