"""The output of one run jumps once and stays: a clamp that slips, a gauge that comes loose, lost counts.

y ← y + b for t ≥ t₁ in the run, and in all parts of a record that was cut
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

FEWEST_CYCLES = 3.0  # with fewer, the loop before or after the jump is not known
TIMES = np.linspace(0.06, 0.94, 23)  # shares of the run


def _parameters(records: Sequence[InputRecord]) -> tuple[SearchedParameter, ...] | None:
    """The time t₁ in the run with the most cycles; it needs a clock."""
    longest = max(records, key=lambda r: float(r.cycle[-1] - r.cycle[0]))
    if not longest.clock or float(longest.cycle[-1] - longest.cycle[0]) < FEWEST_CYCLES:
        return None
    hours = float(np.ptp(longest.t)) / 3600
    return (
        SearchedParameter(longest.whole or longest.name, "h", tuple((hours * TIMES).tolist()), sudden=True),
    )


def _change(p: Values, record: InputRecord) -> RecordChange:
    after = record.elapsed / 3600 >= p.get(record.whole or record.name, np.inf)
    return RecordChange(record.u, after.astype(float)[:, None])


output_jump = MeasurementEffectType(
    name="output_jump",
    summary="The output of one run jumps once and stays.",
    looks_like="all loops after one moment are shifted against all loops before it, by the same amount",
    confused_with=("slip", "ratcheting", "output_drift"),
    separated_by="a reference position before and after the run",
    depends_on=("time", "cycle"),
    parameters=_parameters,
    change=_change,
    additive=True,
    amplitudes=lambda _u, y: (("amplitude", y),),
)
