"""Each cycle leaves a strain behind, the same in each or ever less, as in training.

y ← y + b (1 − exp(−N/N₀)),    N: full cycles so far, by travel; N₀ ≫ N: the same in every cycle
"""

from collections.abc import Sequence

import numpy as np

from smarig.measurement.input_record import InputRecord
from smarig.measurement.measurement_effect import (
    MeasurementEffectType,
    RecordChange,
    SearchedParameter,
    Values,
)

FEWEST_CYCLES = 4.0
TRIED_SHARES = np.array([0.05, 0.1, 0.2, 0.4, 0.8, 2.0, 5.0])  # of the cycles on record
TEMPERATURES = ("degC", "K")


def _parameters(records: Sequence[InputRecord]) -> tuple[SearchedParameter, ...] | None:
    """The number of cycles N₀ within which the ratcheting slows down; tested on thermal cycles only."""
    if any(r.input_unit not in TEMPERATURES for r in records):
        return None
    cycles = max((float(r.cycle[-1]) for r in records), default=0.0)
    if cycles < FEWEST_CYCLES:
        return None
    return (SearchedParameter("cycles", "1", tuple((cycles * TRIED_SHARES).tolist()), open_above=True),)


def _change(p: Values, record: InputRecord) -> RecordChange:
    return RecordChange(record.u, -np.expm1(-record.full_cycles / p["cycles"])[:, None])


ratcheting = MeasurementEffectType(
    name="ratcheting",
    summary="Each cycle leaves an output behind, the same in each or ever less.",
    looks_like="loops do not close; each is shifted against the one before, by cycle and not by time",
    confused_with=("walking", "training"),
    separated_by="a rest of an hour: ratcheting stops, drift does not",
    depends_on=("cycle", "time"),
    parameters=_parameters,
    change=_change,
    bounds={"cycles": (1e-6, 1e9)},
    additive=True,
    amplitudes=lambda _u, y: (("amplitude", y),),
)
