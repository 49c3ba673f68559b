"""Reads first-order reversal curves as written by MicroMag magnetometers."""

from pathlib import Path
from typing import Any

import numpy as np

from smarig.core import DataError, UsageError
from smarig.exchange.checks.drift import ForcCurves, correct_drift_if_it_helps
from smarig.exchange.runs.reader_result import RunDraft
from smarig.exchange.tables.forc_file import ForcFile, read_forc
from smarig.record import FORC_PROTOCOL, remarks


def forc(path: Path, *, rig: str | None = None, mapping: str | None = None) -> RunDraft:
    """MicroMag-style first-order reversal curves: field is the input, moment the output.

    Samples are in measured order with the calibration points (step −1), so that positive saturation comes before
    each curve. Moments stay as measured; ``drift_corrected`` applies the correction.
    """
    if rig is not None or mapping is not None:
        raise UsageError("A file of reversal curves describes itself. Leave out --rig and --map.")
    file = read_forc(path)
    described: dict[str, Any] = dict(file.header)
    described |= {"curves": file.curves, "calibration_points": int(file.calibration.sum())}
    warnings = list(file.warnings)
    drift = _drift(file)
    if drift is not None:
        described["drift"] = drift[0]
        warnings.append(drift[1])
    columns = {
        "input": file.field,
        "position": file.moment,
        "step": file.curve.astype(float),
        "t_s": np.full(file.field.size, np.nan),
    }
    meta = {
        "protocol": FORC_PROTOCOL,
        "input": {"quantity": "magnetic field", "unit": file.units[0]},
        "output": {"quantity": "magnetic moment", "unit": file.units[1], "per_count": None},
        "forc": described,
        "notes": "Moments are as measured. The warnings state whether a drift correction helps.",
    }
    if file.saturated_first:
        meta["initial"] = "positive"
    return RunDraft(columns, meta, (), tuple(remarks(*warnings)))


def _drift(file: ForcFile) -> tuple[dict, str] | None:
    try:
        _, decision = correct_drift_if_it_helps(ForcCurves(file.field, file.moment, file.curve))
    except DataError:  # too few curves or calibration points; the findings on the header state this
        return None
    return decision.record(), decision.sentence(file.units[1])
