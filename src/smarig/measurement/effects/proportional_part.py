"""A part of the output is proportional to the input, with any sign, as thermal expansion is.

    y ← y + k u

A measure that is nowhere negative contains such a part only if it has the sign of the transformation.
"""

from collections.abc import Sequence

from smarig.measurement.input_record import InputRecord
from smarig.measurement.measurement_effect import (
    MeasurementEffectType,
    RecordChange,
    SearchedParameter,
    Values,
)


def _parameters(_records: Sequence[InputRecord]) -> tuple[SearchedParameter, ...] | None:
    """None is searched for: the slope follows from least squares."""
    return ()


def _change(_p: Values, record: InputRecord) -> RecordChange:
    return RecordChange(record.u, record.u[:, None])


proportional_part = MeasurementEffectType(
    name="proportional_part",
    summary="A part of the output is proportional to the input, against the transformation, as thermal expansion is.",
    looks_like="the output rises with the input on both flanks of a loop that falls, or the other way round",
    confused_with=(),
    separated_by="a run far from the transformation",
    depends_on=("level",),
    parameters=_parameters,
    change=_change,
    descriptive=True,
    amplitudes=lambda u, y: (("slope", f"{y}/{u}"),),
)
