"""The lags that a search tries on records with an even clock: from two rows to a quarter of a cycle."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from smarig.measurement.input_record import InputRecord

Array = NDArray[np.float64]
MAX_CYCLE_SHARE = 0.25  # of a cycle: a longer lag is no lag
LAGS_PER_DECADE = 5


def lags_to_try(records: Sequence[InputRecord]) -> tuple[float, ...] | None:
    """Time constants in s from two rows to a quarter of the median cycle; None without a clock of even rows."""
    if not all(r.clock and _even(r.t) for r in records):
        return None
    period = max(float(np.median(np.diff(r.t))) for r in records)
    cycle_s = float(np.median([np.ptp(r.t) / max(r.cycle[-1] - r.cycle[0], 0.5) for r in records]))
    low, high = np.log10(2 * period), np.log10(MAX_CYCLE_SHARE * cycle_s)
    if high <= low:
        return None
    return tuple(np.logspace(low, high, max(int(LAGS_PER_DECADE * (high - low)), 4)).tolist())


def _even(t: Array) -> bool:
    step = np.diff(t)
    return bool(np.all(step > 0)) and float(np.quantile(step, 0.95)) < 1.5 * float(np.median(step))
