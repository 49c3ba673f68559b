"""Passivity of a measured run: ∫ u dy of its readings along its predicted input, against the model's bound (Thm
8.1).

The record is cut where an input or a reading is missing, and the memory is followed. The integral of a segment with
an unknown first state is computed, but not compared with a bound. After a missing input, the memory is unknown
until the input saturates.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from smarig.certificate import HysteresisAnalysis, MeasuredPassivity, Units, reading_noise, segment_passivity
from smarig.core import Array, DataError
from smarig.measurement import SATURATION_TOLERANCE, Start
from smarig.preisach import Preisach, State
from smarig.record import FORC_PROTOCOL, Run
from smarig.replay import Model, check_input, check_output, recorded_start

_UNKNOWN = "the state at the start of the run is not known, and the input has not saturated since"
_INPUT_MISSING = "the input was missing, so the memory is not known until it saturates"


def passivity_of_run(run: Run, model: Model, start: Start | None = None) -> MeasuredPassivity:
    """Supplied energy of the readings of a run, sample by sample, with that of the model and its bound.

    ``start`` is the state at the start of the run, if its record does not state it. The effects of a model are left
    out, because the bound is that of its hysteresis. Raises UsageError or DataError for a run in other units,
    without readings, or of reversal curves.
    """
    check_input(model, run)
    check_output(model, run)
    if run.info.protocol == FORC_PROTOCOL:
        raise DataError(f"{run.path} holds reversal curves, not a run in time, so it has no supplied energy.")
    u, y = run["input"], run["position"]
    present = np.isfinite(u) & np.isfinite(y)
    if not present.any():
        raise DataError(f"{run.path} has no sample with both input and position.")
    hysteresis_analysis = HysteresisAnalysis.of(model.hysteresis, Units(model.unit, model.input.unit))
    noise = reading_noise(y, run.info.output.resolution)
    starts = list(_starts(model.preisach(), u, present, start or recorded_start(run)))
    ends = [a for a, _ in starts[1:]] + [u.size]
    segments = []
    for (a, memory), end in zip(starts, ends):
        b = a + int(np.argmin(np.append(present[a:end], False)))  # up to the next gap
        segments.append(segment_passivity(hysteresis_analysis, u[a:b], y[a:b], noise, a, memory))
    return MeasuredPassivity(tuple(segments), noise, hysteresis_analysis.units.energy, model.unit)


def _starts(
    operator: Preisach, u: Array, present: NDArray[np.bool_], start: Start | None
) -> Iterator[tuple[int, State | str]]:
    """Rows at which a segment starts (after a gap, or when the memory becomes known) with its state, or why there
    is none.
    """
    h, unknown = operator.hysteresis, "" if start else _UNKNOWN
    rest = SATURATION_TOLERANCE * (h.upper - h.lower)
    operator.reset(start or "negative")
    before = False
    for k, value in enumerate(u.tolist()):
        became_known = False
        if value != value:
            unknown = _INPUT_MISSING
        else:
            saturated = (
                "negative" if value <= h.lower + rest else "positive" if value >= h.upper - rest else None
            )
            if unknown and saturated:
                operator.reset(saturated)
                unknown, became_known = "", True
            operator.step(value)
        if present[k] and (became_known or not before):
            yield k, unknown or operator.state
        before = bool(present[k])
