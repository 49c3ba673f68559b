"""Transformation temperatures rise with the stress (Clausius–Clapeyron), and the stroke depends on it.

    v = u − (σ − σ₀)/C,    g = g(σ),  z = z(σ): a gain and a zero for each stress

C is in MPa/K, σ₀ the stress of the first run. Between the stresses of the runs, gain and zero are linear in σ.
"""

from collections.abc import Sequence

from smarig.measurement.input_record import InputRecord
from smarig.measurement.measurement_effect import (
    MeasurementEffectType,
    RecordChange,
    SearchedParameter,
    Values,
)

STRESS = "stress"
MIN_RELATIVE_CHANGE = 0.1  # of the largest stress: smaller differences between runs determine no shift
TRIED_MPa_PER_K = (2.0, 3.0, 4.5, 6.0, 8.0, 10.0, 13.0, 18.0, 30.0)  # shape-memory alloys: 4 to 15


def _parameters(records: Sequence[InputRecord]) -> tuple[SearchedParameter, ...] | None:
    """The slope C, if every run states its stress and stresses differ."""
    if not records or any(STRESS not in r.conditions for r in records):
        return None
    stresses = [r.conditions[STRESS] for r in records]
    if max(stresses) - min(stresses) < MIN_RELATIVE_CHANGE * max(map(abs, stresses)):
        return None
    return (SearchedParameter("MPa_per_K", "MPa/K", TRIED_MPa_PER_K),)


def _change(p: Values, record: InputRecord) -> RecordChange:
    none = RecordChange.none(record)
    shift = (record.condition(STRESS) - p.get("reference", 0.0)) / p["MPa_per_K"]
    return RecordChange(record.u - shift, none.terms)


stress_shift = MeasurementEffectType(
    name="stress_shift",
    summary="Transformation temperatures rise with the stress of the run, and the stroke depends on it.",
    looks_like="the loop of a larger load lies at higher temperatures and is taller",
    confused_with=("input_offset",),
    separated_by="a third load: the shift is proportional to the stress",
    depends_on=("run", "stress"),
    parameters=_parameters,
    change=_change,
    bounds={"MPa_per_K": (1e-3, 1e6)},
    by_condition=STRESS,
)
